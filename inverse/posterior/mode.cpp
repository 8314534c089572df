#include "inverse/posterior/mode.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"

namespace calomel {

namespace {

constexpr double same_mode = 0.1;  ///< standard deviations below which two modes are one
constexpr double step = 1e-4;      ///< of u and k in differences of the exact gradient

class Cost final : public ceres::FirstOrderFunction {
 public:
  explicit Cost(const LogPosterior& posterior) : posterior_(posterior) {}
  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    const Eigen::Map<const Eigen::VectorXd> q(parameters, posterior_.dimension());
    Eigen::VectorXd g(posterior_.dimension());
    const double value = posterior_.mode_density(q, gradient ? &g : nullptr);
    if (!std::isfinite(value)) return false;
    *cost = -value;
    if (gradient) Eigen::Map<Eigen::VectorXd>(gradient, g.size()) = -g;
    return true;
  }
  int NumParameters() const override { return int(posterior_.dimension()); }

 private:
  const LogPosterior& posterior_;
};

/// Gradient of log L + log prior by (u, k), the prior that of the mode's coordinates.
Eigen::VectorXd slope_at(const LogPosterior& posterior, const LogPosterior::Point& at) {
  const auto density = posterior.density(at);
  Eigen::VectorXd g = density.likelihood_gradient + density.prior_gradient;
  const Eigen::VectorXd by_u = posterior.box().derivative(at.u);
  for (Eigen::Index i = 0; i < Eigen::Index(posterior.free().size()); ++i) {
    const Eigen::Index k = posterior.free()[std::size_t(i)];
    if (posterior.box().parameters()[std::size_t(k)].prior == "lognormal") g[i] += by_u[k] / at.theta[std::size_t(k)];
  }
  return g;
}

/// Coordinates of the curvature, (dimension).
Eigen::VectorXd coordinates(const LogPosterior& posterior, const LogPosterior::Point& at) {
  Eigen::VectorXd x(posterior.dimension());
  x.head(Eigen::Index(posterior.free().size())) = at.u(posterior.free());
  if (posterior.has_beyond()) x[x.size() - 1] = at.beyond;
  return x;
}

/// Covariance by the curvature from central differences of the exact gradient. A direction along which the density does not fall within the box is given
/// the box's own variance.
Eigen::MatrixXd laplace(const LogPosterior& posterior, const LogPosterior::Point& at) {
  const Eigen::Index n = posterior.dimension();
  Eigen::MatrixXd curvature(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    curvature.col(k) = -(slope_at(posterior, posterior.moved(at, k, step)) - slope_at(posterior, posterior.moved(at, k, -step))) / (2 * step);
  const SymmetricEigen eigen = symmetric_eigen(0.5 * (curvature + curvature.transpose()));
  const Eigen::VectorXd least = Eigen::VectorXd::Constant(n, 3.0);  // 1 / (2^2 / 12): the variance of a uniform over the box
  return eigen.vectors * eigen.values.cwiseMax(least).cwiseInverse().asDiagonal() * eigen.vectors.transpose();
}

}  // namespace

LocalMode mode_at(const LogPosterior& posterior, const Eigen::VectorXd& q) {
  LocalMode m{.q = q, .at = posterior.point(q)};
  m.mode_density = posterior.mode_density(q);
  m.log_posterior = posterior.density(m.at).log_posterior();
  m.covariance = laplace(posterior, m.at);
  m.gradient = slope_at(posterior, m.at).cwiseProduct(m.covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
  return m;
}

std::vector<LocalMode> find_modes(const LogPosterior& posterior, const std::vector<Eigen::VectorXd>& starts) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // a failed line search is an answer here, not news
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;  // |change of density| / |density|
  options.gradient_tolerance = 1e-8;   // max |gradient|
  std::vector<LocalMode> modes;
  for (const auto& start : starts) {
    Eigen::VectorXd q = start;
    const ceres::GradientProblem problem(new Cost(posterior));
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, problem, q.data(), &summary);
    if (!q.allFinite() || !std::isfinite(posterior.mode_density(q))) continue;
    LocalMode m = mode_at(posterior, q);
    m.iterations = int(summary.iterations.size());
    const Eigen::VectorXd sd = m.covariance.diagonal().cwiseSqrt();
    const bool known = std::any_of(modes.begin(), modes.end(), [&](const LocalMode& other) {
      return (coordinates(posterior, other.at) - coordinates(posterior, m.at)).cwiseQuotient(sd).cwiseAbs().maxCoeff() < same_mode;
    });
    if (!known) modes.push_back(std::move(m));
  }
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) { return a.mode_density > b.mode_density; });
  return modes;
}

double log_evidence(const LogPosterior& posterior, const LocalMode& m) {
  const auto n = double(posterior.dimension());
  return m.log_posterior + 0.5 * n * std::log(2 * std::numbers::pi) + Cholesky(m.covariance).half_log_determinant() +
         posterior.box().derivative(m.at.u)(posterior.free()).array().abs().log().sum();
}

Eigen::MatrixXd parameter_covariance(const LogPosterior& posterior, const LocalMode& m) {
  const auto f = Eigen::Index(posterior.free().size());
  const Eigen::VectorXd by_u = posterior.box().derivative(m.at.u)(posterior.free());
  return by_u.asDiagonal() * m.covariance.topLeftCorner(f, f) * by_u.asDiagonal();
}

Eigen::MatrixXd gaussian_draws(const LogPosterior& posterior, const LocalMode& m, std::size_t n, std::uint64_t seed, double inflation) {
  const Eigen::Index d = posterior.box().size();
  const auto f = Eigen::Index(posterior.free().size());
  const Eigen::MatrixXd root = inflation * Cholesky(m.covariance).lower();
  const Eigen::VectorXd middle = coordinates(posterior, m.at);
  RandomStream random(seed, 0);
  Eigen::MatrixXd draws(d + 1, Eigen::Index(n));
  draws.topRows(d).colwise() = m.at.u;
  draws.row(d).setConstant(m.at.beyond);
  Eigen::Index taken = 0;
  Eigen::VectorXd z(middle.size());
  for (std::size_t trial = 0; trial < 100 * n && taken < draws.cols(); ++trial) {
    for (auto& x : z) x = random.normal();
    const Eigen::VectorXd at = middle + root * z;
    if (at.head(f).cwiseAbs().maxCoeff() > 1) continue;
    for (Eigen::Index i = 0; i < f; ++i) draws(posterior.free()[std::size_t(i)], taken) = at[i];
    if (posterior.has_beyond()) draws(d, taken) = at[f];
    ++taken;
  }
  return draws.leftCols(taken);
}

}  // namespace calomel
