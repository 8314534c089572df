// The diagnosis on models that are formulas: nothing missing, one effect concealed, one faulty gauge, an effect that nobody offers. And its parts alone.
#include "uq/diagnosis/diagnosis.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/linear_algebra.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::size_t times = 100;
constexpr std::size_t sensors = 6;

/// What a gauge at place x shows: a damped oscillation whose speed is a parameter, an echo that may be missing, a drift that may be, and something else.
double strain(std::size_t sensor, double t, double amplitude, double speed, double echo, double drift, double foreign) {
  const double x = double(sensor), us = 1e6 * t, arrival = 5 + 4 * x / speed;
  const double s = us > arrival ? (us - arrival) / 10 : 0, late = us > 50 + 2 * x ? us - 50 - 2 * x : 0;
  return 1e-4 * (amplitude * std::sin(speed * s) * std::exp(-s / 8) + echo * std::sin(0.4 * late) + drift * (1 + 0.3 * x) * us / 100 + foreign * std::cos(0.9 * us) * (sensor % 2 ? 1 : -1) * std::exp(-us / 60));
}

Parameter handbook(const std::string& name, double mean, double sd) {
  Parameter p = normal_parameter(name, mean, sd);
  p.min = mean * 0.7, p.max = mean * 1.4;
  return p;
}

AddedParameter added(const std::string& group, const std::string& key, double low, double high, std::vector<double> strengths) {
  AddedParameter a;
  a.parameter.name = group + '.' + key, a.parameter.key = "mechanism." + a.parameter.name, a.parameter.min = low, a.parameter.max = high, a.parameter.nominal = 0;
  a.strengths = std::move(strengths);
  return a;
}

/// A case with a truth: amplitude, speed, echo, drift, foreign, and a gain of gauge 2.
struct Experiment {
  std::vector<Parameter> parameters{handbook("amplitude", 1, 0.03), handbook("speed", 1, 0.03)};
  AnalyticModel model;
  Recordings recordings;
  Problem problem;

  explicit Experiment(double echo, double drift, double foreign, double gain, std::uint64_t seed)
      : model(parameters, functions(echo, drift, foreign, gain), times, 1e-6, "strain"), recordings(pulses_of(model, {1.02, 0.985}, {.pulses = 12, .noise = 2e-6, .noise_time = 3e-6}, seed)),
        problem(make_problem(model.shape(), recordings, {})) {}
  static std::vector<AnalyticModel::Function> functions(double echo, double drift, double foreign, double gain) {
    std::vector<AnalyticModel::Function> all;
    for (std::size_t s = 0; s < sensors; ++s)
      all.emplace_back([=](auto p, double t) { return (s == 2 ? gain : 1) * strain(s, t, p[0], p[1], echo, drift, foreign); });
    return all;
  }

  /// The model with what is added, and a numerical noise that the same numbers always repeat.
  static RunRecord run(const Eigen::VectorXd& theta, int level, std::span<const AddedParameter> added) {
    double echo = 0, drift = 0, gain = 1;
    for (std::size_t k = 0; k < added.size(); ++k) {
      const double v = theta[Eigen::Index(2 + k)];
      const std::string& name = added[k].parameter.name;
      (name == "echo.strength" ? echo : name == "drift.rate" ? drift : gain) = name == "sensor_response.gain" ? 1 + v : v;
    }
    RunRecord r{.done = true};
    std::uint64_t hash = 7 + std::uint64_t(level);
    for (const double v : theta) hash = hash * 1099511628211ull + std::uint64_t(std::llround(1e9 * std::abs(v)));
    RandomStream random(hash, 0);
    for (std::size_t s = 0; s < sensors; ++s) {
      const auto noise = ou_noise(times, 1e-6, 5e-6, random);
      for (std::size_t t = 0; t < times; ++t)
        r.mean.push_back(float(gain * strain(s, 1e-6 * double(t), theta[0], theta[1], echo, drift, 0) * (1 + 0.01 * level) + 1e-7 * noise[t]));
    }
    return r;
  }

