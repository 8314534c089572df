// The mode, its covariance and evidence against closed forms; coverage over many data sets, with the likelihood that must fail.
#include "inverse/map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "base/json.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"
#include "inverse/map_judgement.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double step = 1e-6;
constexpr std::size_t times = 120;

/// y = a + b t on the unit interval, normal priors.
AnalyticModel line() {
  return {{normal_parameter("a", 0, 2), normal_parameter("b", 1, 3)}, {[](auto theta, double t) { return theta[0] + theta[1] * t / (step * times); }}, times, step};
}

MapSummary map_of(const ForwardModel& model, const Recordings& recordings, const RecordingOptions& recording, MapOptions options = {}) {
  const Problem problem = make_problem(model.shape(), recordings, recording);
  return run_map(problem, recordings, recording, {.true_model = model}, options, 1, 1);
}

TEST(Map, OfALinearModelIsTheClosedForm) {
  const auto model = line();
  RecordingOptions recording;
  recording.noise = 0.5;
  const auto recordings = pulses_of(model, {0.7, -1.2}, {.pulses = 1, .noise = 0.5}, 4);
  const auto summary = map_of(model, recordings, recording);
  // Posterior precision, mean and evidence of the linear Gaussian model.
  Eigen::MatrixXd design(times, 2);
  Eigen::VectorXd y(times);
  for (std::size_t t = 0; t < times; ++t) {
    design.row(Eigen::Index(t)) << 1, double(t) / times;
    y[Eigen::Index(t)] = recordings.values[t];
  }
  const Eigen::Vector2d mean(0, 1);
  const Eigen::Matrix2d prior = Eigen::Vector2d(4, 9).asDiagonal();
  const Eigen::MatrixXd total = 0.25 * Eigen::MatrixXd::Identity(times, times) + design * prior * design.transpose();
  const Eigen::Matrix2d covariance = (design.transpose() * design / 0.25 + Eigen::Matrix2d(prior.inverse())).inverse();
  const Eigen::Vector2d mode = covariance * (design.transpose() * y / 0.25 + prior.inverse() * mean);
  const double evidence = ErrorDistribution(total, INFINITY).log_density(y - design * mean);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(summary.theta[std::size_t(k)], mode[k], 1e-4 * std::sqrt(covariance(k, k)));
  EXPECT_LT((summary.covariance - covariance).cwiseAbs().maxCoeff(), 1e-4 * covariance.maxCoeff());
  EXPECT_NEAR(summary.log_evidence_laplace, evidence, 1e-3);
  EXPECT_EQ(summary.effective_data, double(times));
  EXPECT_TRUE(summary.adequate) << summary.adequacy;
  EXPECT_EQ(summary.widening, 1);
  EXPECT_NEAR(summary.best.objective_model.value(), summary.log_likelihood + summary.log_prior, 1e-6);
}

TEST(Map, RoundsThatMovedTheOptimumWidenItByTheirDistance) {
  const SearchSpace space({uniform_parameter("a", 1, 100, 10), uniform_parameter("b", -5, 5, 0)});
  const auto round = [](double a, double b) {
    RefinementRound r;
    r.theta = {a, b};
    return r;
  };
  const Eigen::VectorXd x = space.from(std::vector<double>{10, 1});
  MapRefinement moved;
  moved.rounds = {round(90, -4), round(10 * std::exp(0.1), 1.2), round(10 * std::exp(-0.3), 1), round(10, 1)};
  // The first round does not count; a is searched by its logarithm. (0.1^2 + 0.3^2) / 3, (0.2^2) / 3, 0.1 * 0.2 / 3.
  const Eigen::MatrixXd spread = spread_of_rounds(moved, space, x);
  EXPECT_NEAR(spread(0, 0), 0.1 / 3, 1e-12);
  EXPECT_NEAR(spread(1, 1), 0.04 / 3, 1e-12);
  EXPECT_NEAR(spread(0, 1), 0.02 / 3, 1e-12);
  // One that stayed is not widened, nor one of two rounds, whose second may still be far from where nothing was known.
  MapRefinement stayed;
  stayed.rounds = {round(90, -4), round(10, 1), round(10, 1)};
  EXPECT_LT(spread_of_rounds(stayed, space, x).norm(), 1e-20);
  stayed.rounds = {round(90, -4), round(20, 1)};
  EXPECT_EQ(spread_of_rounds(stayed, space, x).norm(), 0);
}

