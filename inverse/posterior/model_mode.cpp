#include "inverse/posterior/model_mode.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "forward/campaign/design.hpp"

namespace calomel {

namespace {

constexpr std::size_t design_points = 64;
constexpr double inner = 0.05;       ///< share of the bounds' distance at either end that the design leaves out
constexpr double step = 1e-4;        ///< of a gradient's difference, in q
constexpr double far_step = 2e-3;    ///< of a curvature's
constexpr int most_iterations = 200;
constexpr double widest = 1e4;       ///< variance of q that a curvature is believed to say

class Negative : public ceres::FirstOrderFunction {
 public:
  explicit Negative(const ModelPosterior& posterior) : posterior_(posterior) {}
  int NumParameters() const override { return int(posterior_.dimension()); }
  bool Evaluate(const double* at, double* cost, double* gradient) const override {
    const Eigen::Map<const Eigen::VectorXd> x(at, posterior_.dimension());
    Eigen::VectorXd g(x.size());
    if (gradient && posterior_.has_gradient()) {
      *cost = -posterior_.log_density(x, g);
    } else {
      *cost = -posterior_.log_density(x);
      for (Eigen::Index k = 0; gradient && k < x.size(); ++k) {
        Eigen::VectorXd up = x, down = x;
        up[k] += step, down[k] -= step;
        g[k] = (posterior_.log_density(up) - posterior_.log_density(down)) / (2 * step);
      }
    }
    if (gradient) Eigen::Map<Eigen::VectorXd>(gradient, x.size()) = -g;
    return std::isfinite(*cost) && (!gradient || g.allFinite());
  }

 private:
  const ModelPosterior& posterior_;
};

Eigen::VectorXd best_start(const ModelPosterior& posterior, std::uint64_t seed) {
  std::vector<double> nominal;
  for (const auto& p : posterior.parameters()) nominal.push_back(*p.nominal);
  Eigen::VectorXd best = posterior.q(nominal);
  double density = posterior.log_density(best);
  const Eigen::MatrixXd unit = sobol_points(std::size_t(posterior.dimension()), design_points, seed);
  for (Eigen::Index i = 0; i < unit.cols(); ++i) {
    const Eigen::ArrayXd place = inner + (1 - 2 * inner) * unit.col(i).array();
    const Eigen::VectorXd q = (place / (1 - place)).log();
    if (const double d = posterior.log_density(q); d > density || !std::isfinite(density)) density = d, best = q;
  }
  if (!std::isfinite(density)) throw NumericsError("the model's density is zero, or the model fails, at the nominal values and at every point of a design over the bounds");
  return best;
}

}  // namespace

ModelMode find_mode(const ModelPosterior& posterior, std::uint64_t seed) {
  ModelMode mode{.q = best_start(posterior, seed), .covariance = {}};
  const Eigen::VectorXd start = mode.q;
  ceres::GradientProblem problem(new Negative(posterior));
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT, options.max_num_iterations = most_iterations;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, mode.q.data(), &summary);
  mode.log_density = posterior.log_density(mode.q);
  if (!(mode.log_density >= posterior.log_density(start))) mode.q = start, mode.log_density = posterior.log_density(start);
  const Eigen::Index d = posterior.dimension();
  const auto at = [&](Eigen::Index j, double a, Eigen::Index k, double b) {
    Eigen::VectorXd q = mode.q;
    q[j] += a, q[k] += b;
    return posterior.log_density(q);
  };
  Eigen::MatrixXd curvature(d, d);
  for (Eigen::Index j = 0; j < d; ++j)
    for (Eigen::Index k = 0; k <= j; ++k) {
      const double h = far_step;
      const double c = j == k ? -(at(j, h, j, 0) + at(j, -h, j, 0) - 2 * mode.log_density) / (h * h) : -(at(j, h, k, h) - at(j, h, k, -h) - at(j, -h, k, h) + at(j, -h, k, -h)) / (4 * h * h);
      curvature(j, k) = curvature(k, j) = std::isfinite(c) ? c : 0;
    }
  auto eigen = symmetric_eigen(curvature);
  constexpr double unknown = ModelMode::unknown_sd * ModelMode::unknown_sd;
  for (auto& v : eigen.values) v = v > 1 / widest ? 1 / v : unknown;
  mode.covariance = eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose();
  return mode;
}

}  // namespace calomel
