// The diagnosis on models that are formulas: nothing missing, one effect concealed, one faulty gauge, an effect that nobody offers. And its parts alone.
#include "uq/diagnosis/diagnosis_artefacts.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "tests/scratch.hpp"
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

  /// Writes its artefacts to `folder`, where there is one.
  [[nodiscard]] Diagnosis diagnosed(const std::filesystem::path& folder = {}) const {
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
    Diagnosis d = diagnose(in);
    if (folder.empty()) return d;
    const Provenance provenance{.stage = "diagnosis", .options = Json::object(), .seed = 1, .inputs = {}};
    write_diagnosis_histories(d, problem, provenance, folder / "diagnosis.nc");
    write_json(folder / "diagnosis.json", diagnosis_json(d, in, provenance));
    return d;
  }
};

TEST(Diagnosis, NothingMissingIsNone) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Diagnosis d = Experiment(0, 0, 0, 1, seed).diagnosed();
    EXPECT_EQ(d.verdict.kind, VerdictKind::none) << d.verdict.reason;
    EXPECT_DOUBLE_EQ(d.held_out_after, d.held_out_before);
    EXPECT_EQ(shown_explanation(d), nullptr);
  }
}

TEST(Diagnosis, AConcealedEffectIsNamedAndGivesTheBaseParametersBack) {
  const auto folder = scratch("diagnosis_artefacts");
  const Experiment experiment(0.3, 0, 0, 1, 1);
  const Diagnosis d = experiment.diagnosed(folder);
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
  // The first place on the map where the mismatch is more than chance is the one that is told.
  double first = 1;
  for (Eigen::Index i = 0; i < d.location.map_q_values.rows(); ++i)
    for (Eigen::Index k = 0; k < d.location.map_q_values.cols(); ++k)
      if (d.location.map_q_values(i, k) < 0.05) first = std::min(first, w[std::size_t(k)].begin);
  EXPECT_DOUBLE_EQ(first, d.location.first_time);

  // Its artefacts: the sentences, the misfit of every gauge, the handbook, the histories.
  const Json json = read_json(folder / "diagnosis.json");
  EXPECT_THAT(json["finding"].get<std::string>(), ::testing::HasSubstr("leaves something out: echo; with it the misfit of the records falls from"));
  EXPECT_EQ(json["summary"], json["finding"].get<std::string>() + ' ' + json["next_step"].get<std::string>());
  double held_out = 0, before = 0;
  ASSERT_EQ(json["gauges"].size(), sensors);
  for (const auto& g : json["gauges"]) {
    EXPECT_LT(g["after"].get<double>(), g["before"].get<double>()) << g["name"];
    held_out += g["heldout_before"].get<double>() / double(sensors), before += g["before"].get<double>() / double(sensors);
  }
  EXPECT_NEAR(held_out, d.held_out_before, 1e-6);  // the mean over the gauges is the rule's own number
  EXPECT_NEAR(before, json["fit"]["before"]["compared_nrmse"].get<double>(), 1e-12);
  EXPECT_EQ(json["base_parameters"]["handbook"]["speed"], (Json{{"mean", 1.0}, {"sd", 0.03}}));
  EXPECT_EQ(json["location"]["map_q_values"].size(), sensors);
  for (const auto& r : json["ranking"]) EXPECT_FALSE(r["why"].get<std::string>().empty()) << r["name"];
  EXPECT_GT(json["ranking"][0]["explained"].get<double>(), 0.5);

  const NetcdfReader file(folder / "diagnosis.nc");
  EXPECT_EQ(file.attribute("explanation"), "echo");
  const auto base = file.doubles("base"), explained = file.doubles("explained"), out = file.doubles("held_out_explained"), out_base = file.doubles("held_out_base"), mean = file.doubles("record_mean");
  ASSERT_EQ(mean.size(), sensors * times);
  const auto distance = [&](const std::vector<double>& x) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - mean[i]) * (x[i] - mean[i]);
    return std::sqrt(sum);
  };
  EXPECT_LT(distance(explained), 0.5 * distance(base));
  EXPECT_LT(distance(out), 0.5 * distance(out_base));
  EXPECT_NE(out_base, base);
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
  EXPECT_EQ(d.base_history.size(), d.held_out_history.size());
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