TEST(Map, AFitThatIsNotAdequateSaysSoAndIsWidened) {
  const auto model = line();
  RecordingOptions recording;
  recording.noise = 0.05;
  auto recordings = pulses_of(model, {0.7, -1.2}, {.pulses = 1, .noise = 0.05}, 4);
  for (std::size_t t = 0; t < times; ++t) recordings.values[t] += 0.3 * std::sin(0.2 * double(t));
  const auto summary = map_of(model, recordings, recording);
  EXPECT_FALSE(summary.adequate);
  EXPECT_GT(summary.widening, 5);
  EXPECT_THAT(summary.adequacy, HasSubstr("not adequate"));
}

/// Two oscillations whose frequency and damping are sought; nonlinear in both.
AnalyticModel ringing() {
  return {{uniform_parameter("frequency", 10e3, 30e3, 20e3), uniform_parameter("damping", 1e3, 5e4, 1e4)},
          {[](auto p, double t) { return 100 * std::exp(-p[1] * t) * std::sin(2 * M_PI * p[0] * t); },
           [](auto p, double t) { return 80 * std::exp(-p[1] * t) * (1 - std::cos(2 * M_PI * p[0] * t)); }},
          200, step};
}

struct Coverage {
  int one = 0, two = 0, parameters = 0;
  [[nodiscard]] double share(int n) const { return double(n) / parameters; }
};

Coverage coverage(const RecordingOptions& recording, const LikelihoodOptions& likelihood, bool repeats_known) {
  const auto model = ringing();
  Coverage c;
  for (int set = 0; set < 100; ++set) {
    RandomStream random(17, std::uint64_t(set));
    const std::vector<double> truth{random.uniform(15e3, 25e3), random.uniform(6e3, 3e4)};
    auto recordings = pulses_of(model, truth, {.pulses = 12, .noise = 12, .noise_time = 12e-6}, std::uint64_t(1000 + set));
    if (!repeats_known) {  // the mean record as if it were one pulse of independent noise
      const std::size_t n = recordings.time.size();
      std::vector<double> mean(2 * n, 0.0);
      for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t p = 0; p < 12; ++p)
          for (std::size_t t = 0; t < n; ++t) mean[s * n + t] += recordings.values[recordings.at(0, s, p, t)] / 12;
      recordings.pulses = {0}, recordings.values = mean;
    }
    MapOptions options{.starts = 4, .design = 64, .candidates = 1, .widen = false, .likelihood = likelihood};
    const auto summary = map_of(model, recordings, recording, options);
    for (int k = 0; k < 2; ++k) {
      const double z = std::abs(summary.theta[std::size_t(k)] - truth[std::size_t(k)]) / std::sqrt(summary.covariance(k, k));
      c.one += z < 1, c.two += z < 2, ++c.parameters;
    }
  }
  return c;
}

TEST(Map, IntervalsCoverTheTruthAsOftenAsTheySay) {
  const auto c = coverage({}, {.values = 140, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0, .coherent_noise = 0}, true);
  // 200 intervals of 100 data sets; their parameters are nearly independent: standard errors 0.033 and 0.015.
  EXPECT_NEAR(c.share(c.one), 0.683, 3 * 0.033);
  EXPECT_NEAR(c.share(c.two), 0.954, 3 * 0.015);
}

TEST(Map, IndependentErrorsUnderCorrelatedNoiseDoNotCover) {
  RecordingOptions recording;
  recording.noise = 12 / std::sqrt(12.0);  // the right sd, the wrong correlation
  const auto c = coverage(recording, {.values = 400}, false);
  EXPECT_LT(c.share(c.one), 0.683 - 4 * 0.033);
  EXPECT_LT(c.share(c.two), 0.954 - 4 * 0.015);
}

/// A model that knows of density and sound speed only their product.
AnalyticModel impedance_only() {
  auto model = AnalyticModel({uniform_parameter("density", 11000, 15000, 13500), uniform_parameter("sound_speed", 1200, 1700, 1450),
                              uniform_parameter("tensile_cutoff", 5e4, 5e5, 1.5e5)},
                             {[](auto p, double t) { return 5e-6 * p[0] * p[1] * std::sin(8e4 * t) + 2e-4 * p[2] * std::sin(3e4 * t); },
                              [](auto p, double t) { return 3e-6 * p[0] * p[1] * std::cos(6e4 * t) + 1e-4 * p[2] * std::cos(1e5 * t); }},
                             200, step);
  return model;
}

