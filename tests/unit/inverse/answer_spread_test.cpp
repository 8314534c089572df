// Standard deviations of ENC and SPE by drawn errors: against closed forms, with negative controls.
#include "inverse/answer_spread.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "base/provenance.hpp"
#include "inverse/drawn_errors.hpp"
#include "inverse/enc.hpp"
#include "inverse/spe.hpp"
#include "lines.hpp"
#include "meshed.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {

const std::vector<double> truth{2.0, 3.0};

double slow(double t) { return 100 * std::sin(3e4 * t); }
double fast(double t) { return 60 * std::sin(5e4 * t + 0.4); }

/// y = a slow(t) + weight b fast(t): the relative error of its one gauge is least at the least-squares fit. A small weight leaves b free.
struct Linear {
  explicit Linear(double noise, double weight = 1, std::uint64_t seed = 5)
      : model({uniform_parameter("a", 1, 3, 1.8), uniform_parameter("b", 1, 5, 2.5)}, {[weight](auto theta, double t) { return theta[0] * slow(t) + weight * theta[1] * fast(t); }}, 300,
              1e-6),
        recordings(pulses_of(model, truth, {.pulses = 12, .noise = noise, .noise_time = 6e-6}, seed)), problem(make_problem(model.shape(), recordings, {})),
        archive(archive_of(model, "chebyshev", 60, 1)) {
    options.values = 100, options.gain_sd = options.energy_scale_sd = 0;
  }
  [[nodiscard]] ErrorsAt errors(Eigen::VectorXd floor_variance = {}) const {
    return [this, floor_variance](std::span<const double> theta, const MeshError& mesh, const RefinedModel::Variance& variance) {
      MapModels models{.true_model = model, .surrogate = variance ? &model : nullptr, .surrogate_variance = variance};
      models.mesh = mesh, models.floor_variance = floor_variance;
      return answer_errors(problem, recordings, {}, options, 0.03, models, theta);
    };
  }
  [[nodiscard]] EncSummary enc(int draws, const ErrorsAt& errors, int candidates = 1, double separation = 0) const {
    EncOptions o;
    o.rounds = 4, o.objective = "rrmse", o.candidates = candidates, o.separation = separation, o.compare_optimizers = {}, o.compare_objectives = {}, o.mesh_pairs = 0, o.draws = draws;
    const EncRuns runs{RunSource(), archive, errors, {}};
    return run_enc(problem, model, model, o, 1, 2, {}, nullptr, &runs);
  }
  [[nodiscard]] SpeSummary spe(int draws, const ErrorsAt& errors) const {
    SpeOptions o;
    o.objective = "rrmse", o.total_degree = {4, 6}, o.tensor_product = {4}, o.lambdas = {0.5, 1};
    o.trials = 12, o.iterations = 40, o.candidates = 5, o.mesh_pairs = 0, o.zoom = 2, o.zoom_runs = 25, o.separation = 0.01, o.draws = draws;
    return run_spe(problem, archive, model, o, 1, 2, {}, nullptr, errors);
  }
  AnalyticModel model;
  Recordings recordings;
  Problem problem;
  Archive archive;
  LikelihoodOptions options;
};

/// Covariance of the least-squares fit to records with the errors of the likelihood: (G'G)^-1 G' C G (G'G)^-1.
Eigen::MatrixXd least_squares_covariance(const Linear& c, double weight) {
  const auto e = c.errors()(truth, {}, {});
  const auto p = Eigen::Index(c.model.shape().times.size());
  Eigen::MatrixXd g(p, 2);
  for (Eigen::Index i = 0; i < p; ++i) g(i, 0) = slow(double(i) * 1e-6), g(i, 1) = weight * fast(double(i) * 1e-6);
  const auto& grid = e.records.grid();
  const Eigen::MatrixXd lifted = grid.lift(Eigen::MatrixXd::Identity(Eigen::Index(grid.size()), Eigen::Index(grid.size())));
  const Eigen::MatrixXd gain = inverse(g.transpose() * g) * g.transpose() * lifted;
  return gain * e.records.covariance() * gain.transpose();
}

