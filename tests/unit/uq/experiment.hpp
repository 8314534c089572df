#pragma once
/// An experiment whose model is a formula, with physics that may be missing, for the diagnosis and for the power of an experiment.
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"
#include "tests/unit/inverse/lines.hpp"
#include "tests/unit/uq/diagnosis/described.hpp"
#include "uq/diagnosis/diagnosis_artefacts.hpp"

namespace calomel {

inline constexpr std::size_t times = 100;
inline constexpr std::size_t sensors = 6;

/// Reading of a gauge at place x: a damped oscillation whose speed is a parameter, and an echo, a drift and something foreign that may be missing in the model.
inline double strain(std::size_t sensor, double t, double amplitude, double speed, double echo, double drift, double foreign) {
  const double x = double(sensor), us = 1e6 * t, arrival = 5 + 4 * x / speed;
  const double s = us > arrival ? (us - arrival) / 10 : 0, late = us > 50 + 2 * x ? us - 50 - 2 * x : 0;
  return 1e-4 * (amplitude * std::sin(speed * s) * std::exp(-s / 8) + echo * std::sin(0.4 * late) + drift * (1 + 0.3 * x) * us / 100 +
                 foreign * std::cos(0.9 * us) * (sensor % 2 ? 1 : -1) * std::exp(-us / 60));
}

inline Parameter handbook(const std::string& name, double mean, double sd) {
  Parameter p = normal_parameter(name, mean, sd);
  p.min = mean * 0.7;
  p.max = mean * 1.4;
  return p;
}

inline AddedParameter added(const std::string& group, const std::string& key, double low, double high, std::vector<double> strengths) {
  AddedParameter a;
  a.parameter.name = group + '.' + key;
  a.parameter.key = "mechanism." + a.parameter.name;
  a.parameter.min = low;
  a.parameter.max = high;
  a.parameter.nominal = 0;
  a.strengths = std::move(strengths);
  return a;
}

/// Words that name the place in diagnosis.json at which they belong; the presentation makes the sentences.
inline DiagnosisText placeholder_text(const Diagnosis& d) {
  DiagnosisText text{.reason = "reason", .finding = "finding", .next_step = "next step", .separating_measurement = "separating measurement"};
  for (const auto& r : d.verdict.ranking) {
    ExplanationText words{.why = "why of " + r.name, .would_change = "change of " + r.name};
    if (const Alternative* a = d.alternative(r.name)) {
      words.plain_name = "plain " + r.name;
      words.numbers.resize(a->numbers.size());
    }
    text.ranking.push_back(std::move(words));
  }
  for (const auto& m : d.base.mislabelled) text.mislabelled.push_back("mislabelled " + m.gauge);
  if (d.missing) {
    text.missing = "missing";
    for (const auto& t : d.missing->terms) text.missing_terms.push_back("change of " + t.what);
  }
  return text;
}

/// A case with a truth: amplitude, speed, echo, drift, foreign, and a gain of gauge 2.
struct Experiment {
  std::vector<Parameter> parameters{handbook("amplitude", 1, 0.03), handbook("speed", 1, 0.03)};
  AnalyticModel model;
  Recordings recordings;
  RecordingOptions recording_options;
  Problem problem;

  explicit Experiment(double echo, double drift, double foreign, double gain, std::uint64_t seed, const std::vector<std::string>& conditions = {"default"})
      : model(parameters, functions(echo, drift, foreign, gain), times, 1e-6, "strain", conditions),
        recordings(pulses_of(model, {1.02, 0.985}, {.pulses = 12, .noise = 2e-6, .noise_time = 3e-6}, seed)),
        problem(make_problem(model.shape(), recordings, {})) {}
  static std::vector<AnalyticModel::Function> functions(double echo, double drift, double foreign, double gain) {
    std::vector<AnalyticModel::Function> all;
    for (std::size_t s = 0; s < sensors; ++s)
      all.emplace_back([=](auto p, double t) { return (s == 2 ? gain : 1) * strain(s, t, p[0], p[1], echo, drift, foreign); });
    return all;
  }