TEST(Map, ARidgeOfConstantImpedanceIsNamed) {
  const auto model = impedance_only();
  const auto recordings = pulses_of(model, {13200, 1400, 2e5}, {.pulses = 10, .noise = 3, .noise_time = 5e-6}, 6);
  const auto summary = map_of(model, recordings, {}, {.likelihood = {.values = 200}});
  const auto& id = summary.identification;
  ASSERT_EQ(id.directions.size(), 3u);
  const auto& open = id.directions.back();
  EXPECT_NEAR(std::abs(open.exponents[0]), std::sqrt(0.5), 0.02);
  EXPECT_LT(open.exponents[0] * open.exponents[1], 0);  // rho / c is free, rho c is not
  EXPECT_NEAR(std::abs(open.exponents[2]), 0, 0.02);
  EXPECT_GT(open.data_sd, 5 * open.prior_sd);
  EXPECT_THAT(id.sentence, HasSubstr("leave free"));
  ASSERT_EQ(id.combinations.size(), 2u);
  const auto& z = id.combinations[0];
  EXPECT_EQ(z.name, "impedance rho c");
  EXPECT_NEAR(std::log(z.value / (13200.0 * 1400)), 0, 4 * z.relative_sd);
  EXPECT_LT(z.relative_sd, 0.03);  // gains and energy of 1 and 1.5 %, and the noise
  EXPECT_GT(id.combinations[1].relative_sd, 3 * z.relative_sd);
}

/// A wrapper that is off by a factor and fails in a corner: a poor surrogate.
class Poor : public ForwardModel {
 public:
  Poor(const ForwardModel& model, double factor) : model_(model), factor_(factor) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    if (theta[0] > 23e3) return {.ok = false, .message = "outside what it has learnt"};
    Prediction p = model_.evaluate(theta);
    for (auto& v : p.mean) v *= factor_;
    return p;
  }

 private:
  const ForwardModel& model_;
  double factor_;
};

TEST(Map, FailingPointsOfASurrogateAreBorneAndTheTrueModelHasTheLastWord) {
  const auto model = ringing();
  const Poor surrogate(model, 1.05);
  const auto recordings = pulses_of(model, {21e3, 1.4e4}, {.pulses = 8, .noise = 4, .noise_time = 6e-6}, 3);
  const Problem problem = make_problem(model.shape(), recordings, {});
  MapModels models{.true_model = model, .surrogate = &surrogate};
  models.surrogate_variance = [](std::span<const double>) { return Eigen::VectorXd::Constant(400, 9.0); };
  const auto summary = run_map(problem, recordings, {}, models, {.likelihood = {.values = 150}}, 1, 1);
  ASSERT_EQ(summary.status, CalibrationStatus::done);
  for (int k = 0; k < 2; ++k)
    EXPECT_LT(std::abs(summary.theta[std::size_t(k)] - (k == 0 ? 21e3 : 1.4e4)), 4 * std::sqrt(summary.covariance(k, k)));
  for (const auto& c : summary.candidates) EXPECT_GE(*summary.best.objective_model, *c.objective_model);
  EXPECT_GE(summary.best.objective_model, summary.at_nominal.objective_model);
}

TEST(Map, NothingThatRunsIsAStatus) {
  auto model = ringing();
  const auto recordings = pulses_of(model, {21e3, 1.4e4}, {.pulses = 8, .noise = 4}, 3);
  model.fails = [](auto) { return true; };
  const auto summary = map_of(model, recordings, {});
  EXPECT_EQ(summary.status, CalibrationStatus::no_candidate);
  EXPECT_FALSE(summary.trusted());
}

