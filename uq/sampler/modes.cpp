#include "uq/sampler/modes.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/linear_algebra.hpp"
#include "base/parallel.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_descents = 16;
constexpr int most_iterations = 200;
constexpr double step = 1e-4;          ///< difference for a gradient
constexpr double first_step = 2e-3;    ///< difference for a curvature before the standard deviations are known
constexpr double step_sds = 1.0 / 3;   ///< the same in standard deviations once they are known
constexpr double widest = 1e4;         ///< greatest variance that a curvature may give
constexpr double fall = 1;             ///< least fall of ln p between two distinct modes
constexpr double least_weight = 1e-5;  ///< least weight of a mode, over the greatest

double at(const LogDensity& density, const Eigen::VectorXd& x) { return density.log_density({x.data(), std::size_t(x.size())}); }

class Negative : public ceres::FirstOrderFunction {
 public:
  explicit Negative(const LogDensity& density) : density_(density) {}
  int NumParameters() const override { return int(density_.dimension()); }
  bool Evaluate(const double* x, double* cost, double* gradient) const override {
    const std::span<const double> place(x, density_.dimension());
    Eigen::VectorXd g(Eigen::Index(place.size()));
    if (gradient && density_.has_gradient()) {
      *cost = -density_.log_density_and_gradient(place, {g.data(), place.size()});
    } else {
      *cost = -density_.log_density(place);
      const Eigen::Map<const Eigen::VectorXd> here(x, g.size());
      for (Eigen::Index k = 0; gradient && k < g.size(); ++k) {
        Eigen::VectorXd up = here, down = here;
        up[k] += step;
        down[k] -= step;
        g[k] = (at(density_, up) - at(density_, down)) / (2 * step);
      }
    }
    if (gradient) Eigen::Map<Eigen::VectorXd>(gradient, g.size()) = -g;
    return std::isfinite(*cost) && (!gradient || g.allFinite());
  }

 private:
  const LogDensity& density_;
};

/// The columns of the design, best first, whose values exceed those of their 2 d + 4 nearest neighbours.
std::vector<Eigen::Index> tops(const Eigen::MatrixXd& design, const std::vector<double>& values) {
  const Eigen::Index n = design.cols();
  if (n == 0) return {};
  const auto neighbours = std::min(std::size_t(2 * design.rows() + 4), std::size_t(n - 1));
  const Eigen::VectorXd range = (design.rowwise().maxCoeff() - design.rowwise().minCoeff()).cwiseMax(std::numeric_limits<double>::min());
  const Eigen::MatrixXd scaled = range.cwiseInverse().asDiagonal() * design;
  std::vector<Eigen::Index> found;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (values[std::size_t(i)] == never) continue;
    const Eigen::VectorXd away = (scaled.colwise() - scaled.col(i)).colwise().squaredNorm();
    std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(neighbours + 1), order.end(),
                      [&](Eigen::Index a, Eigen::Index b) { return away[a] < away[b]; });
    if (std::all_of(order.begin(), order.begin() + std::ptrdiff_t(neighbours + 1),
                    [&](Eigen::Index j) { return j == i || values[std::size_t(j)] < values[std::size_t(i)]; }))
      found.push_back(i);
  }
  std::stable_sort(found.begin(), found.end(), [&](Eigen::Index a, Eigen::Index b) { return values[std::size_t(a)] > values[std::size_t(b)]; });
  if (found.size() > most_descents) found.resize(most_descents);
  return found;
}

Eigen::VectorXd climbed(const LogDensity& density, const Eigen::VectorXd& start) {
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = most_iterations;
  const ceres::GradientProblem problem(new Negative(density));
  ceres::GradientProblemSolver::Summary summary;
  Eigen::VectorXd x = start;
  ceres::Solve(options, problem, x.data(), &summary);
  return x.allFinite() && at(density, x) >= at(density, start) ? x : start;
}

