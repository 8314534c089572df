// Score tests with a free scale: uniform p-values for any factor of the covariance, power where chi-squared has none, no effect of the fitted parameters.
#include "inverse/posterior/score_test.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

constexpr std::size_t times = 60;

/// Two gauges, pulses with correlated noise; one fitted direction.
struct Case {
  AnalyticModel model{{uniform_parameter("a", 0.5, 2, 1)},
                      {[](auto p, double t) { return 50 * p[0] * std::sin(2e5 * t); }, [](auto p, double t) { return 30 * p[0] * std::cos(1.1e5 * t); }},
                      times,
                      1e-6};
  Recordings recordings = pulses_of(model, {1}, {.pulses = 6, .noise = 2, .noise_time = 4e-6}, 2);
  Problem problem = make_problem(model.shape(), recordings, {});
  ErrorModel errors{problem, recordings, {}, {.values = 120, .band = 1e9}, {}};
  std::vector<double> history = model.evaluate(std::vector<double>{1}).mean;
  Eigen::MatrixXd fitted = Eigen::Map<const Eigen::VectorXd>(history.data(), Eigen::Index(history.size()));
  Eigen::MatrixXd factor = Cholesky(errors.covariance()).lower();
  EmulatorBox box{model.shape().parameters, std::vector<double>{0.5}, std::vector<double>{2}};
  std::vector<double> middle = box.theta(Eigen::VectorXd::Zero(1));

  /// The posterior with a given residual at the middle of the box. The emulator was trained on the model's one direction, or on more columns of the kind.
  [[nodiscard]] LogPosterior posterior(const Eigen::VectorXd& residual) const {
    EmulatorRuns runs{.u = Eigen::MatrixXd(1, 9), .level = std::vector<int>(9, 0), .levels = 1};
    Eigen::MatrixXd outputs(factor.rows(), 9);
    for (Eigen::Index i = 0; i < 9; ++i) {
      runs.u(0, i) = -1 + 0.25 * double(i);
      outputs.col(i) = errors.data() - residual + errors.grid().apply(fitted) * runs.u(0, i);
    }
    const MultilevelRegression e(runs, outputs, Eigen::VectorXd::Ones(outputs.rows()));
    return {box, e, e.fit(outputs), {{errors}}, Eigen::MatrixXd::Zero(factor.rows(), factor.rows()), priors_of(model.shape().parameters), {}};
  }
  [[nodiscard]] ScoreTests tests(const Eigen::VectorXd& residual, const std::vector<MechanismDirections>& of, const Eigen::MatrixXd& runs = {}) const {
    const LogPosterior p = posterior(residual);
    return score_tests(p, p.point(p.q(middle, 0)), errors.grid(), of, runs);
  }

  /// Two shapes in time that the model cannot produce.
  [[nodiscard]] MechanismDirections other() const {
    MechanismDirections l{.name = "other", .keys = {"early", "late"}, .off = {0, 3}, .directions = Eigen::MatrixXd::Zero(Eigen::Index(2 * times), 2)};
    for (std::size_t t = 0; t < times; ++t)
      l.directions(Eigen::Index(t), 0) = std::exp(-double(t) / 20), l.directions(Eigen::Index(times + t), 1) = std::sin(0.25 * double(t));
    return l;
  }
  /// A residual with covariance times `scale` that contains `amount` of the other shapes, with the fitted direction projected out.
  [[nodiscard]] Eigen::VectorXd residual(double scale, const Eigen::Vector2d& amount, std::uint64_t draw) const {
    RandomStream random(11, draw);
    Eigen::VectorXd z(factor.rows());
    for (auto& x : z) x = random.normal();
    return std::sqrt(scale) * factor * z + errors.grid().apply(Eigen::VectorXd(other().directions * amount + 0.3 * fitted.col(0)));
  }
};

TEST(ScoreTests, PValuesAreUniformWhateverTheCovariancesScale) {
  const Case c;
  for (const double scale : {0.05, 1.0, 20.0}) {
    constexpr int draws = 400;
    int below_half = 0, below_twentieth = 0, stands_out = 0;
    double mean_scale = 0;
    for (int i = 0; i < draws; ++i) {
      const auto s = c.tests(c.residual(scale, {0, 0}, std::uint64_t(i)), {c.other()});
      ASSERT_EQ(s.mechanisms.size(), 1u);
      EXPECT_EQ(s.mechanisms[0].directions, 2);
      below_half += s.mechanisms[0].p_value < 0.5, below_twentieth += s.mechanisms[0].p_value < 0.05, stands_out += s.stands_out, mean_scale += s.scale / draws;
    }
    EXPECT_NEAR(double(below_half) / draws, 0.5, 3 * std::sqrt(0.25 / draws));
    EXPECT_NEAR(double(below_twentieth) / draws, 0.05, 3 * std::sqrt(0.05 * 0.95 / draws));
    EXPECT_LE(stands_out, 3);
    EXPECT_NEAR(mean_scale, scale, 0.05 * scale);
  }
}