TEST(DrawnErrors, TheLeastHistoryHasTheDrawnCoarseValues) {
  const Linear c(3);
  const auto e = c.errors()(truth, {}, {});
  const auto& grid = e.records.grid();
  EXPECT_GT(grid.factor(), 1u);
  const Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(Eigen::Index(grid.size()), -1, 2);
  EXPECT_LT((grid.apply(grid.lift(z)) - z).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(DrawnErrors, RecordsHaveTheCovarianceAboutThePredictionAndTheSizeOfWhatLiesAboveTheBand) {
  const Linear c(3);
  const auto e = c.errors()(truth, {}, {});
  const auto& grid = e.records.grid();
  const auto prediction = c.model.evaluate(truth).mean;
  const DrawnErrors drawn(c.problem, e, truth, prediction, 7);
  const Eigen::VectorXd middle = grid.apply(Eigen::Map<const Eigen::VectorXd>(prediction.data(), Eigen::Index(prediction.size())));
  constexpr int n = 600;
  Eigen::MatrixXd off(middle.size(), n);
  for (int k = 0; k < n; ++k) off.col(k) = grid.apply_record(0, drawn.records(std::size_t(k)).of_runs.observations[0].mean) - middle;
  const Eigen::MatrixXd seen = off * off.transpose() / n;
  const auto& expected = e.records.covariance();
  EXPECT_NEAR(seen.trace() / expected.trace(), 1, 0.15);
  const Eigen::VectorXd smooth = Eigen::VectorXd::Ones(middle.size());
  EXPECT_NEAR(smooth.dot(seen * smooth) / smooth.dot(expected * smooth), 1, 0.25);  // 4 sd of the mean of n squares
  // Above the band the recorded residual stands, with either sign.
  const auto above = [&](const Problem& problem) {
    Eigen::VectorXd r(300);
    for (Eigen::Index t = 0; t < 300; ++t) r[t] = problem.observations[0].mean[std::size_t(t)] - prediction[std::size_t(t)];
    return Eigen::VectorXd(r - grid.lift(grid.apply(r)));
  };
  const Eigen::VectorXd recorded_above = above(c.problem);
  EXPECT_GT(recorded_above.norm(), 1);
  int flipped = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    const Eigen::VectorXd r = above(drawn.records(k).of_runs);
    const bool other = r.dot(recorded_above) < 0;
    flipped += other;
    EXPECT_LT((r - (other ? -1 : 1) * recorded_above).norm(), 1e-9 * recorded_above.norm());
  }
  EXPECT_GT(flipped, 8);
  EXPECT_LT(flipped, 32);
  const auto a = drawn.records(0).of_runs;
  EXPECT_NEAR(a.observations[0].high[50] - a.observations[0].low[50], c.problem.observations[0].high[50] - c.problem.observations[0].low[50], 1e-12);
  EXPECT_EQ(drawn.records(0).moved, drawn.records(0).moved);
  EXPECT_EQ(drawn.runs(0, 0, 2).norm(), 0);  // no floor, no error of runs
}

TEST(EncSpread, IsTheCovarianceOfTheLeastSquaresFit) {
  const Linear c(3);
  const auto s = c.enc(400, c.errors());
  ASSERT_TRUE(s.spread.told()) << s.spread.sentence;
  EXPECT_EQ(s.spread.answers.cols(), 400);
  const Eigen::MatrixXd expected = least_squares_covariance(c, 1);
  for (Eigen::Index k = 0; k < 2; ++k) EXPECT_NEAR(std::sqrt(s.spread.covariance(k, k) / expected(k, k)), 1, 0.14) << k;  // 4 sd of 400 draws
  const auto correlation = [](const Eigen::MatrixXd& m) { return m(0, 1) / std::sqrt(m(0, 0) * m(1, 1)); };
  EXPECT_NEAR(correlation(s.spread.covariance), correlation(expected), 0.2);
  EXPECT_NEAR(s.spread.log_sd[0], std::sqrt(expected(0, 0)) / truth[0], 0.14 * std::sqrt(expected(0, 0)) / truth[0]);
  EXPECT_THAT(s.spread.sentence, HasSubstr("400 draws"));
  const Json j = enc_json(s, c.problem, {});
  EXPECT_EQ(j.at("parameters"), (Json{"a", "b"}));
  EXPECT_NEAR(j.at("covariance")[1][0].get<double>(), s.spread.covariance(1, 0), 1e-15);
  EXPECT_NEAR(j.at("sd").at("b").get<double>(), std::sqrt(s.spread.covariance(1, 1)), 1e-15);
  EXPECT_EQ(j.at("spread").at("answers").size(), 400u);
}

TEST(EncSpread, HalfTheNoiseIsHalfTheDeviationAndTheSeedDecides) {
  const Linear loud(3), quiet(1.5);
  const auto a = loud.enc(100, loud.errors()), b = quiet.enc(100, quiet.errors()), again = loud.enc(100, loud.errors());
  for (Eigen::Index k = 0; k < 2; ++k) EXPECT_NEAR(std::sqrt(b.spread.covariance(k, k) / a.spread.covariance(k, k)), 0.5, 0.1);
  EXPECT_EQ(a.spread.answers, again.spread.answers);
  EXPECT_EQ(a.theta, again.theta);
}

TEST(EncSpread, RunsThatDifferByTheFloorMakeTheDecisionLessSure) {
  const Linear c(1);
  const Eigen::VectorXd floor = Eigen::VectorXd::Constant(300, 30 * 30);
  const auto without = c.enc(60, c.errors(), 6, 0.03), with = c.enc(60, c.errors(floor), 6, 0.03);
  for (Eigen::Index k = 0; k < 2; ++k) EXPECT_GT(with.spread.covariance(k, k), 1.5 * without.spread.covariance(k, k));
}

TEST(EncSpread, WhatTheSurrogateMissesIsPartOfIt) {
  const Linear c(1);
  EncOptions o;
  o.rounds = 4, o.objective = "rrmse", o.candidates = 1, o.separation = 0, o.compare_optimizers = {}, o.compare_objectives = {}, o.mesh_pairs = 0, o.draws = 60;
  const auto sure = c.enc(60, c.errors());
  const EncRuns runs{RunSource(), c.archive, c.errors(), [](auto) { return Eigen::VectorXd(Eigen::VectorXd::Constant(300, 400)); }};
  const auto unsure = run_enc(c.problem, c.model, c.model, o, 1, 2, {}, nullptr, &runs);
  for (Eigen::Index k = 0; k < 2; ++k) EXPECT_GT(unsure.spread.covariance(k, k), 2 * sure.spread.covariance(k, k));
}

/// Pairs of meshes about the truth whose differences scatter by `scatter` in the model's own two shapes, as no smooth function of the parameters would.
MeshError scattered_pairs(const Linear& c, double scatter) {
  RandomStream random(8, 0);
  Eigen::MatrixXd theta(2, 8), differences(300, 8);
  for (Eigen::Index i = 0; i < 8; ++i) {
    theta.col(i) << random.uniform(1.4, 2.6), random.uniform(2, 4);
    const double a = scatter * random.normal(), b = scatter * random.normal();
    for (Eigen::Index t = 0; t < 300; ++t) differences(t, i) = a * slow(double(t) * 1e-6) + b * fast(double(t) * 1e-6);
  }
  return {c.model.shape().parameters, theta, differences, {.mean = 0, .sd = 0, .remainder = 0}};
}

TEST(AnswerSpread, WhatPairsLeaveUnknownOfTheMeshIsPartOfIt) {
  const Linear c(3);
  const auto with = [&](double scatter) -> ErrorsAt {
    return [&c, scatter](std::span<const double> theta, const MeshError&, const RefinedModel::Variance& variance) { return c.errors()(theta, scattered_pairs(c, scatter), variance); };
  };
  // Scatter of the very shapes that the parameters have, in the same units: it goes into the answers as it is, less what eight pairs average out.
  const auto enc = c.enc(60, with(0.2)), enc_sure = c.enc(60, with(1e-6));
  const auto spe = c.spe(32, with(0.2)), spe_sure = c.spe(32, with(1e-6));
  for (Eigen::Index k = 0; k < 2; ++k) {
    EXPECT_GT(std::sqrt(enc.spread.covariance(k, k)), 2 * std::sqrt(enc_sure.spread.covariance(k, k))) << k;
    EXPECT_GT(std::sqrt(spe.spread.covariance(k, k)), 2 * std::sqrt(spe_sure.spread.covariance(k, k))) << k;
    EXPECT_LT(std::sqrt(enc.spread.covariance(k, k)), 0.3) << k;
    EXPECT_LT(std::sqrt(spe.spread.covariance(k, k)), 0.3) << k;
  }
}

TEST(EncSpread, ALikelihoodThatCannotBeBuiltIsToldAndTheAnswerStands) {
  const Linear c(3);
  const ErrorsAt none = [](auto, const auto&, const auto&) -> AnswerErrors { throw InputError({.problem = "a single pulse without noise"}); };
  const auto s = c.enc(20, none);
  EXPECT_FALSE(s.spread.told());
  EXPECT_THAT(s.spread.sentence, HasSubstr("a single pulse without noise"));
  const Json j = enc_json(s, c.problem, {});
  EXPECT_EQ(j.count("covariance"), 0u);
  EXPECT_EQ(j.at("spread").at("sentence"), s.spread.sentence);
  EXPECT_TRUE(s.trusted());
  EXPECT_EQ(enc_json(c.enc(0, none), c.problem, {}).count("spread"), 0u);
}

TEST(SpeSpread, IsAboutThatOfTheLeastSquaresFitAndFallsWithTheNoise) {
  const Linear loud(12), quiet(6);
  const auto a = loud.spe(48, loud.errors()), b = quiet.spe(48, quiet.errors());
  ASSERT_TRUE(a.spread.told()) << a.spread.sentence;
  const Eigen::MatrixXd expected = least_squares_covariance(loud, 1);
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double ratio = std::sqrt(a.spread.covariance(k, k) / expected(k, k));
    EXPECT_GT(ratio, 0.65) << k;  // 48 draws: 0.1; polynomials of a kink and the runs' grid add to it
    EXPECT_LT(ratio, 1.6) << k;
    EXPECT_LT(b.spread.covariance(k, k), 0.6 * a.spread.covariance(k, k));
  }
  EXPECT_EQ(loud.spe(48, loud.errors()).spread.answers, a.spread.answers);
  EXPECT_EQ(spe_json(a, loud.problem, {}).at("spread").at("draws"), 48);
}

