#include "inverse/polish.hpp"

namespace calomel {

namespace {

constexpr double longest_step = 1.5, shortest_step = 0.2;

}  // namespace

Polished polish(const PosteriorMode& mode, const SearchSpace& space, const PosteriorPoint& start, const Eigen::MatrixXd& covariance,
                const Eigen::VectorXd& half_widths, int runs, const std::function<void(int)>& progress) {
  Polished out{.point = start, .x = space.from(start.theta), .covariance = covariance};
  const int cost = int(2 * space.size() + 1);
  while (out.runs + cost <= runs) {
    const auto at = mode.linearise(out.x, half_widths.asDiagonal());
    out.runs += cost;
    if (progress) progress(out.runs);
    if (!at) break;
    out.at = at;
    bool limited = false;
    out.covariance = covariance_of(mode.curvature(*at), space, out.x, limited);
    const Eigen::VectorXd gradient = mode.likelihood().errors().weight(at->chi2) * at->jacobian.transpose() * at->residual +
                                     space.prior_jacobian(out.x).transpose() * space.prior_residuals(out.x);
    Eigen::VectorXd step = -out.covariance * gradient;
    const double length = step.cwiseQuotient(half_widths).cwiseAbs().maxCoeff();
    if (length > longest_step) step *= longest_step / length;
    if (step.cwiseQuotient(out.covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff() < shortest_step) break;
    bool better = false;
    for (int attempt = 0; attempt < 2 && out.runs < runs && !better; ++attempt, step /= 2) {
      const Eigen::VectorXd x = (out.x + step).cwiseMax(space.low()).cwiseMin(space.high());
      PosteriorPoint p = mode.at(x);
      ++out.runs;
      if (progress) progress(out.runs);
      better = p.log_posterior > out.point.log_posterior;
      if (better) out.point = p, out.x = x, ++out.steps;
      out.tried.push_back(std::move(p));
    }
    if (!better) break;
  }
  return out;
}

}  // namespace calomel