TEST(Map, AMeshShiftOnlyMovesTheAnswerBack) {
  // The working mesh is 10 % low; two pairs of runs told so.
  const auto model = ringing();
  const Poor coarse(model, 0.9);
  const std::vector<double> truth{20e3, 1.4e4};
  const auto recordings = pulses_of(model, truth, {.pulses = 8, .noise = 1, .noise_time = 6e-6}, 3);
  const Problem problem = make_problem(model.shape(), recordings, {});
  const auto shifted = [&](bool with) {
    MapModels models{.true_model = coarse};
    if (with) {
      Eigen::MatrixXd theta(2, 2), difference(400, 2);
      theta << 19.8e3, 20.2e3, 1.3e4, 1.5e4;
      for (Eigen::Index i = 0; i < 2; ++i) {
        const auto fine = model.evaluate({theta.col(i).data(), 2}).mean, rough = coarse.evaluate({theta.col(i).data(), 2}).mean;
        for (std::size_t k = 0; k < 400; ++k) difference(Eigen::Index(k), i) = fine[k] - rough[k];
      }
      models.mesh = MeshError(model.shape().parameters, theta, difference, {.mean = 0, .sd = 0, .remainder = 0});
    }
    return run_map(problem, recordings, {}, models, {.likelihood = {.values = 150, .energy_scale_sd = 0, .gain_sd = 0}}, 1, 1);
  };
  const auto with = shifted(true), without = shifted(false);
  EXPECT_LT(std::abs(with.theta[1] - truth[1]), 4 * std::sqrt(with.covariance(1, 1)));
  EXPECT_GT(std::abs(without.theta[1] - truth[1]), 4 * std::abs(with.theta[1] - truth[1]));
  EXPECT_FALSE(without.adequate);
}

/// A surrogate whose frequency is off by a share that grows with the damping, of a working mesh that is off itself.
struct Levels {
  AnalyticModel fine = ringing();
  AnalyticModel working, surrogate = warped(1.05, 0.93, 0);
  /// The working mesh's frequency wobbles about its own by `wobble`, from place to place.
  explicit Levels(double wobble = 0) : working(warped(1.02, 0.95, wobble)) {}
  static AnalyticModel warped(double frequency, double damping, double wobble) {
    const auto pitch = [=](auto p) { return 2 * M_PI * (frequency + wobble * std::sin(p[0] / 7 + p[1] / 11)) * p[0]; };
    return {ringing().shape().parameters,
            {[=](auto p, double t) { return 100 * std::exp(-damping * p[1] * t) * std::sin(pitch(p) * t); },
             [=](auto p, double t) { return 80 * std::exp(-damping * p[1] * t) * (1 - std::cos(pitch(p) * t)); }},
            200, step};
  }
  /// The fit of pulses of the fine mesh with so many added runs and pairs.
  [[nodiscard]] MapSummary fit(const Problem& problem, const Recordings& recordings, int added, int pairs) const {
    MapModels models{.true_model = working, .surrogate = &surrogate, .mesh_relative = 0.1};
    models.surrogate_variance = [](std::span<const double>) { return Eigen::VectorXd::Constant(400, 4.0); };
    models.add_runs = [&](const Eigen::MatrixXd& t, const std::vector<bool>& f) { return run(t, f); };
    models.has_finer = pairs > 0;
    return run_map(problem, recordings, {}, models, {.added_runs = added, .mesh_pairs = pairs, .likelihood = {.values = 150}}, 1, 1);
  }
  /// Runs of the working mesh and, where asked and there, of the finer one.
  [[nodiscard]] std::vector<AddedRun> run(const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine) const {
    std::vector<AddedRun> runs;
    for (Eigen::Index i = 0; i < thetas.cols(); ++i) {
      const std::vector<double> theta{thetas(0, i), thetas(1, i)};
      AddedRun r{.theta = theta, .working = evaluate_run(working, theta, false)};
      if (with_fine[std::size_t(i)]) r.fine = evaluate_run(fine, theta, false);
      runs.push_back(std::move(r));
    }
    return runs;
  }
};