TEST(SpeSpread, WhereTheMisfitIsFlatTheDeviationIsLarge) {
  const Linear c(12, 0.01);
  const auto s = c.spe(32, c.errors());
  const auto& p = c.model.shape().parameters;
  EXPECT_LT(std::sqrt(s.spread.covariance(0, 0)), 0.05 * (p[0].max - p[0].min));
  EXPECT_GT(std::sqrt(s.spread.covariance(1, 1)), 0.2 * (p[1].max - p[1].min));
}

TEST(AnswerSpread, TellsOfBoundsAndOfTheImpedance) {
  std::vector<Parameter> parameters{uniform_parameter("density", 12000, 14000, 13500), uniform_parameter("sound_speed", 1300, 1600, 1450)};
  AnswerSpread s;
  s.wanted = 10;
  s.answers.resize(2, 10);
  for (Eigen::Index i = 0; i < 10; ++i) s.answers.col(i) << (i % 2 ? 14000 : 13000), (i % 2 ? 1450.0 * 13500 / 14000 : 1450.0 * 13500 / 13000);  // along constant impedance
  summarise(s, parameters, {13500, 1450});
  EXPECT_EQ(s.at_bounds, 5u);
  EXPECT_THAT(s.sentence, HasSubstr("5 of the draws end on a bound"));
  ASSERT_FALSE(s.combinations.empty());
  EXPECT_LT(s.combinations[0].relative_sd, 0.1 * s.log_sd[0]);
  EXPECT_NEAR(std::sqrt(s.covariance(0, 0)), 500, 1e-9);
  AnswerSpread few;
  few.wanted = 10, few.answers = s.answers.leftCols(5);
  summarise(few, parameters, {13500, 1450});
  EXPECT_FALSE(few.told());
  EXPECT_THAT(few.sentence, HasSubstr("5 of 10"));
}

