#include "inverse/optimizer/dgs.hpp"

#include <gsl/gsl_integration.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "inverse/optimizer/generation.hpp"

namespace calomel {

namespace {

struct Rule {
  std::vector<double> node, weight;  ///< for the weight exp(-v^2); the node 0 left out
};

Rule gauss_hermite(int points) {
  const std::unique_ptr<gsl_integration_fixed_workspace, decltype(&gsl_integration_fixed_free)> rule(
      gsl_integration_fixed_alloc(gsl_integration_fixed_hermite, std::size_t(points), 0, 1, 0, 0), gsl_integration_fixed_free);
  expect(rule != nullptr, "GSL gives a Gauss-Hermite rule");
  Rule out;
  for (std::size_t m = 0; m < std::size_t(points); ++m)
    if (const double v = gsl_integration_fixed_nodes(rule.get())[m]; std::abs(v) > 1e-8)
      out.node.push_back(v), out.weight.push_back(gsl_integration_fixed_weights(rule.get())[m]);
  return out;
}

/// A rotation drawn evenly: the orthogonal factor of a Gaussian matrix, its signs fixed by the diagonal of R.
Eigen::MatrixXd random_basis(Eigen::Index d, RandomStream& random) {
  const Eigen::MatrixXd gaussian = Eigen::MatrixXd::NullaryExpr(d, d, [&] { return random.normal(); });
  return orthogonal_factor(gaussian);
}

Eigen::VectorXd projected(const Eigen::VectorXd& x) { return x.cwiseMax(0.0).cwiseMin(1.0); }

struct State {
  RandomStream random;
  Eigen::VectorXd x, direction;
  double f = 0, sigma = 0;
  Eigen::MatrixXd basis;
  int last_reset = 0;
};

}  // namespace

void DgsOptions::validate() const {
  if (shortest_step >= longest_step)
    throw InputError({.problem = "the line search's steps must descend, longest_step = " + number_text(longest_step),
                      .key = "shortest_step",
                      .value = number_text(shortest_step),
                      .range = "< " + number_text(longest_step)});
}

std::size_t dgs_evaluations(const DgsOptions& options, std::size_t d) {
  return d * std::size_t(options.quadrature - options.quadrature % 2) + std::size_t(options.line_search);
}

std::vector<DgsTrial> minimise_dgs(const BatchFunction& function, const Eigen::MatrixXd& starts, const DgsOptions& options, int iterations,
                                   std::uint64_t seed) {
  const Rule rule = gauss_hermite(options.quadrature);
  const Eigen::Index d = starts.rows(), trials = starts.cols(), nodes = Eigen::Index(rule.node.size()), steps = options.line_search;
  std::vector<State> states;
  Eigen::MatrixXd points = starts;
  std::vector<double> values(std::size_t(trials), 0.0);
  function(points, values);
  std::vector<DgsTrial> out(static_cast<std::size_t>(trials));
  for (Eigen::Index t = 0; t < trials; ++t) {
    states.push_back({RandomStream(seed, std::uint64_t(t)), starts.col(t), {}, values[std::size_t(t)], options.radius, Eigen::MatrixXd::Identity(d, d)});
    out[std::size_t(t)] = {starts.col(t), values[std::size_t(t)], {values[std::size_t(t)]}};
  }
  std::vector<double> ladder;
  for (Eigen::Index j = 0; j < steps; ++j)
    ladder.push_back(options.longest_step * std::pow(options.shortest_step / options.longest_step, double(j) / double(steps - 1)));

  for (int i = 0; i < iterations; ++i) {
    // 1. Nonlocal derivatives along every direction.
    points.resize(d, trials * d * nodes);
    values.resize(std::size_t(points.cols()));
    for (Eigen::Index t = 0, c = 0; t < trials; ++t) {
      State& s = states[std::size_t(t)];
      if (options.basis == "random") s.basis = random_basis(d, s.random);
      for (Eigen::Index k = 0; k < d; ++k)
        for (Eigen::Index m = 0; m < nodes; ++m) points.col(c++) = projected(s.x + std::numbers::sqrt2 * s.sigma * rule.node[std::size_t(m)] * s.basis.col(k));
    }
    function(points, values);
    for (Eigen::Index t = 0, c = 0; t < trials; ++t) {
      State& s = states[std::size_t(t)];
      Eigen::VectorXd g = Eigen::VectorXd::Zero(d);
      for (Eigen::Index k = 0; k < d; ++k) {
        double sum = 0;
        for (Eigen::Index m = 0; m < nodes; ++m, ++c)
          sum += rule.weight[std::size_t(m)] * values[std::size_t(c)] * std::numbers::sqrt2 * rule.node[std::size_t(m)];
        g += sum / (std::sqrt(std::numbers::pi) * s.sigma) * s.basis.col(k);
      }
      const double norm = g.norm();
      s.direction = std::isfinite(norm) && norm > 0 ? Eigen::VectorXd(-g / norm) : Eigen::VectorXd(s.basis.col(0));
    }
    // 2. The line search: all steps of the ladder of all trials.
    points.resize(d, trials * steps);
    values.resize(std::size_t(points.cols()));
    for (Eigen::Index t = 0; t < trials; ++t)
      for (Eigen::Index j = 0; j < steps; ++j) {
        const State& s = states[std::size_t(t)];
        points.col(t * steps + j) = projected(s.x + ladder[std::size_t(j)] * s.direction);
      }
    function(points, values);
    for (Eigen::Index t = 0; t < trials; ++t) {
      State& s = states[std::size_t(t)];
      const auto first = values.begin() + t * steps;
      const auto best = std::min_element(first, first + steps);
      double alpha = 0;
      const double before = s.f;
      if (*best < s.f) {
        alpha = ladder[std::size_t(best - first)];
        s.f = *best;
        s.x = points.col(best - values.begin());
      }
      // 3. The next radius.
      s.sigma = std::max(0.5 * (s.sigma + alpha), options.shortest_step);
      const bool stalled = !(std::abs(s.f - before) >= options.tolerance * std::abs(before));
      if (stalled && i - s.last_reset >= options.reset_after) {
        s.sigma = options.radius;
        s.last_reset = i;
      }
      DgsTrial& trial = out[std::size_t(t)];
      trial.x = s.x;
      trial.f = s.f;
      trial.trace.push_back(s.f);
    }
  }
  return out;
}

pagmo::population DirectionalGaussianSmoothing::evolve(pagmo::population population) const {
  const auto& problem = population.get_problem();
  const auto bounds = problem.get_bounds();
  const auto &low = bounds.first, &high = bounds.second;
  const Points start = population.get_x();
  const auto start_f = values_of(population);
  const std::size_t n = start.size(), d = low.size(), budget = std::size_t(generations) * n, each = dgs_evaluations(options, d);
  if (budget < each + 1) return population;
  const std::size_t trials = std::clamp<std::size_t>(budget / (50 * each), 1, n), iterations = (budget - trials) / (trials * each);
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return start_f[i] < start_f[j]; });
  Eigen::MatrixXd starts(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(trials));
  for (std::size_t t = 0; t < trials; ++t)
    for (std::size_t k = 0; k < d; ++k) starts(Eigen::Index(k), Eigen::Index(t)) = (start[order[t]][k] - low[k]) / (high[k] - low[k]);
  const auto natural = [&](double u, std::size_t k) { return low[k] + u * (high[k] - low[k]); };
  const BatchFunction function = [&](const Eigen::MatrixXd& points, std::span<double> values) {
    pagmo::vector_double flat(std::size_t(points.size()));
    for (std::size_t i = 0; i < flat.size(); ++i) flat[i] = natural(points.data()[i], i % d);
    const auto f = problem.batch_fitness(flat);
    std::copy(f.begin(), f.end(), values.begin());
  };
  const auto found = minimise_dgs(function, starts, options, int(iterations), seed);
  for (std::size_t t = 0; t < trials; ++t) {
    pagmo::vector_double x(d);
    for (std::size_t k = 0; k < d; ++k) x[k] = natural(found[t].x[Eigen::Index(k)], k);
    population.set_xf(order[t], x, {found[t].f});
  }
  return population;
}

}  // namespace calomel
