// Tests the mode, its covariance and evidence against closed forms, coverage over many data sets with controls that must fail, and the summary of an answer.
#include "inverse/map/map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "base/provenance.hpp"
#include "tests/unit/inverse/map/fitted.hpp"

namespace calomel {
namespace {

constexpr double step = 1e-6;
constexpr std::size_t times = 120;

/// y = a + b t on the unit interval, normal priors.
AnalyticModel line() {
  return {
      {normal_parameter("a", 0, 2), normal_parameter("b", 1, 3)}, {[](auto theta, double t) { return theta[0] + theta[1] * t / (step * times); }}, times, step};
}

RecordingOptions noise_of(double sd) {
  RecordingOptions o;
  o.noise = sd;
  return o;
}

TEST(Map, OfALinearModelIsTheClosedForm) {
  const auto model = line();
  Fitted f(model, pulses_of(model, {0.7, -1.2}, {.pulses = 1, .noise = 0.5}, 4), noise_of(0.5));
  const auto summary = f.map({0, 0}, {2, 4});
  // Posterior precision, mean and evidence of the linear Gaussian model.
  Eigen::MatrixXd design(times, 2);
  Eigen::VectorXd y(times);
  for (std::size_t t = 0; t < times; ++t) {
    design.row(Eigen::Index(t)) << 1, double(t) / times;
    y[Eigen::Index(t)] = f.recordings.values[t];
  }
  const Eigen::Vector2d mean(0, 1);
  const Eigen::Matrix2d prior = Eigen::Vector2d(4, 9).asDiagonal();
  const Eigen::MatrixXd total = 0.25 * Eigen::MatrixXd::Identity(times, times) + design * prior * design.transpose();
  const Eigen::Matrix2d covariance = (design.transpose() * design / 0.25 + Eigen::Matrix2d(prior.inverse())).inverse();
  const Eigen::Vector2d mode = covariance * (design.transpose() * y / 0.25 + prior.inverse() * mean);
  const Cholesky factor(total);
  const Eigen::VectorXd r = y - design * mean;
  const double evidence = -0.5 * r.dot(factor.solve(r)) - factor.half_log_determinant() - 0.5 * double(times) * std::log(2 * M_PI);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(summary.theta[std::size_t(k)], mode[k], 1e-3 * std::sqrt(covariance(k, k)));
  EXPECT_LT((summary.covariance - covariance).cwiseAbs().maxCoeff(), 1e-3 * covariance.maxCoeff());
  EXPECT_NEAR(summary.log_evidence_laplace, evidence, 1e-2);
  EXPECT_NEAR(summary.fit.effective_data, double(times), 1e-3);
  EXPECT_TRUE(summary.adequate) << summary.fit.p_value;
  // A run of the model at the mode equals the emulator's prediction.
  EXPECT_EQ(summary.status, CalibrationStatus::done);
  EXPECT_NEAR(summary.best.objective_model.value(), summary.log_likelihood + summary.log_prior, 1e-3);
  EXPECT_TRUE(summary.check.holds || summary.check.runs[0].distance < 1e-5) << summary.check.p_value;
}

TEST(Map, AnInadequateFitIsReportedAndNotInflated) {
  const auto model = line();
  auto recordings = pulses_of(model, {0.7, -1.2}, {.pulses = 1, .noise = 0.05}, 4);
  Fitted plain(model, recordings, noise_of(0.05));
  const auto before = plain.map({0, 0}, {2, 4});
  for (std::size_t t = 0; t < times; ++t) recordings.values[t] += 0.3 * std::sin(0.2 * double(t));
  Fitted f(model, recordings, noise_of(0.05));
  const auto summary = f.map({0, 0}, {2, 4});
  EXPECT_TRUE(before.adequate);
  EXPECT_FALSE(summary.adequate);
  EXPECT_FALSE(summary.fit.adequate);
  EXPECT_NEAR(summary.covariance(0, 0) / before.covariance(0, 0), 1, 0.01);
}

TEST(Map, APhysicalProductCompensatesForAnOmittedEffect) {
  const auto model = line();
  auto recordings = pulses_of(model, {3, -1.2}, {.pulses = 1, .noise = 0.02}, 4);
  const auto map = [&](bool discrepancy) {
    auto f = std::make_unique<Fitted>(model, recordings, noise_of(0.02));
    f->in.discrepancy = discrepancy;
    auto s = f->map({3, 0}, {2, 4});
    const auto weights = f->fit.posterior->density(f->fit.modes[0].at).weights;
    return std::tuple{std::move(s), weights, f->fit.hypotheses};
  };
  // Nothing is missing from the model: scales close to zero have the weight, and the answer is nearly as certain as without a discrepancy.
  const auto [plain, one, of_plain] = map(false);
  EXPECT_EQ(one.size(), 1u);
  const auto [complete, weights, hypotheses] = map(true);
  ASSERT_GT(weights.size(), 5u);
  double small = 0, total = 0;
  for (std::size_t j = 0; j < weights.size(); ++j) total += weights[j], small += hypotheses[j].discrepancy <= 0.01 ? weights[j] : 0;
  EXPECT_NEAR(total, 1, 1e-9);
  EXPECT_GT(small, 0.8);
  // The line cannot follow a bump: the fitted scale has the size of the bump, and the fit is adequate but less certain.
  for (std::size_t t = 0; t < times; ++t) recordings.values[t] += 0.3 * std::exp(-0.5 * std::pow((double(t) - 70) / 12, 2));
  const auto [bumped, bumped_weights, bumped_hypotheses] = map(true);
  double scale = 0;
  for (std::size_t j = 0; j < bumped_weights.size(); ++j) scale += bumped_weights[j] * bumped_hypotheses[j].discrepancy;
  EXPECT_GT(scale, 0.02);
  EXPECT_TRUE(bumped.fit.adequate) << bumped.fit.p_value;
  EXPECT_GT(bumped.covariance(0, 0), 4 * complete.covariance(0, 0));
  EXPECT_LT(std::abs(bumped.theta[0] - 3), 3 * std::sqrt(bumped.covariance(0, 0)));
}

/// Two oscillations whose frequency and damping are fitted; the model is nonlinear in both.
AnalyticModel ringing() {
  return {{uniform_parameter("frequency", 10e3, 30e3, 20e3), uniform_parameter("damping", 1e3, 5e4, 1e4)},
          {[](auto p, double t) { return 100 * std::exp(-p[1] * t) * std::sin(2 * M_PI * p[0] * t); },
           [](auto p, double t) { return 80 * std::exp(-p[1] * t) * (1 - std::cos(2 * M_PI * p[0] * t)); }},
          200,
          step};
}

struct Coverage {
  int one = 0, two = 0, parameters = 0;
  [[nodiscard]] double share(int n) const { return double(n) / parameters; }
};

Coverage coverage(const RecordingOptions& recording, int values, bool repeats_known) {
  const auto model = ringing();
  Coverage c;
  for (int set = 0; set < 100; ++set) {
    RandomStream random(17, std::uint64_t(set));
    const std::vector<double> truth{random.uniform(15e3, 25e3), random.uniform(6e3, 3e4)};
    auto recordings = pulses_of(model, truth, {.pulses = 12, .noise = 12, .noise_time = 12e-6}, 1000 + std::uint64_t(set));
    if (!repeats_known) {  // the mean record as if it were one pulse of independent noise
      const std::size_t n = recordings.time.size();
      std::vector<double> mean(2 * n, 0.0);
      for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t p = 0; p < 12; ++p)
          for (std::size_t t = 0; t < n; ++t) mean[s * n + t] += recordings.values[recordings.at(0, s, p, t)] / 12;
      recordings.pulses = {0}, recordings.values = mean;
    }
    Fitted f(model, recordings, recording);
    f.in.errors.values = values, f.in.emulator.check_coarse = 0, f.in.emulator.check_fine = 0;
    const auto summary = f.map({truth[0] * random.uniform(0.97, 1.03), truth[1] * random.uniform(0.9, 1.1)}, {0.06, 0.3});
    for (int k = 0; k < 2; ++k) {
      const double z = std::abs(summary.theta[std::size_t(k)] - truth[std::size_t(k)]) / std::sqrt(summary.covariance(k, k));
      c.one += z < 1, c.two += z < 2, ++c.parameters;
    }
  }
  return c;
}

TEST(Map, IntervalsCoverTheTruthAsOftenAsTheySay) {
  const auto c = coverage({}, 140, true);
  // 200 intervals of 100 data sets with nearly independent parameters: standard errors 0.033 and 0.015.
  EXPECT_NEAR(c.share(c.one), 0.683, 3 * 0.033);
  EXPECT_NEAR(c.share(c.two), 0.954, 3 * 0.015);
}

TEST(Map, IndependentErrorsUnderCorrelatedNoiseDoNotCover) {
  const auto c = coverage(noise_of(12 / std::sqrt(12.0)), 400, false);  // the right sd, the wrong correlation
  EXPECT_LT(c.share(c.one), 0.683 - 4 * 0.033);
  EXPECT_LT(c.share(c.two), 0.954 - 4 * 0.015);
}

TEST(Map, ARidgeOfConstantImpedanceIsNamed) {
  // A model that depends on density and sound speed only through their product.
  const AnalyticModel model({uniform_parameter("density", 11000, 15000, 13500), uniform_parameter("sound_speed", 1200, 1700, 1450),
                             uniform_parameter("tensile_cutoff", 5e4, 5e5, 1.5e5)},
                            {[](auto p, double t) { return 5e-6 * p[0] * p[1] * std::sin(8e4 * t) + 2e-4 * p[2] * std::sin(3e4 * t); },
                             [](auto p, double t) { return 3e-6 * p[0] * p[1] * std::cos(6e4 * t) + 1e-4 * p[2] * std::cos(1e5 * t); }},
                            200, step);
  Fitted f(model, pulses_of(model, {13200, 1400, 2e5}, {.pulses = 10, .noise = 3, .noise_time = 5e-6}, 6));
  f.in.errors.values = 200;
  f.in.errors.gain_sd = 0.01;
  f.in.errors.energy_scale_sd = 0.015;
  f.in.combinations = {{"impedance rho c", {{"material.mercury.density", 1}, {"material.mercury.sound_speed", 1}}},
                       {"stiffness rho c^2", {{"material.mercury.density", 1}, {"material.mercury.sound_speed", 2}}}};
  const auto summary = f.map({13500, 1450, 1.8e5}, {0.1, 0.1, 0.4});
  const auto& id = summary.identification;
  ASSERT_EQ(id.directions.size(), 3u);
  const auto& open = id.directions.back();
  EXPECT_NEAR(std::abs(open.exponents[0]), std::sqrt(0.5), 0.05);
  EXPECT_LT(open.exponents[0] * open.exponents[1], 0);  // rho / c is free, rho c is not
  EXPECT_NEAR(std::abs(open.exponents[2]), 0, 0.05);
  ASSERT_EQ(id.combinations.size(), 2u);
  const auto& z = id.combinations[0];
  EXPECT_EQ(z.name, "impedance rho c");
  EXPECT_NEAR(std::log(z.value / (13200.0 * 1400)), 0, 4 * z.relative_sd);
  EXPECT_LT(z.relative_sd, 0.03);  // gains and energy of 1 and 1.5 %, and the noise
  EXPECT_GT(id.combinations[1].relative_sd, 1.5 * z.relative_sd);
  EXPECT_GT(open.sd, 2 * z.relative_sd);
}

TEST(Map, AnEmulatorThatHasNotSettledIsReportedAndNotTrusted) {
  const auto model = ringing();
  Fitted f(model, pulses_of(model, {21e3, 1.4e4}, {.pulses = 8, .noise = 4, .noise_time = 6e-6}, 3));
  f.in.emulator.rounds = 0;
  const auto summary = f.map({20.5e3, 1.3e4}, {0.06, 0.3});
  EXPECT_EQ(summary.status, CalibrationStatus::not_settled);
  EXPECT_FALSE(summary.trusted());
  EXPECT_FALSE(f.fit.settled);
  EXPECT_EQ(map_json(summary, f.in, f.fit, {}, {})["status"], "not_settled");
}

TEST(Map, AModeAtWhichTheTrueModelFailsIsTheAnswerAndIsNotTrusted) {
  const auto model = ringing();
  Fitted f(model, pulses_of(model, {21e3, 1.4e4}, {.pulses = 8, .noise = 4, .noise_time = 6e-6}, 3));
  const auto verified = f.map({20.5e3, 1.3e4}, {0.06, 0.3});
  f.in.run = [](const Eigen::MatrixXd&, const std::vector<int>& level) { return std::vector<RunRecord>(level.size(), {.message = "the step collapsed"}); };
  const auto failed = run_map(f.in, f.fit, "tuned", {}, nullptr);
  EXPECT_EQ(failed.status, CalibrationStatus::no_candidate);
  EXPECT_EQ(failed.theta, verified.theta);
  EXPECT_TRUE(failed.calibrated.empty());
  EXPECT_EQ(failed.best.message, "the step collapsed");
}

TEST(Map, ItsArtefactHasAllKeysOfTheContract) {
  const auto model = ringing();
  Fitted f(model, pulses_of(model, {21e3, 1.4e4}, {.pulses = 8, .noise = 4, .noise_time = 6e-6}, 3));
  const auto summary = f.map({20.5e3, 1.3e4}, {0.06, 0.3});
  const Json j = map_json(summary, f.in, f.fit,
                          {.calibration = {.meaning = "tuned values", .mesh = ""},
                           .adequacy = "adequate",
                           .check = "checked",
                           .nested = "",
                           .identified = "the product is pinned",
                           .score_tests = "",
                           .emulator = "settled"},
                          {});
  for (const char* key : {"theta", "nominal", "objective", "product", "candidates", "sensors", "accuracy", "mae", "nominal_accuracy", "nominal_mae",
                          "parameters", "covariance", "log_likelihood", "log_prior", "log_evidence_laplace", "chi2", "effective_data"})
    EXPECT_TRUE(j.contains(key)) << key;
  EXPECT_EQ(j["meaning"], "tuned values");
  EXPECT_EQ(j["adequacy"], "adequate");
  EXPECT_EQ(j["identified"], "the product is pinned");
  EXPECT_EQ(j["emulator"]["message"], "settled");
  EXPECT_EQ(j["true_model_check"]["sentence"], "checked");
  EXPECT_EQ(j["covariance"].size(), 2u);
  EXPECT_EQ(j["scores_on"], "the case's own mesh");
  EXPECT_NEAR(summary.best.score.mae, score(f.problem, summary.calibrated).mae, 1e-12);
  for (const auto& c : j["candidates"]) EXPECT_TRUE(c["objective_model"].is_number());
}

TEST(Map, AGaugeThatDoesNotFitIsSeenThoughChiSquaredIsContent) {
  // The second gauge reads 6 % less than the model predicts. The error of the mesh is taken as 30 % of the amplitude.
  const std::vector<Parameter> parameters{uniform_parameter("a", 0.5, 2, 1)};
  const AnalyticModel model{
      parameters, {[](auto p, double t) { return 50 * p[0] * std::sin(2e5 * t); }, [](auto p, double t) { return 30 * p[0] * std::cos(1.1e5 * t); }}, 60, step};
  const AnalyticModel truth{
      parameters,
      {[](auto p, double t) { return 50 * p[0] * std::sin(2e5 * t); }, [](auto p, double t) { return 28.2 * p[0] * std::cos(1.1e5 * t); }},
      60,
      step};
  MechanismDirections other{.name = "other", .keys = {"k"}, .off = {0}, .directions = Eigen::MatrixXd::Zero(120, 1)};
  for (Eigen::Index t = 8; t < 60; ++t) other.directions(t, 0) = std::cos(0.2 * double(t));  // another phase
  const auto of = [&](const AnalyticModel& recorded) {
    Fitted f(model, pulses_of(recorded, {1}, {.pulses = 6, .noise = 0.3, .noise_time = 4e-6}, 2));
    f.in.errors.gain_sd = 0.001, f.in.mesh = 0.3;
    return f.map({1.05}, {0.2}, {other});
  };
  const auto off = of(truth);
  EXPECT_GT(off.fit.p_value, 0.5);
  EXPECT_GT(off.fit.chi2_critical, double(off.fit.values));
  ASSERT_TRUE(off.score_tests.has_value());
  EXPECT_EQ(off.score_tests->mechanisms.size(), 2u);
  EXPECT_FALSE(off.adequate);
  EXPECT_TRUE(off.score_tests->stands_out);
  EXPECT_EQ(off.score_tests->first()->name, gauge_gains_name);
  const auto fitting = of(model);
  EXPECT_TRUE(fitting.adequate) << fitting.score_tests->p_value;
  EXPECT_TRUE(fitting.fit.errors_too_wide);
}

}  // namespace
}  // namespace calomel