TEST(AnswerSpread, PairsThatAreFoundTooFarOffWidenIt) {
  const std::vector<Parameter> parameters{uniform_parameter("density", 12000, 14000, 13500), uniform_parameter("sound_speed", 1300, 1600, 1450)};
  const std::vector<double> answer{13500, 1450};
  AnswerSpread drawn;
  drawn.wanted = 8, drawn.answers.resize(2, 8);
  for (Eigen::Index i = 0; i < 8; ++i) drawn.answers.col(i) << 13500 + (i % 2 ? 100 : -100), 1450 + (i % 4 < 2 ? 10 : -10);  // covariance diag(100^2, 10^2)
  summarise(drawn, parameters, answer);
  const auto pairs = [](double deviations, std::size_t n) {
    return std::vector<FoundPair>(n, FoundPair{{13000, 1400}, {13000 + 100 * deviations, 1400 - 10 * deviations}});
  };
  const double middle = 2 * std::log(2.0);  // median of chi-squared with 2 degrees
  AnswerSpread wide = drawn;
  auto found = pairs(3, 5);
  found.push_back(pairs(100, 1)[0]);  // one far off does not decide
  widen(wide, parameters, answer, found);
  EXPECT_NEAR(wide.inflation, 18 / middle, 1e-9);  // each e' C^-1 e is 2 . 3^2
  EXPECT_NEAR(wide.pairs[0].squares, 18, 1e-9);
  EXPECT_NEAR(wide.covariance(0, 0), 1e4 * 18 / middle, 1e-6);
  EXPECT_NEAR(wide.log_sd[1], std::sqrt(18 / middle) * drawn.log_sd[1], 1e-12);
  EXPECT_NEAR(wide.combinations[0].relative_sd, std::sqrt(18 / middle) * drawn.combinations[0].relative_sd, 1e-6);
  EXPECT_THAT(wide.sentence, HasSubstr("6 pairs of runs, each left out in turn, are found 3.6 times as far off"));
  EXPECT_EQ(spread_json(wide, parameters).at("spread").at("left_out_pairs").at("pairs").size(), 6u);
  // Nearer than they should be: nothing is taken back. Five: nothing is judged.
  AnswerSpread near = drawn, few = drawn;
  widen(near, parameters, answer, pairs(0.5, 6)), widen(few, parameters, answer, pairs(3, 5));
  EXPECT_EQ(near.covariance, drawn.covariance);
  EXPECT_EQ(near.pairs.size(), 6u);
  EXPECT_EQ(few.covariance, drawn.covariance);
  EXPECT_EQ(few.sentence, drawn.sentence);
}

TEST(DrawnErrors, RecordsOfAHistoryHaveItForTheirMeanAndTheirOwnBands) {
  const Linear c(3);
  const auto history = c.model.evaluate({std::vector{1.5, 4.0}}).mean;
  const auto p = with_records(c.problem, Eigen::Map<const Eigen::VectorXd>(history.data(), Eigen::Index(history.size())));
  EXPECT_LT(score(p, history).nrmse, 1e-6);
  EXPECT_GT(score(c.problem, history).nrmse, 0.1);
  const auto &now = p.observations[0], &before = c.problem.observations[0];
  EXPECT_NEAR(now.high[70] - now.low[70], before.high[70] - before.low[70], 1e-9);
  EXPECT_NEAR(now.high[70] - now.mean[70], before.high[70] - before.mean[70], 1e-9);
}

}  // namespace