TEST(ScoreTests, AnErrorOfTheModelThatLooksLikeAMechanismIsHeldAgainstPairs) {
  // Residuals that contain the other shapes by chance, as a mesh's do: each fit, of pairs of runs and of records, looks as if the mechanism were present.
  const Case c;
  constexpr int draws = 200;
  int alone = 0, held = 0, found = 0;
  for (int i = 0; i < draws; ++i) {
    RandomStream random(17, std::uint64_t(i));
    const auto by_chance = [&](std::uint64_t k, const Eigen::Vector2d& more) {
      const Eigen::Vector2d amount(2 * random.normal(), 2 * random.normal());
      return c.residual(1, amount + more, 10 * std::uint64_t(i) + k);
    };
    Eigen::MatrixXd pairs(c.factor.rows(), 6);
    for (Eigen::Index k = 0; k < 6; ++k) pairs.col(k) = by_chance(std::uint64_t(k), {0, 0});
    const Eigen::VectorXd r = by_chance(7, {0, 0}), there = by_chance(8, {40, 40});
    alone += c.tests(r, {c.other()}).stands_out;
    const auto s = c.tests(r, {c.other()}, pairs);
    held += s.stands_out;
    EXPECT_GT(s.mechanisms[0].f_of_runs, 1);
    found += c.tests(there, {c.other()}, pairs).stands_out;
  }
  EXPECT_GT(alone, draws / 3);
  EXPECT_LT(held, draws / 20);
  EXPECT_GT(found, draws / 2);
}

TEST(ScoreTests, PairsThatDoNotPointThereTakeNothingFromIt) {
  const Case c;
  Eigen::MatrixXd pairs(c.factor.rows(), 6);
  for (Eigen::Index k = 0; k < 6; ++k) pairs.col(k) = c.residual(0.1, {0, 0}, 100 + std::uint64_t(k));
  for (std::uint64_t i = 0; i < 20; ++i) {
    const Eigen::VectorXd r = c.residual(1, {1, 1}, i);
    const auto with = c.tests(r, {c.other()}, pairs), without = c.tests(r, {c.other()});
    EXPECT_GE(with.mechanisms[0].p_value, without.mechanisms[0].p_value);
    EXPECT_EQ(with.mechanisms[0].f, without.mechanisms[0].f);
    EXPECT_EQ(without.mechanisms[0].f_of_runs, 1);
    const bool like_noise = with.mechanisms[0].f_of_runs <= 1;
    EXPECT_TRUE(!like_noise || with.mechanisms[0].p_value == without.mechanisms[0].p_value);
  }
}

TEST(ScoreTests, SeesThroughACovarianceThatIsTooWideWhereChiSquaredDoesNot) {
  const Case c;
  const double scale = 0.1;  // ten times too wide
  const Eigen::Vector2d amount(3, 1.5);
  const Eigen::VectorXd r = c.residual(scale, amount, 1);
  const double freedom = double(r.size() - 1);
  EXPECT_LT(Cholesky(c.errors.covariance()).solve_lower(Eigen::MatrixXd(r - c.errors.grid().apply(Eigen::VectorXd(0.3 * c.fitted.col(0))))).squaredNorm(),
            freedom);  // by its size nothing is missing
  const auto s = c.tests(r, {gauge_gains(c.problem, c.history), c.other()});
  EXPECT_TRUE(s.stands_out) << s.p_value;
  EXPECT_EQ(s.mechanisms[0].name, "other");
  EXPECT_EQ(s.first(), &s.mechanisms[0]);
  EXPECT_EQ(s.counted(), 2u);
  EXPECT_FALSE(s.with_runs);
  ASSERT_EQ(s.mechanisms[0].keys.size(), 2u);
  EXPECT_NEAR(s.mechanisms[0].keys[0].value, 3, 4 * s.mechanisms[0].keys[0].sd);
  EXPECT_NEAR(s.mechanisms[0].keys[1].value, 3 + 1.5, 4 * s.mechanisms[0].keys[1].sd);  // from its off value
  EXPECT_LT(s.mechanisms[0].keys[0].sd, 1);
  const Json j = score_tests_json(s, "it points there");
  EXPECT_EQ(j["mechanisms"][0]["name"], "other");
  EXPECT_TRUE(j["mechanisms"][0]["keys"].contains("late"));
  EXPECT_EQ(j["stands_out"], true);
  EXPECT_EQ(j["sentence"], "it points there");
}

TEST(ScoreTests, WhatTheParametersCanDoIsNotHeldAgainstTheModel) {
  const Case c;
  const MechanismDirections same{.name = "same", .keys = {"k"}, .off = {0}, .directions = 1e-6 * c.fitted},
      none{.name = "none", .keys = {"k"}, .off = {0}, .directions = 0 * c.fitted};
  const auto s = c.tests(c.residual(0.1, {3, 1.5}, 1), {same, none});
  for (const auto& m : s.mechanisms) {
    EXPECT_EQ(m.directions, 0) << m.name;
    EXPECT_EQ(m.p_value, 1) << m.name;
  }
  EXPECT_FALSE(s.stands_out);
  // Gains of two gauges; the parameter is one combination of them.
  EXPECT_EQ(c.tests(c.residual(1, {0, 0}, 1), {gauge_gains(c.problem, c.history)}).mechanisms[0].directions, 1);
}

}  // namespace
}  // namespace calomel