  /// The model with what is added, numbers of one name together, and a numerical noise that the same numbers always repeat.
  static RunRecord run(const Eigen::VectorXd& theta, int level, std::span<const AddedParameter> added, double noise) {
    double echo = 0, drift = 0, foreign = 0;
    std::array<double, sensors> gain;
    gain.fill(1);
    for (std::size_t k = 0; k < added.size(); ++k) {
      const std::string &name = added[k].parameter.name, &key = added[k].parameter.key;
      const double value = theta[Eigen::Index(2 + k)];
      if (name == "echo.strength") echo += value;
      if (name == "drift.rate") drift += value;
      if (name == "correction.foreign") foreign += value;
      if (name == "correction.late") echo += value;
      for (std::size_t s = 0; s < sensors; ++s)
        if (name == "sensor_response.gain" && (key == "mechanism." + name || key == "mechanism.sensor_response.S" + std::to_string(s) + ".gain"))
          gain[s] += value;
    }
    RunRecord r{.done = true};
    std::uint64_t hash = 7 + std::uint64_t(level);
    for (const double v : theta) hash = hash * 1099511628211ull + std::uint64_t(std::llround(1e9 * std::abs(v)));
    RandomStream random(hash, 0);
    for (std::size_t s = 0; s < sensors; ++s) {
      const auto error = ou_noise(times, 1e-6, 5e-6, random);
      for (std::size_t t = 0; t < times; ++t)
        r.mean.push_back(float(gain[s] * strain(s, 1e-6 * double(t), theta[0], theta[1], echo, drift, foreign) * (1 + 0.01 * level) + noise * error[t]));
    }
    return r;
  }

  /// The columns of thetas, with a numerical noise of this sd.
  static RunAdded runs(double noise = 1e-7) {
    return [noise](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> a) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) all.push_back(run(thetas.col(Eigen::Index(i)), level[i], a, noise));
      return all;
    };
  }
  [[nodiscard]] PosteriorInputs base() const {
    PosteriorInputs base{.problem = problem,
                         .recordings = recordings,
                         .recording_options = recording_options,
                         .errors = {.values = 240, .band = 2e5, .young_sd = 0},
                         .emulator = {}};
    base.emulator.coarse_runs = 24;
    base.emulator.fine_runs = 10;
    base.parameters = parameters;
    base.levels = 2;
    base.discrepancy = true;
    base.centre = {1, 1};
    base.half_width = {0.1, 0.1};
    return base;
  }
  static std::vector<ParameterGroup> groups() {
    return {{.name = "drift", .added = {added("drift", "rate", -1, 1, {0.25, -0.25})}},
            {.name = "echo", .added = {added("echo", "strength", -1, 1, {0.25, -0.25})}},
            {.name = "sensor_response", .added = {added("sensor_response", "gain", -0.15, 0.15, {0.05})}, .by_sensor = true}};
  }
  /// Terms for effects that no group has.
  static std::vector<ParameterGroup> terms() {
    return {{.name = "lateness", .place = "at the end", .added = {added("correction", "late", -1, 1, {0.1})}},
            {.name = "foreignness", .place = "everywhere", .added = {added("correction", "foreign", -1, 1, {0.1})}}};
  }
  /// Writes its artefacts to `folder`, where there is one.
  [[nodiscard]] Diagnosis diagnosed(const std::filesystem::path& folder = {}, std::vector<ParameterGroup> offered = groups(),
                                    DiagnosisOptions options = {.leaders = 2}) const {
    const PosteriorInputs fitted = base();
    const DiagnosisInputs in{.base = fitted, .groups = std::move(offered), .terms = terms(), .run = runs(), .options = options, .report = {}, .round = {}};
    Diagnosis d = diagnose(in);
    if (folder.empty()) return d;
    const Provenance provenance{.stage = "diagnosis", .options = Json::object(), .seed = 1, .inputs = {}};
    write_diagnosis_histories(d, problem, provenance, folder / "diagnosis.nc");
    write_json(folder / "diagnosis.json", diagnosis_json(d, in, placeholder_text(d), provenance));
    return d;
  }
};

}  // namespace calomel
