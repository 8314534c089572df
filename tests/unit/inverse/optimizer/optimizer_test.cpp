#include "inverse/optimizer/optimizer.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/gwo.hpp>
#include <set>

#include "base/random.hpp"
#include "inverse/optimizer/de.hpp"
#include "inverse/optimizer/es.hpp"
#include "inverse/optimizer/mfo.hpp"

using namespace calomel;

namespace {

using Function = double (*)(const Eigen::VectorXd& z);  // z: distance from the optimum
double sphere(const Eigen::VectorXd& z) { return z.squaredNorm(); }
double rosenbrock(const Eigen::VectorXd& z) {  // the optimum (1, ..., 1) moved to z = 0
  double f = 0;
  for (Eigen::Index k = 0; k + 1 < z.size(); ++k) {
    const double a = z[k] + 1, b = z[k + 1] + 1;
    f += 100 * (b - a * a) * (b - a * a) + (1 - a) * (1 - a);
  }
  return f;
}
double rastrigin(const Eigen::VectorXd& z) {
  double f = 10.0 * double(z.size());
  for (const double v : z) f += v * v - 10 * std::cos(2 * M_PI * v);
  return f;
}

/// A box of three parameters of different size, with the optimum neither at its centre nor at the origin.
const Bounds box{Eigen::Vector3d(-3, -4, -2.5), Eigen::Vector3d(4.5, 3.5, 5)};
const Eigen::Vector3d optimum(1.37, -2.21, 3.05);

BatchFunction batched(Function f) {
  return [f](const Eigen::MatrixXd& points, std::span<double> values) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) values[std::size_t(i)] = f(points.col(i) - optimum);
  };
}

/// log10 of the best values of 40 seeds, each at least `floor`: mean and standard error.
struct Outcome {
  double mean, error;
};
Outcome outcome(const OptimizerEntry& entry, Function f, double floor = 1e-300) {
  constexpr int runs = 40;
  double sum = 0, squares = 0;
  for (std::uint64_t s = 0; s < runs; ++s) {
    const double v = std::log10(std::max(floor, minimise(entry, batched(f), box, {60, 40}, 11, s).f));
    sum += v;
    squares += v * v;
  }
  const double mean = sum / runs;
  return {mean, std::sqrt(std::max(0.0, squares / runs - mean * mean) / (runs - 1))};
}

/// Negative control: the same number of evaluations, all uniform in the box.
struct RandomSearch {
  int generations = 100;
  unsigned seed = 1;
  [[nodiscard]] pagmo::population evolve(pagmo::population p) const {
    RandomStream random(seed, 0);
    const auto [low, high] = p.get_problem().get_bounds();
    for (int g = 0; g < generations; ++g) {
      pagmo::vector_double flat;
      for (std::size_t i = 0; i < p.size(); ++i)
        for (std::size_t k = 0; k < low.size(); ++k) flat.push_back(random.uniform(low[k], high[k]));
      (void)p.get_problem().batch_fitness(flat);
    }
    return p;
  }
};
const OptimizerEntry random_search = [](int generations, unsigned seed) { return pagmo::algorithm{RandomSearch{generations, seed}}; };

}  // namespace

class EveryOptimizer : public testing::TestWithParam<std::string> {};

TEST_P(EveryOptimizer, BeatsRandomSearchOnShiftedFunctions) {
  for (const Function f : {sphere, rosenbrock, rastrigin}) {
    const auto a = outcome(optimizers().get(GetParam()), f, 1e-3), b = outcome(random_search, f, 1e-3);
    EXPECT_LT(a.mean + 3 * std::hypot(a.error, b.error), b.mean) << "log10 f " << a.mean << " +- " << a.error << " against " << b.mean << " +- " << b.error;
  }
}

TEST_P(EveryOptimizer, GivesTheSameForTheSameSeedOnly) {
  const auto& entry = optimizers().get(GetParam());
  const auto a = minimise(entry, batched(rastrigin), box, {20, 12}, 5, 3), b = minimise(entry, batched(rastrigin), box, {20, 12}, 5, 3);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.trace, b.trace);
  EXPECT_NE(a.x, minimise(entry, batched(rastrigin), box, {20, 12}, 5, 4).x);
  EXPECT_NE(a.x, minimise(entry, batched(rastrigin), box, {20, 12}, 6, 3).x);
}

