#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "inverse/enc/enc_rounds.hpp"
#include "inverse/objective/objective_gradient.hpp"

namespace calomel {

namespace {

/// The smoothed cost over u, theta = low + (high - low) (1 + sin u) / 2.
class SmoothedCost final : public ceres::FirstOrderFunction {
 public:
  SmoothedCost(const Problem& problem, const ForwardModel& surrogate, const Objective& objective, const Bounds& bounds, double width, std::size_t& evaluations)
      : problem_(problem), surrogate_(surrogate), objective_(objective), bounds_(bounds), width_(width), evaluations_(evaluations) {}

  bool Evaluate(const double* u, double* cost, double* gradient) const override {
    const std::vector<double> theta = at(u);
    ++evaluations_;
    const Prediction p = surrogate_.evaluate(theta);
    if (!p.ok) return false;
    const ObjectiveGradient s = objective_gradient(problem_, objective_, p.mean, width_);
    if (!std::isfinite(s.cost)) return false;
    *cost = s.cost;
    if (gradient) {
      const Eigen::VectorXd by_theta = surrogate_.vector_jacobian_product(theta, s.weights);
      for (int k = 0; k < NumParameters(); ++k) gradient[k] = by_theta[k] * 0.5 * (bounds_.high[k] - bounds_.low[k]) * std::cos(u[k]);
    }
    return true;
  }
  [[nodiscard]] int NumParameters() const override { return int(bounds_.low.size()); }

  [[nodiscard]] std::vector<double> at(const double* u) const {
    std::vector<double> theta(static_cast<std::size_t>(NumParameters()));
    for (int k = 0; k < NumParameters(); ++k) theta[std::size_t(k)] = bounds_.low[k] + (bounds_.high[k] - bounds_.low[k]) * 0.5 * (1 + std::sin(u[k]));
    return theta;
  }

 private:
  const Problem& problem_;
  const ForwardModel& surrogate_;
  const Objective& objective_;
  const Bounds& bounds_;
  double width_;
  std::size_t& evaluations_;
};

}  // namespace

EncRound gradient_round(const Problem& problem, const ForwardModel& surrogate, const Objective& objective, const BatchCost& batch_cost, const Bounds& bounds,
                        int population, std::uint64_t seed, std::uint64_t stream) {
  constexpr int most_iterations = 60;
  expect(surrogate.has_gradient(), "a gradient search needs a surrogate with a gradient");
  EncRound round{gradient_search, {}, std::numeric_limits<double>::quiet_NaN(), {}, 0};
  double best = std::numeric_limits<double>::infinity();
  const auto consider = [&](const std::vector<double>& theta) {
    const Eigen::MatrixXd point = Eigen::Map<const Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size()));
    const double cost = batch_cost(point)[0];
    if (round.theta.empty() || cost < best) {
      best = cost;
      round.theta = theta;
    }
    ++round.evaluations;
  };
  // 1. The start.
  RandomStream random(seed, stream);
  Eigen::MatrixXd points(bounds.low.size(), population);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (Eigen::Index k = 0; k < points.rows(); ++k) points(k, i) = random.uniform(bounds.low[k], bounds.high[k]);
  const auto costs = batch_cost(points);
  round.evaluations += costs.size();
  const auto start = Eigen::Index(std::min_element(costs.begin(), costs.end()) - costs.begin());
  best = costs[std::size_t(start)];
  round.theta.assign(points.col(start).begin(), points.col(start).end());
  // 2. Down the smoothed objective, ever sharper.
  Eigen::VectorXd u(points.rows());
  for (Eigen::Index k = 0; k < u.size(); ++k) u[k] = std::asin(2 * (points(k, start) - bounds.low[k]) / (bounds.high[k] - bounds.low[k]) - 1);
  for (const double width : {0.3, 0.1, 0.03}) {
    auto* cost = new SmoothedCost(problem, surrogate, objective, bounds, width, round.evaluations);  // the problem owns it
    const ceres::GradientProblem gradient_problem(cost);
    ceres::GradientProblemSolver::Options options;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = most_iterations;
    options.function_tolerance = 1e-9;
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, gradient_problem, u.data(), &summary);
    consider(cost->at(u.data()));
  }
  if (std::isfinite(best)) round.objective = objective.cost(best);
  return round;
}

}  // namespace calomel
