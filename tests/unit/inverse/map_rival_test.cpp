// Two hypotheses by one yardstick: the Bayes factor against its closed form, a covariance that each fit makes for itself against the shared one, and
// records with nothing added, which must not favour what is added.
#include "inverse/map_rival.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "inverse/map.hpp"
#include "inverse/rival_hypothesis.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

using ::testing::HasSubstr;

constexpr double step = 1e-6, noise = 0.5;
constexpr std::size_t times = 120;

double unit_time(double t) { return t / (step * double(times)); }

/// y = a + b t, and + c t^2 of the larger model, on the unit interval; normal priors.
AnalyticModel parabola(bool larger) {
  std::vector<Parameter> parameters{normal_parameter("a", 0, 2), normal_parameter("b", 1, 3)};
  if (larger) parameters.push_back(normal_parameter("c", 0, 4));
  return {parameters,
          {[larger](auto p, double t) { return p[0] + p[1] * unit_time(t) + (larger ? p[2] * unit_time(t) * unit_time(t) : 0.0); }},
          times, step};
}

struct Case {
  AnalyticModel small = parabola(false), large = parabola(true);
  Recordings recordings;
  RecordingOptions recording;
  MapOptions options{.added_runs = 0, .mesh_pairs = 0};
  std::function<Eigen::MatrixXd(std::span<const double>)> unknowns;
  Case(double curvature, std::uint64_t seed) {
    recording.noise = noise;
    recordings = pulses_of(large, {0.7, -1.2, curvature}, {.pulses = 1, .noise = noise}, seed);
  }
  [[nodiscard]] MapModels models(const ForwardModel& model) const {
    MapModels m{.true_model = model};
    m.unknown_directions = unknowns;
    return m;
  }
  [[nodiscard]] MapSummary fit(const ForwardModel& model) const {
    return run_map(make_problem(model.shape(), recordings, recording), recordings, recording, models(model), options, 1, 1);
  }
  [[nodiscard]] RivalFit rival(const MapSummary& s) const {
    return {.name = "small.out", .sought = {"a", "b"}, .theta = {s.theta[0], s.theta[1], 0}, .history = s.calibrated};
  }
  [[nodiscard]] RivalComparison compare(const RivalFit& rival, const std::vector<double>& theta) const {
    return compare_with_rival(make_problem(large.shape(), recordings, recording), recordings, recording, models(large), options, theta, 0, {}, rival, 1, 1);
  }
  [[nodiscard]] RivalComparison compare() const { return compare(rival(fit(small)), fit(large).theta); }
  /// Of the linear Gaussian models.
  [[nodiscard]] double closed_form() const {
    Eigen::MatrixXd design(times, 3);
    Eigen::VectorXd y(times);
    for (std::size_t t = 0; t < times; ++t) {
      const double u = double(t) / double(times);
      design.row(Eigen::Index(t)) << 1, u, u * u;
      y[Eigen::Index(t)] = recordings.values[t];
    }
    const Eigen::Vector3d mean(0, 1, 0), variance(4, 9, 16);
    const auto evidence = [&](Eigen::Index n) {
      const Eigen::MatrixXd d = design.leftCols(n);
      const Eigen::MatrixXd c = noise * noise * Eigen::MatrixXd::Identity(times, times) + d * variance.head(n).asDiagonal() * d.transpose();
      return ErrorDistribution(c, INFINITY).log_density(y - d * mean.head(n));
    };
    return evidence(3) - evidence(2);
  }
};

TEST(MapRival, TheBayesFactorOfLinearModelsIsTheClosedForm) {
  for (const double curvature : {0.0, 3.0}) {
    const Case c(curvature, 4);
    const auto r = c.compare();
    EXPECT_NEAR(r.log_bayes_factor, c.closed_form(), 0.02) << curvature;
    ASSERT_EQ(r.judgements.size(), 3u);
    for (const auto& j : r.judgements) EXPECT_NEAR(j.log_bayes_factor(), c.closed_form(), 0.02);  // nothing in the covariance hangs on theta here
    EXPECT_THAT(r.added, ::testing::ElementsAre("c"));
    EXPECT_NEAR(r.high - r.low, 2 * std::log(2.0), 0.05);
  }
}

TEST(MapRival, WhatIsThereIsFavouredAndWhatIsNotThereNever) {
  int favoured = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) favoured += Case(0, seed).compare().verdict == RivalVerdict::added_favoured;
  EXPECT_EQ(favoured, 0);
  const auto there = Case(3, 5).compare();
  EXPECT_EQ(there.verdict, RivalVerdict::added_favoured);
  EXPECT_THAT(there.sentence, HasSubstr("favour c over small.out"));
  EXPECT_LT(there.judgements[0].larger.chi2, there.judgements[0].smaller.chi2 - 12);
}

/// Unknowns that grow with the curvature: the larger model's own covariance is the wider one.
Eigen::MatrixXd wide_where_curved(std::span<const double> theta) {
  const double c = theta.size() > 2 ? std::abs(theta[2]) : 0.0;
  return 0.25 * c * Eigen::MatrixXd::Identity(times, times);
}