TEST_P(EveryOptimizer, StaysInTheBoxAndItsTraceFallsToTheResult) {
  bool inside = true;
  const BatchFunction edge = [&](const Eigen::MatrixXd& points, std::span<double> values) {  // the optimum is a corner
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      inside = inside && (points.col(i).array() >= box.low.array()).all() && (points.col(i).array() <= box.high.array()).all();
      values[std::size_t(i)] = (points.col(i) - box.high).squaredNorm();
    }
  };
  const auto r = minimise(optimizers().get(GetParam()), edge, box, {40, 20}, 1, 0);
  EXPECT_TRUE(inside);
  ASSERT_EQ(r.trace.size(), 41u);
  EXPECT_TRUE(std::is_sorted(r.trace.rbegin(), r.trace.rend()));
  EXPECT_EQ(r.trace.back(), r.f);
  EXPECT_LT(r.f, 1e-2);
  EXPECT_LE(r.evaluations, 41u * 20);
  EXPECT_GE(r.evaluations, 30u * 20);
  if (std::set<std::string>{"es", "gwo", "de", "mfo"}.contains(GetParam())) {
    EXPECT_EQ(r.evaluations, 41u * 20);
    EXPECT_EQ(r.calls, 41u);  // a whole generation at a time
  }
}

TEST_P(EveryOptimizer, ToleratesFailedEvaluations) {
  const BatchFunction holes = [](const Eigen::MatrixXd& points, std::span<double> values) {
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      values[std::size_t(i)] = points(0, i) < 0 ? std::numeric_limits<double>::infinity() : (points.col(i) - optimum).squaredNorm();
  };
  const auto r = minimise(optimizers().get(GetParam()), holes, box, {40, 20}, 1, 0);
  EXPECT_TRUE(std::isfinite(r.f));
  EXPECT_LT(r.f, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Registered, EveryOptimizer, testing::ValuesIn(optimizers().names()), [](const auto& info) { return info.param; });

TEST(Optimizers, FindTheShiftedSphere) {
  // Result of each after 60 generations of 40 (log10 of the value, means of 40 seeds); the thresholds leave 3 standard errors.
  const std::pair<const char*, double> limits[] = {{"es", -5}, {"gwo", -2}, {"de", -7}, {"mfo", -3}, {"cmaes", -9}};
  for (const auto& [name, limit] : limits) {
    const auto o = outcome(optimizers().get(name), sphere);
    EXPECT_LT(o.mean + 3 * o.error, limit) << name << ": " << o.mean << " +- " << o.error;
  }
}

TEST(Optimizers, DeAndGwoAreNoWorseThanThoseOfPagmo) {
  const OptimizerEntry de = [](int g, unsigned seed) { return pagmo::algorithm{pagmo::de(unsigned(g), 0.5, 0.9, 7u, 0, 0, seed)}; };
  const OptimizerEntry gwo = [](int g, unsigned seed) { return pagmo::algorithm{pagmo::gwo(unsigned(g), seed)}; };
  for (const auto& [name, peer] : {std::pair{"de", de}, std::pair{"gwo", gwo}})
    for (const Function f : {sphere, rosenbrock}) {
      const auto a = outcome(optimizers().get(name), f), b = outcome(peer, f);
      EXPECT_LT(a.mean, b.mean + 0.7 + 3 * std::hypot(a.error, b.error))
          << name << ": " << a.mean << " +- " << a.error << ", pagmo's " << b.mean << " +- " << b.error;
    }
}

TEST(Optimizers, GreyWolfIsTiedToTheLowerCornerAsPublished) {
  // The documented bias: an optimum at the origin of the scaled box is found far too well.
  const auto corner = [](const Eigen::MatrixXd& points, std::span<double> values) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) values[std::size_t(i)] = (points.col(i) - box.low).squaredNorm();
  };
  EXPECT_LT(minimise(optimizers().get("gwo"), corner, box, {60, 40}, 1, 0).f, 1e-12);
  EXPECT_GT(outcome(optimizers().get("gwo"), sphere).mean, -8);
}

TEST(Optimizers, CommaSelectionWorksToo) {
  const OptimizerEntry comma = [](int g, unsigned seed) { return pagmo::algorithm{EvolutionStrategy{.generations = g, .seed = seed, .plus = false}}; };
  const auto o = outcome(comma, sphere);
  EXPECT_LT(o.mean + 3 * o.error, -3);
}

TEST(Optimizers, RefuseWhatTheyCannotDo) {
  EXPECT_THROW((void)minimise(optimizers().get("de"), batched(sphere), box, {10, 4}, 1, 0), InputError);
  EXPECT_THROW((void)optimizers().get("gow"), InputError);
}