  [[nodiscard]] Diagnosis diagnosed() const {
    const RecordingOptions recording_options;
    PosteriorInputs base{.problem = problem, .recordings = recordings, .recording_options = recording_options, .errors = {.values = 240, .band = 2e5, .young_sd = 0}, .emulator = {}};
    base.emulator.coarse_runs = 24, base.emulator.fine_runs = 10;
    base.parameters = parameters, base.levels = 2, base.discrepancy = true;
    base.centre = {1, 1}, base.half_width = {0.1, 0.1};
    ParameterGroup gauge{.name = "sensor_response", .added = {added("sensor_response", "gain", -0.15, 0.15, {0.05})}, .by_sensor = true};
    const DiagnosisInputs in{.base = base,
                             .groups = {{.name = "drift", .added = {added("drift", "rate", -1, 1, {0.25, -0.25})}}, {.name = "echo", .added = {added("echo", "strength", -1, 1, {0.25, -0.25})}}, gauge},
                             .run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> a) {
                               std::vector<RunRecord> all;
                               for (std::size_t i = 0; i < level.size(); ++i) all.push_back(run(thetas.col(Eigen::Index(i)), level[i], a));
                               return all;
                             },
                             .linear = {},
                             .options = {.leaders = 2, .candidate_coarse = 16, .candidate_fine = 6},
                             .say = {}};
    return diagnose(in);
  }
};

TEST(Diagnosis, NothingMissingIsNone) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Diagnosis d = Experiment(0, 0, 0, 1, seed).diagnosed();
    EXPECT_EQ(d.verdict.kind, VerdictKind::none) << d.verdict.reason;
    EXPECT_DOUBLE_EQ(d.held_out_after, d.held_out_before);
  }
}

TEST(Diagnosis, AConcealedEffectIsNamedAndGivesTheBaseParametersBack) {
  const Diagnosis d = Experiment(0.3, 0, 0, 1, 1).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("echo"));
  const Alternative& c = d.candidates[0];
  ASSERT_EQ(c.numbers.size(), 1u);
  EXPECT_NEAR(c.numbers[0].mean, 0.3, 3 * c.numbers[0].sd + 0.003);
  EXPECT_NEAR(c.base_parameters[1].mean, 0.985, 3 * c.base_parameters[1].sd + 0.002);
  EXPECT_LT(d.held_out_after, 0.6 * d.held_out_before);
  const auto& w = d.location.windows;
  EXPECT_GT(std::max_element(w.begin(), w.end(), [](const auto& a, const auto& b) { return a.score < b.score; })->begin, 40e-6);  // the echo comes after 50 us
  EXPECT_LT(d.location.sensors[0].q_value, 0.05);
}

TEST(Diagnosis, AFaultyGaugeIsItselfNamed) {
  const Diagnosis d = Experiment(0, 0, 0, 1.12, 1).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("sensor_response"));
  EXPECT_EQ(d.candidates[0].sensor, "S2");
  EXPECT_NEAR(d.candidates[0].numbers[0].mean, 0.12, 0.03);
}

TEST(Diagnosis, WhatNobodyOffersIsUnknown) {
  const Diagnosis d = Experiment(0, 0, 0.3, 1, 1).diagnosed();
  EXPECT_EQ(d.verdict.kind, VerdictKind::unknown) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, IsEmpty());
}

/// One record of a pulse that runs far: a model that is exact and costs nothing, whose parameters shift what it shows by many of its standard deviations. Late oscillations, where
/// the dispersion is not 0; a lag is the rival.
struct Traveller {
  std::vector<Parameter> parameters{handbook("speed", 1, 0.02), handbook("gain", 1, 0.02)};
  static double signal(double t, double speed, double gain, double dispersion, double lag) {
    const double s = 1e6 * t - 60 / speed, w = 8 + lag;
    const double front = 0.5 * (1 + std::tanh(s / w)), tail = s > -20 ? std::sin(0.9 * s / (1 + 3 * dispersion)) * std::exp(-std::pow((s - 12) / 14, 2)) : 0;
    return gain * (front + dispersion * tail);
  }
  AnalyticModel model;
  Recordings recordings;
  RecordingOptions options;
  Problem problem;
  explicit Traveller(double dispersion)
      : model(parameters, {[=](auto p, double t) { return signal(t, p[0], p[1], dispersion, 0); }}, 120, 1e-6, "V"),
        recordings(pulses_of(model, {1.013, 0.99}, {.pulses = 1, .noise = 1e-3}, 3)), options(noise()), problem(make_problem(model.shape(), recordings, options)) {}
  static RecordingOptions noise() {
    RecordingOptions o;
    o.unit = "V", o.noise = 1e-3;
    return o;
  }
  [[nodiscard]] Diagnosis diagnosed() const {
    PosteriorInputs base{.problem = problem, .recordings = recordings, .recording_options = options, .errors = {.values = 120, .band = 5e5}, .emulator = {}};
    base.parameters = parameters, base.levels = 1, base.discrepancy = true, base.draw_in = true;
    base.centre = {1, 1}, base.half_width = {0.04, 0.04};
    AddedParameter dispersion = added("dispersion", "strength", 0, 0.4, {0.1}), lag = added("lag", "time", 0, 8, {2});
    const DiagnosisInputs in{.base = base,
                             .groups = {{.name = "dispersion", .added = {dispersion}}, {.name = "lag", .added = {lag}}},
                             .run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> a) {
                               std::vector<RunRecord> all(level.size());
                               for (std::size_t i = 0; i < level.size(); ++i) {
                                 const auto theta = thetas.col(Eigen::Index(i));
                                 double by_dispersion = 0, by_lag = 0;
                                 for (std::size_t k = 0; k < a.size(); ++k) (a[k].parameter.name == "lag.time" ? by_lag : by_dispersion) = theta[Eigen::Index(2 + k)];
                                 all[i].done = true;
                                 for (int t = 0; t < 120; ++t) all[i].mean.push_back(float(signal(1e-6 * t, theta[0], theta[1], by_dispersion, by_lag)));
                               }
                               return all;
                             },
                             .linear = {},
                             .options = {},
                             .say = {}};
    return diagnose(in);
  }
};

