// SPE over wide bounds: boxes that shrink, candidates from the campaign, optima where runs are likely to fail.
#include "inverse/spe/zoom.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "base/provenance.hpp"
#include "inverse/spe/spe.hpp"
#include "tests/unit/inverse/meshed.hpp"

using namespace calomel;
using testing::Contains;
using testing::HasSubstr;

namespace {

const std::vector<double> truth{12100, 1630, 2.3e4};

struct Case {
  Oscillations model{120};
  Recordings recordings = recorded(model, truth, 8, 4e-6, 4);
  Problem problem = make_problem(model.shape(), recordings, {});
};

SpeOptions small() {
  SpeOptions o;
  o.objective = "rrmse", o.total_degree = {5, 8}, o.tensor_product = {4}, o.lambdas = {0.5, 1, 2};
  o.trials = 12, o.iterations = 40, o.candidates = 5, o.zoom = 0;
  return o;
}

const Bounds square{Eigen::Vector2d(0, 0), Eigen::Vector2d(10, 1)};

TEST(SpeZoom, TheBoxIsHalvedAboutTheBest) {
  const Bounds b = next_box(square, square, {9.8, 0.4}, true);
  EXPECT_DOUBLE_EQ(b.low[0], 5);  // inside the bounds
  EXPECT_DOUBLE_EQ(b.high[0], 10);
  EXPECT_DOUBLE_EQ(b.low[1], 0.15);
  EXPECT_DOUBLE_EQ(b.high[1], 0.65);
}

TEST(SpeZoom, WhereTheBestLiesAtTheEdgeTheBoxMoves) {
  const Bounds now{Eigen::Vector2d(2, 0), Eigen::Vector2d(6, 0.5)};
  EXPECT_TRUE(at_edge(square, now, {5.9, 0.2}));
  EXPECT_FALSE(at_edge(square, now, {4, 0.02}));  // 0 is a bound: the box does not go beyond it
  EXPECT_TRUE(at_edge(square, now, {4, 0.48}));
  const Bounds b = next_box(square, now, {5.9, 0.02}, true);
  EXPECT_NEAR(b.low[0], 3.9, 1e-12);
  EXPECT_NEAR(b.high[0], 7.9, 1e-12);
  EXPECT_NEAR(b.low[1], 0, 1e-12);
  EXPECT_NEAR(b.high[1], 0.25, 1e-12);
  const Bounds same = next_box(square, now, {4, 0.3}, false);
  EXPECT_NEAR(same.high[1] - same.low[1], 0.5, 1e-12);
}

TEST(SpeZoom, NewRunsLieInTheBox) {
  const Case c;
  const Bounds box{Eigen::Vector3d(11500, 1500, 1e4), Eigen::Vector3d(13000, 1800, 3e4)};
  const Eigen::MatrixXd points = points_in(box, c.model.shape().parameters, 30, 7);
  ASSERT_EQ(points.cols(), 30);
  EXPECT_TRUE(((points.colwise() - box.low).array() >= 0).all());
  EXPECT_TRUE(((-points).colwise() + box.high).minCoeff() >= 0);
  EXPECT_EQ(points, points_in(box, c.model.shape().parameters, 30, 7));
}

/// The misfit has a narrow valley in wide bounds, which polynomials over the whole range do not follow.
TEST(SpeZoom, FindsWhatPolynomialsOfTheWholeBoxMiss) {
  const Case c;
  const auto archive = archive_of(c.model, "chebyshev", 80, 3);
  auto o = small();
  const auto plain = run_spe(c.problem, archive, c.model, o, 1, 2);
  o.zoom = 3, o.zoom_runs = 40;
  const auto zoomed = run_spe(c.problem, archive, c.model, o, 1, 2);
  EXPECT_LT(*zoomed.best.objective_model, 0.5 * *plain.best.objective_model);
  EXPECT_LT(std::abs(zoomed.theta[1] / truth[1] - 1), 0.01);
  ASSERT_GE(zoomed.zooms.size(), 3u);
  const auto& last = zoomed.zooms.back();
  EXPECT_LT(last.high[1] - last.low[1], 0.8 * 1000);
  EXPECT_GE(last.high[1] - last.low[1], 0.125 * 1000 - 1e-9);
  EXPECT_GE(last.runs, last.made);
  EXPECT_GT(last.made, 30u);
  EXPECT_EQ(spe_json(zoomed, c.problem, {}, {}).at("zoom").size(), zoomed.zooms.size());
  // The result is the same with one thread and with two.
  EXPECT_EQ(run_spe(c.problem, archive, c.model, o, 1, 1).theta, zoomed.theta);
}

TEST(SpeZoom, TheAnswerIsNeverWorseThanARunOfTheCampaign) {
  const Case c;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto archive = archive_of(c.model, "chebyshev", 40, seed);
    auto o = small();
    o.refinements = 0, o.total_degree = {3}, o.tensor_product = {}, o.candidates = 1;  // far too coarse
    double best = 1e9;
    for (Eigen::Index i = 0; i < archive.mean.cols(); ++i) {
      const Eigen::VectorXd y = archive.mean.col(i).cast<double>();
      best = std::min(best, score(c.problem, {y.data(), std::size_t(y.size())}).nrmse);
    }
    const auto s = run_spe(c.problem, archive, c.model, o, seed, 1);
    EXPECT_LE(*s.best.objective_model, best * (1 + 1e-9)) << seed;
    o.known_candidates = 0;
    const auto blind = run_spe(c.problem, archive, c.model, o, seed, 1);
    EXPECT_GE(*blind.best.objective_model, *s.best.objective_model);
    EXPECT_EQ(s.model_runs, blind.model_runs);  // the check cost no run
  }
}

TEST(SpeZoom, OptimaWhereRunsFailAreLeftOut) {
  Case c;
  c.model.fails = [](std::span<const double> t) { return t[1] > 1550; };  // the truth lies beyond the bounds
  const auto archive = archive_of(c.model, "chebyshev", 150, 1);
  auto o = small();
  o.zoom = 1;
  const auto s = run_spe(c.problem, archive, c.model, o, 1, 2);
  EXPECT_EQ(s.status, CalibrationStatus::done);
  EXPECT_LE(s.theta[1], 1550);
  EXPECT_GT(s.optima_left_out, 0u);
  for (const auto& x : s.optima) EXPECT_LT(x.theta[1], 1650);
}

}  // namespace
