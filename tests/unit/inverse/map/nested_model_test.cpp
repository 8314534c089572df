// Tests the Bayes factor of nested models against its closed form, and on records without the added term, which must not favour it.
#include "inverse/map/nested_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "tests/unit/inverse/map/fitted.hpp"

namespace calomel {
namespace {

constexpr double step = 1e-6, noise = 0.5;
constexpr std::size_t times = 120;

double unit_time(double t) { return t / (step * double(times)); }

/// y = a + b t + c t^2 on the unit interval; normal priors; the nested model has no c.
AnalyticModel parabola() {
  return {{normal_parameter("a", 0, 2), normal_parameter("b", 1, 3), normal_parameter("c", 0, 4)},
          {[](auto p, double t) { return p[0] + p[1] * unit_time(t) + p[2] * unit_time(t) * unit_time(t); }},
          times,
          step};
}

struct Case {
  AnalyticModel model = parabola();
  Fitted fitted;
  static RecordingOptions recording() {
    RecordingOptions o;
    o.noise = noise;
    return o;
  }
  Case(double curvature, std::uint64_t seed) : fitted(model, pulses_of(model, {0.7, -1.2, curvature}, {.pulses = 1, .noise = noise}, seed), recording()) {}
  NestedModel compare() {
    fitted.in.held = {{2, 0.0}};
    fitted.in.nested_centre = {0.7, -1.2, 0};
    const NestedModel of{.name = "small.out", .added = {"c"}};
    return *fitted.map({0.7, -1.2, 0}, {2, 6, 6}, {}, &of).nested;
  }
  /// The closed form for the linear Gaussian models.
  [[nodiscard]] double closed_form() const {
    Eigen::MatrixXd design(times, 3);
    Eigen::VectorXd y(times);
    for (std::size_t t = 0; t < times; ++t) {
      const double u = double(t) / double(times);
      design.row(Eigen::Index(t)) << 1, u, u * u;
      y[Eigen::Index(t)] = fitted.recordings.values[t];
    }
    const Eigen::Vector3d mean(0, 1, 0), variance(4, 9, 16);
    const auto evidence = [&](Eigen::Index n) {
      const Eigen::MatrixXd d = design.leftCols(n);
      const Cholesky factor(noise * noise * Eigen::MatrixXd::Identity(times, times) + d * variance.head(n).asDiagonal() * d.transpose());
      const Eigen::VectorXd r = y - d * mean.head(n);
      return -0.5 * r.dot(factor.solve(r)) - factor.half_log_determinant();
    };
    return evidence(3) - evidence(2);
  }
};

TEST(NestedModel, TheBayesFactorOfLinearModelsIsTheClosedForm) {
  for (const double curvature : {0.0, 3.0}) {
    Case c(curvature, 4);
    const auto n = c.compare();
    EXPECT_NEAR(n.log_bayes_factor, c.closed_form(), 0.02) << curvature;
    EXPECT_NEAR(n.high - n.low, 2 * std::log(2.0), 1e-9);
    EXPECT_EQ(n.theta[2], 0);
  }
}

TEST(NestedModel, WhatIsThereIsFavouredAndWhatIsNotThereNever) {
  int favoured = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) favoured += Case(0, seed).compare().verdict == NestedVerdict::added_favoured;
  EXPECT_EQ(favoured, 0);
  const auto there = Case(4, 5).compare();
  EXPECT_EQ(there.verdict, NestedVerdict::added_favoured);
  EXPECT_EQ(there.values, times);
  EXPECT_LT(there.chi2, there.nested_chi2 - 12);
  const Json j = nested_json(there, parabola().shape().parameters, "a sentence");
  EXPECT_EQ(j["verdict"], "favoured");
  EXPECT_EQ(j["sentence"], "a sentence");
  EXPECT_EQ(j["theta"]["c"], 0.0);
}

TEST(NestedModel, ItsCentreIsInTheBoxForEveryMode) {
  Case c(3, 5);
  c.fitted.in.held = {{2, 0.0}};
  c.fitted.in.nested_centre = {1.5, 2, 0};
  const NestedModel of{.name = "small.out", .added = {"c"}};
  const auto n = c.fitted.map({0.7, -1.2, 3}, {0.5, 1, 1}, {}, &of).nested;
  EXPECT_NEAR(n->log_bayes_factor, c.closed_form(), 0.1);
}

}  // namespace
}  // namespace calomel