TEST(Diagnosis, OfAnExactModelHasABoxOfItsOwnForEveryExplanationAndHoldsItAgainstTheModel) {
  const Diagnosis d = Traveller(0.15).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("dispersion"));
  const Alternative& c = d.candidates[0];
  EXPECT_NEAR(c.numbers[0].mean, 0.15, 3 * c.numbers[0].sd);
  EXPECT_LT(c.numbers[0].sd, 0.01);
  EXPECT_NEAR(c.base_parameters[0].mean, 1.013, 3 * c.base_parameters[0].sd);
  EXPECT_LT(std::abs(c.true_model_shift), 1);
  EXPECT_TRUE(d.base.rounds.front().drew_in || d.base.rounds[1].drew_in);
  EXPECT_LT(d.held_out_after, 0.3 * d.held_out_before);  // by parts of the only record
  EXPECT_THAT(d.separating, ::testing::HasSubstr(" V ("));
}

TEST(Diagnosis, OfAnExactModelFindsNothingWhereNothingIsMissing) {
  const Diagnosis d = Traveller(0).diagnosed();
  EXPECT_EQ(d.verdict.kind, VerdictKind::none) << d.verdict.reason;
  EXPECT_LT(std::abs(d.base_true_model_shift), 1);
}

TEST(Folds, OfASingleRecordAreQuartersOfItsTimeElseGauges) {
  const Traveller one(0);
  const auto quarters = folds_by_face(one.problem, Decimation(one.problem, 120), {});
  ASSERT_EQ(quarters.size(), 4u);
  EXPECT_EQ(quarters[1].rows.front(), 30);
  EXPECT_EQ(quarters[3].rows.back(), 119);
  EXPECT_DOUBLE_EQ(quarters[0].records, 0.25);
  const Experiment six(0, 0, 0, 1, 1);
  const Decimation grid(six.problem, 240);
  const auto gauges = folds_by_face(six.problem, grid, {});
  ASSERT_EQ(gauges.size(), 6u);
  EXPECT_EQ(gauges[2].rows.front(), Eigen::Index(grid.offset(2)));
  EXPECT_EQ(gauges[2].rows.size(), grid.windows(2).size());
}

TEST(FalseDiscovery, IsThatOfBenjaminiAndYekutieli) {
  // p.adjust(c(0.001, 0.01, 0.02, 0.5), "BY") of R: 4 (1 + 1/2 + 1/3 + 1/4) p / rank, from above.
  const double c = 4 * (1 + 1.0 / 2 + 1.0 / 3 + 1.0 / 4);
  const auto q = false_discovery({0.02, 0.001, 0.5, 0.01});
  EXPECT_NEAR(q[1], 0.001 * c, 1e-12);
  EXPECT_NEAR(q[3], 0.01 * c / 2, 1e-12);
  EXPECT_NEAR(q[0], 0.02 * c / 3, 1e-12);
  EXPECT_NEAR(q[2], 1, 1e-12);
}

}  // namespace
}  // namespace calomel
