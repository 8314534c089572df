#include "inverse/polish.hpp"

#include <Eigen/Eigenvalues>

namespace calomel {

namespace {

constexpr double longest_step = 1.5, shortest_step = 0.2;

}  // namespace

Eigen::MatrixXd principal_steps(const Eigen::MatrixXd& covariance, const SearchSpace& space, double secant) {
  // Directions are principal in units of the box, so that they do not hang on the parameters' units.
  const Eigen::VectorXd width = space.high() - space.low();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(width.cwiseInverse().asDiagonal() * covariance * width.cwiseInverse().asDiagonal());
  Eigen::MatrixXd steps = width.asDiagonal() * eigen.eigenvectors();
  for (Eigen::Index k = 0; k < steps.cols(); ++k) {
    double length = secant * std::sqrt(std::max(1e-12, eigen.eigenvalues()[k]));
    length = std::min(length, 0.25 / eigen.eigenvectors().col(k).cwiseAbs().maxCoeff());
    steps.col(k) *= length;
  }
  return steps;
}

Polished polish(const PosteriorMode& mode, const SearchSpace& space, const PosteriorPoint& start, const Eigen::MatrixXd& covariance, const PolishOptions& options,
                const std::function<void(int)>& progress) {
  Polished out{.point = start, .x = space.from(start.theta), .covariance = covariance};
  const int cost = int(2 * space.size() + 1);
  // The secants keep the width of the covariance that was handed in: narrower ones would show the roughness, whose slopes make them narrower still.
  const Eigen::MatrixXd steps = principal_steps(covariance, space, options.secant);
  while (out.runs + cost <= options.runs) {
    const auto at = mode.linearise(out.x, steps);
    out.runs += cost;
    if (progress) progress(out.runs);
    if (!at) break;
    out.at = at;
    bool limited = false;
    const Eigen::MatrixXd curvature = mode.curvature(*at);
    out.covariance = covariance_of(curvature, space, out.x, limited);
    const Eigen::VectorXd gradient = mode.likelihood().errors().weight(at->chi2) * at->jacobian.transpose() * at->residual +
                                     space.prior_jacobian(out.x).transpose() * space.prior_residuals(out.x);
    Eigen::VectorXd step = -out.covariance * gradient;
    double length = (steps.inverse() * step).cwiseAbs().maxCoeff() * options.secant;
    if (length > longest_step) step *= longest_step / length, length = longest_step;
    if (length < shortest_step) break;
    bool better = false;
    for (int attempt = 0; attempt < 2 && out.runs < options.runs && !better; ++attempt, step /= 2) {
      const Eigen::VectorXd x = (out.x + step).cwiseMax(space.low()).cwiseMin(space.high());
      PosteriorPoint p = mode.at(x);
      ++out.runs;
      if (progress) progress(out.runs);
      better = p.log_posterior > out.point.log_posterior;
      if (better) out.point = std::move(p), out.x = x, ++out.steps;
    }
    if (!better) break;
  }
  return out;
}

}  // namespace calomel
