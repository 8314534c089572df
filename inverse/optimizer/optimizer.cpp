#include "inverse/optimizer/optimizer.hpp"

#include <algorithm>
#include <limits>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include "base/random.hpp"

namespace calomel {

namespace {

/// What a run has seen; owned by `minimise`, because pagmo copies problems.
struct Record {
  const BatchFunction& function;
  const Bounds& bounds;
  std::size_t population;
  OptimizerResult result;
  double best_in_generation = std::numeric_limits<double>::infinity();

  pagmo::vector_double evaluate(const pagmo::vector_double& scaled) {
    const Eigen::Index d = bounds.low.size(), n = Eigen::Index(scaled.size()) / d;
    Eigen::MatrixXd points = Eigen::Map<const Eigen::MatrixXd>(scaled.data(), d, n);
    points = ((points.array().colwise() * (bounds.high - bounds.low).array()).colwise() + bounds.low.array()).matrix();
    points = points.cwiseMax(bounds.low.replicate(1, n)).cwiseMin(bounds.high.replicate(1, n));
    pagmo::vector_double values(std::size_t(n), 0.0);
    function(points, values);
    ++result.calls;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double f = values[std::size_t(i)];
      if (result.x.size() == 0 || f < result.f) {
        result.x = points.col(i);
        result.f = f;
      }
      if (++result.evaluations % population == 0) result.trace.push_back(result.f);
    }
    return values;
  }
};

/// The pagmo problem: the unit box and a pointer to the record.
struct UnitBox {
  Record* record = nullptr;
  [[nodiscard]] pagmo::vector_double fitness(const pagmo::vector_double& x) const { return record->evaluate(x); }
  [[nodiscard]] pagmo::vector_double batch_fitness(const pagmo::vector_double& xs) const { return record->evaluate(xs); }
  [[nodiscard]] std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const std::size_t d = record ? std::size_t(record->bounds.low.size()) : 1;
    return {pagmo::vector_double(d, 0.0), pagmo::vector_double(d, 1.0)};
  }
};

}  // namespace

OptimizerResult minimise(const OptimizerEntry& optimizer, const BatchFunction& function, const Bounds& bounds, const OptimizerOptions& options,
                         std::uint64_t seed, std::uint64_t stream) {
  expect(bounds.low.size() == bounds.high.size() && bounds.low.size() > 0 && (bounds.high - bounds.low).minCoeff() > 0, "bounds span a box");
  if (options.population < 5) throw InputError({.problem = "the population is too small", .value = std::to_string(options.population), .range = ">= 5"});
  RandomStream random(seed, stream);
  Record record{function, bounds, std::size_t(options.population), {}};
  const pagmo::problem problem{UnitBox{&record}};
  pagmo::population population{problem, 0u, unsigned(random())};
  const std::size_t d = std::size_t(bounds.low.size());
  pagmo::vector_double first(d * record.population);
  for (auto& x : first) x = random.uniform();
  const auto values = problem.batch_fitness(first);
  for (std::size_t i = 0; i < record.population; ++i)
    population.push_back(pagmo::vector_double(first.begin() + std::ptrdiff_t(i * d), first.begin() + std::ptrdiff_t((i + 1) * d)),
                         pagmo::vector_double{values[i]});
  population = optimizer(options.generations, unsigned(random())).evolve(population);
  // An algorithm that stops early keeps its best; one that evaluates a few points more is cut.
  record.result.trace.resize(std::size_t(options.generations) + 1, record.result.f);
  return std::move(record.result);
}

}  // namespace calomel