/// The inverse of the curvature, from second differences. h: (d), the step of each coordinate.
Eigen::MatrixXd covariance_at(const LogDensity& density, const LaplaceMode& mode, const Eigen::VectorXd& h) {
  const Eigen::Index d = mode.x.size();
  const auto moved = [&](Eigen::Index j, double a, Eigen::Index k, double b) {
    Eigen::VectorXd x = mode.x;
    x[j] += a;
    x[k] += b;
    return at(density, x);
  };
  Eigen::MatrixXd curvature(d, d);
  for (Eigen::Index j = 0; j < d; ++j)
    for (Eigen::Index k = 0; k <= j; ++k) {
      const double a = h[j], b = h[k];
      const double c = j == k ? -(moved(j, a, j, 0) + moved(j, -a, j, 0) - 2 * mode.log_density) / (a * a)
                              : -(moved(j, a, k, b) - moved(j, a, k, -b) - moved(j, -a, k, b) + moved(j, -a, k, -b)) / (4 * a * b);
      curvature(j, k) = curvature(k, j) = std::isfinite(c) ? c : 0;
    }
  auto eigen = symmetric_eigen(curvature);
  constexpr double unknown = LaplaceMode::unknown_sd * LaplaceMode::unknown_sd;
  for (auto& v : eigen.values) v = v > 1 / widest ? 1 / v : unknown;
  return eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose();
}

/// Whether no valley lies between two ends of a search.
bool one_mode(const LogDensity& density, const LaplaceMode& a, const LaplaceMode& b) {
  const double lowest = std::min(a.log_density, b.log_density) - fall;
  constexpr int parts = 24;
  for (int i = 1; i < parts; ++i)
    if (at(density, a.x + (b.x - a.x) * (double(i) / parts)) < lowest) return false;
  return true;
}

}  // namespace

std::vector<LaplaceMode> density_modes(const LogDensity& density, const Eigen::MatrixXd& design, const Eigen::MatrixXd& starts, int threads) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // a failed line search is expected here and needs no log line
  const Eigen::Index d = Eigen::Index(density.dimension());
  std::vector<double> values(std::size_t(design.cols()));
  parallel_for(values.size(), threads, [&](std::size_t i) { values[i] = at(density, design.col(Eigen::Index(i))); });
  std::vector<Eigen::VectorXd> from;
  for (Eigen::Index i = 0; i < starts.cols(); ++i)
    if (std::isfinite(at(density, starts.col(i)))) from.emplace_back(starts.col(i));
  for (const Eigen::Index i : tops(design, values)) from.emplace_back(design.col(i));
  if (from.empty()) throw NumericsError("the density is zero, or the model fails, at the nominal values and at every point of a design over the bounds");

  std::vector<LaplaceMode> modes(from.size());
  parallel_for(from.size(), threads, [&](std::size_t i) {
    modes[i].x = climbed(density, from[i]);
    modes[i].log_density = at(density, modes[i].x);
  });
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) { return a.log_density > b.log_density; });
  std::vector<LaplaceMode> distinct;
  for (auto& m : modes)
    if (std::none_of(distinct.begin(), distinct.end(), [&](const LaplaceMode& other) { return one_mode(density, other, m); })) distinct.push_back(std::move(m));

  std::vector<double> log_weights;
  for (auto& m : distinct) {
    const Eigen::MatrixXd first = covariance_at(density, m, Eigen::VectorXd::Constant(d, first_step));
    m.covariance = covariance_at(density, m, step_sds * first.diagonal().cwiseSqrt());
    log_weights.push_back(m.log_density + Cholesky(m.covariance).half_log_determinant());
  }
  const double greatest = *std::max_element(log_weights.begin(), log_weights.end());
  double sum = 0;
  for (std::size_t i = 0; i < distinct.size(); ++i) distinct[i].weight = std::exp(log_weights[i] - greatest);
  std::erase_if(distinct, [](const LaplaceMode& m) { return m.weight < least_weight; });
  for (const auto& m : distinct) sum += m.weight;
  for (auto& m : distinct) m.weight /= sum;
  std::stable_sort(distinct.begin(), distinct.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return distinct;
}

SamplerStart start_at_modes(const std::vector<LaplaceMode>& modes) {
  expect(!modes.empty(), "chains begin at a mode");
  SamplerStart start{.mean = modes[0].x, .covariance = modes[0].covariance, .points = {}};
  if (modes.size() == 1) return start;
  // Laplace's weights are inaccurate where a mode is not Gaussian, so half of the jumps go to all modes with equal weights.
  for (const auto& m : modes) start.modes.push_back({m.x, m.covariance, 0.5 * m.weight + 0.5 / double(modes.size())});
  return start;
}

}  // namespace calomel