TEST(MapRival, CovariancesOfTheirOwnMisjudgeAndASharedOneDoesNot) {
  Case c(3, 5);
  c.unknowns = wide_where_curved;
  const auto small = c.fit(c.small), large = c.fit(c.large);
  EXPECT_LT(large.log_evidence_laplace, small.log_evidence_laplace);  // the trap: its determinant alone
  const auto r = c.compare(c.rival(small), large.theta);
  EXPECT_GT(r.log_bayes_factor, 3);
  EXPECT_GT(r.judgements[1].log_bayes_factor(), r.judgements[2].log_bayes_factor());  // the narrow yardstick tells more than the wide one
  EXPECT_LE(r.low, r.judgements[2].log_bayes_factor());
  // And the other way round: unknowns that shrink do not make nothing into something.
  Case none(0, 6);
  none.unknowns = [](std::span<const double> theta) -> Eigen::MatrixXd {
    return Eigen::MatrixXd((theta.size() > 2 ? 0.05 : 0.5) * Eigen::MatrixXd::Identity(times, times));
  };
  const auto s = none.fit(none.small), l = none.fit(none.large);
  EXPECT_GT(l.log_evidence_laplace, s.log_evidence_laplace + 10);  // the trap again
  EXPECT_NE(none.compare(none.rival(s), l.theta).verdict, RivalVerdict::added_favoured);
}

TEST(MapRival, EachIsSearchedFromTheOthersAnswerToo) {
  const Case c(3, 5);
  auto rival = c.rival(c.fit(c.small));
  const auto right = c.compare(rival, c.fit(c.large).theta);
  rival.theta = {0.2, 2.0, 0}, rival.history.clear();  // an answer that is none
  const auto from_afar = c.compare(rival, {0.0, 0.0, 0.0});
  EXPECT_NEAR(from_afar.log_bayes_factor, right.log_bayes_factor, 0.1);
}

TEST(MapRival, AnotherModelOrOtherParametersAreRefused) {
  const Case c(3, 5);
  auto rival = c.rival(c.fit(c.small));
  rival.history[40] += 5;
  EXPECT_THROW((void)c.compare(rival, {0, 0, 0}), InputError);
  rival.history.clear(), rival.sought = {"a", "d"};
  EXPECT_THROW((void)c.compare(rival, {0, 0, 0}), InputError);
  rival.sought = {"a", "b", "c"};
  EXPECT_THROW((void)c.compare(rival, {0, 0, 0}), InputError);
}

/// A model whose values jump with every change of its parameters, by an sd of `rough`, in a manner that hangs on the parameters alone.
class Rough : public ForwardModel {
 public:
  Rough(const ForwardModel& model, double rough) : model_(model), rough_(rough) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    Prediction p = model_.evaluate(theta);
    double mixed = 0;
    for (const double t : theta) mixed = 7 * mixed + t;
    RandomStream random(std::uint64_t(std::abs(1e9 * mixed)), 3);
    for (auto& v : p.mean) v += rough_ * random.normal();
    return p;
  }

 private:
  const ForwardModel& model_;
  double rough_;
};

TEST(MapRival, ARoughModelMakesItLessSure) {
  const Case c(3, 5);
  auto rival = c.rival(c.fit(c.small));
  rival.history.clear();
  const auto problem = make_problem(c.large.shape(), c.recordings, c.recording);
  const Rough rough(c.large, 0.1);
  const auto with = [&](const ForwardModel& model) {
    return compare_with_rival(problem, c.recordings, c.recording, {.true_model = model}, c.options, {0.7, -1.2, 3}, 0, {}, rival, 1, 1);
  };
  const auto smooth = with(c.large), jumps = with(rough);
  EXPECT_LT(smooth.judgements[0].roughness, 0.01);
  // A jump of r' C^-1 e, of sd 0.1 / 0.5 sqrt(chi2): about 2.4, of either hypothesis.
  EXPECT_GT(jumps.judgements[0].roughness, 1);
  EXPECT_LT(jumps.judgements[0].roughness, 9);
  EXPECT_GT(jumps.high - jumps.low, smooth.high - smooth.low + 3);
}

TEST(MapRival, OnlyTheShareWithinTheBoundsCounts) {
  const SearchSpace space({uniform_parameter("p", -1, 1, 0), uniform_parameter("q", -1, 1, 0)});
  const Eigen::MatrixXd narrow = 0.01 * Eigen::MatrixXd::Identity(2, 2);
  EXPECT_EQ(share_within(space, Eigen::Vector2d(0, 0), narrow, 1), 1);
  EXPECT_NEAR(share_within(space, Eigen::Vector2d(1, 0), narrow, 1), 0.5, 3 * 0.5 / std::sqrt(4000.0));
  EXPECT_NEAR(share_within(space, Eigen::Vector2d(-1, 1), narrow, 1), 0.25, 3 * 0.433 / std::sqrt(4000.0));
}

}  // namespace
}  // namespace calomel