TEST(Map, AddedRunsAndPairsBringItToTheFinerMeshAndStopWhenItStays) {
  const Levels levels;
  const std::vector<double> truth{19e3, 1.6e4};
  const auto recordings = pulses_of(levels.fine, truth, {.pulses = 8, .noise = 1, .noise_time = 6e-6}, 3);
  const Problem problem = make_problem(levels.fine.shape(), recordings, {});
  const auto with = [&](int added, int pairs) { return levels.fit(problem, recordings, added, pairs); };
  const auto both = with(30, 20), alone = with(30, 0), none = with(0, 0);
  const auto off = [&](const MapSummary& s) { return std::abs(s.theta[0] / truth[0] - 1); };
  EXPECT_LT(off(both), 2 * std::sqrt(both.covariance(0, 0)) / truth[0]);
  EXPECT_LT(off(both), 0.012);
  EXPECT_NEAR(off(alone), 0.02, 0.004);  // the working mesh's own answer: its frequency is 2 % high
  EXPECT_TRUE(none.refinement.rounds.empty());
  EXPECT_TRUE(both.refinement.stable);
  EXPECT_LT(both.refinement.rounds.back().runs, 30);
  EXPECT_GT(both.refinement.rounds[0].moved, 1);
  ASSERT_EQ(both.refinement.next_halving.size(), 2);
  EXPECT_THAT(both.refinement.sentence, HasSubstr("next halving"));
  EXPECT_EQ(alone.refinement.next_halving.size(), 0);

  // Histories and scores are those on the finer mesh, the working mesh's beside them; without pairs there is one mesh.
  const auto exact = levels.fine.evaluate(both.theta).mean, own = levels.working.evaluate(both.theta).mean;
  EXPECT_EQ(both.mesh.calibrated, own);
  EXPECT_EQ(alone.calibrated, levels.working.evaluate(alone.theta).mean);
  double to_exact = 0, to_own = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) to_exact += std::pow(both.calibrated[i] - exact[i], 2), to_own += std::pow(both.calibrated[i] - own[i], 2);
  EXPECT_LT(to_exact, 0.05 * to_own);
  EXPECT_NEAR(both.best.score.mae, score(problem, both.calibrated).mae, 1e-12);
  EXPECT_NEAR(both.mesh.best.mae, score(problem, own).mae, 1e-12);
  EXPECT_LT(both.best.score.mae, 0.5 * both.mesh.best.mae);
  EXPECT_NE(both.at_nominal.score.mae, both.mesh.at_nominal.mae);
  EXPECT_NEAR(both.candidates[0].score.mae, both.best.score.mae, 1e-12);
  const Json with_pairs = map_json(both, problem, {}), without = map_json(alone, problem, {});
  EXPECT_EQ(with_pairs["scores_on"], "half the element size");
  EXPECT_NEAR(with_pairs["mesh"]["working_mesh"]["mae"].get<double>(), both.mesh.best.mae, 1e-12);
  EXPECT_TRUE(with_pairs["mesh"]["next_halving_sds"].contains("damping"));
  EXPECT_EQ(without["scores_on"], "the case's own mesh");
  EXPECT_FALSE(without.contains("mesh"));
}

TEST(Map, PairsThatAreNotFoundAgainWidenTheCovariance) {
  const std::vector<double> truth{19e3, 1.6e4};
  const auto fit = [&](double wobble, int pairs) {
    const Levels levels(wobble);
    const auto recordings = pulses_of(levels.fine, truth, {.pulses = 8, .noise = 1, .noise_time = 6e-6}, 3);
    const Problem problem = make_problem(levels.fine.shape(), recordings, {});
    return levels.fit(problem, recordings, 12, pairs);
  };
  // A mesh whose error is smooth: pairs that are left out are found, and nothing is said against the deviations.
  const auto smooth = fit(0, 12);
  EXPECT_EQ(smooth.refinement.validation.inflation, 1);
  ASSERT_EQ(smooth.refinement.validation.pairs.size(), std::size_t(smooth.refinement.rounds.back().pairs / 2));
  EXPECT_THAT(smooth.warnings, Not(Contains(HasSubstr("widened by"))));
  // One whose error is another at every place: no deviation that follows from the pairs' interpolation holds.
  const auto rough = fit(0.01, 12);
  const auto& v = rough.refinement.validation;
  EXPECT_GT(v.inflation, 2);
  EXPECT_THAT(rough.warnings, Contains(HasSubstr("widened by")));
  double mean = 0;
  for (const auto& p : v.pairs) mean += p.squares / double(2 * v.pairs.size());
  EXPECT_NEAR(v.inflation, mean, 1e-9 * mean);
  EXPECT_GT(std::abs(v.pairs[0].found[0] / v.pairs[0].theta[0] - 1), 1e-4);
  // Too few pairs judge nothing.
  const auto few = fit(0.01, 4);
  EXPECT_TRUE(few.refinement.validation.pairs.empty());
  EXPECT_EQ(few.refinement.validation.inflation, 1);
  EXPECT_TRUE(few.refinement.validation.sentence.empty());
}

}  // namespace
}  // namespace calomel
