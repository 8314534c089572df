#pragma once
/// A synthetic study on disk: a slice of a target with six gauges, damped waves as records, and summaries that belong to them.

#include <cmath>
#include <filesystem>

#include "apps/report/report.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "base/netcdf_file.hpp"
#include "base/random.hpp"
#include "tests/scratch.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/posterior_file.hpp"

namespace calomel::testing_report {

inline const std::string hostile = "<b>\"E\" & 'co'</b>";  // a sensor's name that must not become markup

/// Outer surface of a box of n cells along its longest side.
inline ReportSurface box(const Vec3& low, const Vec3& high, int n) {
  ReportSurface s;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      const int na = std::max(1, int(n * (high[a] - low[a]) / (high[0] - low[0]))), nb = std::max(1, int(n * (high[b] - low[b]) / (high[0] - low[0])));
      const auto first = std::int32_t(s.vertices.size());
      for (int i = 0; i <= na; ++i)
        for (int j = 0; j <= nb; ++j) {
          Vec3 v;
          v[axis] = side ? high[axis] : low[axis];
          v[a] = low[a] + (high[a] - low[a]) * i / na;
          v[b] = low[b] + (high[b] - low[b]) * j / nb;
          s.vertices.push_back(v);
        }
      for (int i = 0; i < na; ++i)
        for (int j = 0; j < nb; ++j) {
          const auto at = [&](int p, int q) { return first + (i + p) * (nb + 1) + j + q; };
          if (side)
            s.quads.push_back({at(0, 0), at(1, 0), at(1, 1), at(0, 1)});
          else
            s.quads.push_back({at(0, 0), at(0, 1), at(1, 1), at(1, 0)});
        }
    }
  return s;
}

inline ReportInput input() {
  ReportInput in;
  in.case_name = "Slice of a mercury target";
  in.case_file = "slice.toml";
  in.options = {{"material", {{"mercury", {{"density", 13500.0}, {"sound_speed", 1450.0}, {"tensile_cutoff", 1.5e5}}}}}, {"load", {{"policy", "fixed"}}}};
  in.parameters = {{.name = "tensile_cutoff", .min = 0, .max = 1.5e6, .nominal = 1.5e5, .unit = "Pa"},
                   {.name = "density", .min = 5000, .max = 20000, .nominal = 13500, .unit = "kg/m\u00b3"},
                   {.name = "sound_speed", .min = 700, .max = 3000, .nominal = 1450, .unit = "m/s"}};
  in.outer = box({0, -0.05, 0}, {0.211, 0.05, 0.062}, 60);
  in.wetted = box({0.006, -0.045, 0.004}, {0.206, 0.045, 0.056}, 40);
  const char* const names[] = {"B", "C", "F", "M", "R", ""};
  for (int i = 0; i < 6; ++i) {
    const double x = 0.03 + 0.03 * i;
    in.sensors.push_back({.name = i == 5 ? hostile : names[i],
                          .declared = {x, 0, i % 2 ? 0.0 : 0.062},
                          .placed = {x + 1e-4, 0, i % 2 ? 0.0 : 0.062},
                          .direction = {i == 2 ? 0.0 : 1.0, i == 2 ? 1.0 : 0.0, 0},
                          .moved = 1e-4,
                          .gauge_length = 0.002});
  }
  in.load_policy = "fixed: the initial pressure is given and does not follow the parameters.";
  in.deposited_energy = 23.4e3;
  in.warnings = {"sensor " + hostile + ": 12 samples are missing"};
  return in;
}

/// A gauge's history [-] at time t [s]: arrival, ringing, decay.
inline double wave(double t, int sensor, double speed) {
  const double arrival = (1 + 0.5 * sensor) * 3e-5 / speed, s = t - arrival;
  if (s < 0) return 0;
  return (4e-4 - 3e-5 * sensor) * std::exp(-s / 2.5e-4) * std::sin(2 * M_PI * s * (9e3 + 900 * sensor) * speed) * (1 - std::exp(-s / 1e-5));
}

inline Provenance provenance(const std::string& stage) {
  return {.stage = stage, .options = {{stage, {{"runs", 40}}}}, .seed = 7, .inputs = {{"recordings.nc", hash_text(stage)}}};
}

/// A floor of the study's gauges in two windows, with one comparison that was left out.
inline Json repeatability(const ReportInput& in) {
  Json members = Json::array(), records = Json::array(), single = Json::array(), precision = Json::array();
  for (int i = 0; i < 8; ++i) members.push_back({{"viscosity_factor", 1}, {"energy_shift", 0.5}, {"ok", true}, {"message", ""}});
  for (std::size_t s = 0; s < in.sensors.size(); ++s) {
    const Json record{{"condition", "default"}, {"name", in.sensors[s].name}};
    records.push_back(record), single.push_back(record), precision.push_back(record);
    records.back().update({{"relative", 0.03 + 0.0125 * double(s)}, {"sd", {2e-6, 5.5e-6 + 1e-6 * double(s)}}, {"signal", {8e-5, 9e-5}}});
    single.back()["relative"] = 0.0625 + 0.01 * double(s);
    precision.back()["relative"] = 0.00035;
  }
  return {{"mean", 0.06125},
          {"worst", 0.0925},
          {"members", members},
          {"window_begin_s", {0.0, 5e-5}},
          {"window_end_s", {5e-5, 1e-4}},
          {"sensors", records},
          {"comparisons",
           {{{"name", "single_runs"}, {"what", "scatter of single runs"}, {"message", ""}, {"mean", 0.0875}, {"worst", 0.1125}, {"sensors", single}},
            {{"name", "finer_mesh"}, {"what", "half the size"}, {"message", "left out: that mesh would have too many elements"}},
            {{"name", "precision"}, {"what", "single against double"}, {"message", ""}, {"mean", 0.00035}, {"worst", 0.00035}, {"sensors", precision}}}}};
}

inline void write_campaign(const std::filesystem::path& dir, const ReportInput& in) {
  constexpr std::size_t runs = 40, times = 20;
  const std::size_t sensors = in.sensors.size();
  RandomStream random(1, 0);
  std::vector<double> theta;
  std::vector<int> status;
  std::vector<std::string> message, names, parameters;
  for (const auto& p : in.parameters) parameters.push_back(p.name);
  for (const auto& s : in.sensors) names.push_back(s.name);
  for (std::size_t i = 0; i < runs; ++i) {
    for (const auto& p : in.parameters) theta.push_back(p.min + (p.max - p.min) * random.uniform());
    status.push_back(i % 17 == 3);
    message.push_back(status.back() ? "step 812: element 40 collapsed <at tensile_cutoff = 9e5>" : "");
  }
  std::vector<float> scatter(runs * sensors * times, 8e-6f);
  for (std::size_t i = 0; i < sensors * times; ++i) scatter[3 * sensors * times + i] = NAN;
  NetcdfWriter w(dir / "campaign.nc");
  w.dimension("run", runs), w.dimension("parameter", 3), w.dimension("sensor", sensors), w.dimension("time", times);
  w.variable("parameter", {"parameter"}, parameters);
  w.variable("sensor", {"sensor"}, names);
  w.variable("theta", {"run", "parameter"}, theta);
  const std::vector<std::string> meanings{"done", "failed"};
  w.flags("status", {"run"}, status, meanings);
  w.variable("message", {"run"}, message);
  w.variable("scatter", {"run", "sensor", "time"}, scatter);
  w.commit();
  write_json(dir / "campaign.json", {{"runs", 40},
                                     {"completed", 37},
                                     {"failed", 3},
                                     {"reused", 0},
                                     {"wall_s", 61.5},
                                     {"floor", repeatability(in)},
                                     {"provenance", provenance("campaign").json()}});
}

inline void write_train(const std::filesystem::path& dir) {
  Json list = Json::array();
  for (const auto& [name, mae, r2] : {std::tuple{"published network", 15.9, 0.873}, std::tuple{"mode network", 3.1, 0.991}}) {
    Json train = Json::array(), test = Json::array();
    for (int e = 0; e < 100; ++e) train.push_back(mae * (1 + 8 * std::exp(-e / 12.0))), test.push_back(mae * (1.3 + 8 * std::exp(-e / 11.0)));
    list.push_back({{"name", name},
                    {"kind", "neural_network"},
                    {"n_train", 30},
                    {"n_test", 7},
                    {"mae", 1e-6 * mae},
                    {"rmse", 1.6e-6 * mae},
                    {"r2", r2},
                    {"train_loss", train},
                    {"test_loss", test}});
  }
  write_json(dir / "train.json", {{"surrogates", list}, {"provenance", provenance("train").json()}});
}

/// enc, spe or map; `step` is the interval of the histories [s].
inline void write_calibration(const std::filesystem::path& dir, const ReportInput& in, const std::string& method, double step = 1e-6) {
  RandomStream random(2, 0);
  const bool enc = method == "enc";
  Json theta{{"tensile_cutoff", enc ? 85642.0 : 53300.0}, {"density", enc ? 10345.0 : 7720.0}, {"sound_speed", enc ? 2020.0 : 2449.0}};
  Json sensors = Json::array(), rounds = Json::array(), optimizers = Json::array(), candidates = Json::array();
  for (std::size_t s = 0; s < in.sensors.size(); ++s)
    sensors.push_back({{"name", in.sensors[s].name},
                       {"accuracy", 92.25 - 7.0 * double(s)},
                       {"mae", 12.125 + 2.0 * double(s)},
                       {"nominal_accuracy", 70.5},
                       {"nominal_mae", 18.75}});
  for (int i = 0; i < 60; ++i) {
    const double rho = 7000 + 9000 * random.uniform(), c = 20.9e6 / rho * (1 + 0.05 * random.normal());
    rounds.push_back({{"optimizer", i % 4 == 0   ? "es"
                                    : i % 4 == 1 ? "gwo"
                                    : i % 4 == 2 ? "de"
                                                 : "mfo"},
                      {"theta", {{"tensile_cutoff", 1e5 * random.uniform()}, {"density", rho}, {"sound_speed", c}}},
                      {"objective", 65.7 - std::pow((rho * c / 20.9e6 - 1) * 30, 2) - std::pow((rho - 10345) / 4000, 2)}});
  }
  for (const auto& [name, best, rate] :
       {std::tuple{"es", 63.9, 30.0}, std::tuple{"gwo", 65.5, 12.0}, std::tuple{"de", 65.73, 18.0}, std::tuple{"mfo", 65.7, 9.0}}) {
    Json trace = Json::array();
    for (int g = 0; g <= 100; ++g) trace.push_back(best - 40 * std::exp(-g / rate));
    optimizers.push_back({{"name", name}, {"rounds", 15}, {"mean", best - 0.4}, {"sd", 0.31}, {"best", best}, {"trace", trace}});
  }
  for (int i = 0; i < 5; ++i)
    candidates.push_back({{"theta", {{"tensile_cutoff", 85642.0 + 900 * i}, {"density", 10345.0 + 320 * i}, {"sound_speed", 2020.0 - 55 * i}}},
                          {"objective_surrogate", method == "map" ? Json() : Json(65.73 - 0.02 * i)},
                          {"objective_model", 64.1 - 0.4 * std::abs(i - 1)}});
  Json summary{{"theta", theta},
               {"nominal", {{"tensile_cutoff", 1.5e5}, {"density", 13500.0}, {"sound_speed", 1450.0}}},
               {"objective", {{"name", "ACC[%] - MAE[\u00b5\u03b5]"}, {"value", 64.1}, {"sense", "maximise"}}},
               {"product", "tuned"},
               {"candidates", candidates},
               {"sensors", sensors},
               {"accuracy", 74.75},
               {"mae", 17.125},
               {"nominal_accuracy", 70.5},
               {"nominal_mae", 18.75},
               {"warnings", {"the best round lies on the bound of tensile_cutoff"}},
               {"provenance", provenance(method).json()}};
  if (enc) summary["rounds"] = rounds, summary["optimizers"] = optimizers;
  write_json(dir / (method + ".json"), summary);

  std::vector<std::string> names, conditions{"default"};
  for (const auto& s : in.sensors) names.push_back(s.name);
  std::vector<double> time, record_time, calibrated, nominal, mean, low, high;
  for (int k = 0; k * step <= 6e-4 + 1e-12; ++k) time.push_back(k * step);
  for (int k = 0; k * step <= 5e-4 + 1e-12; ++k) record_time.push_back(k * step);
  for (std::size_t s = 0; s < names.size(); ++s) {
    for (const double t : time) calibrated.push_back(wave(t, int(s), enc ? 1.02 : 0.97)), nominal.push_back(0.8 * wave(t, int(s), 0.9));
    for (const double t : record_time) {
      const bool dropout = s == 5 && t > 2e-4 && t < 2.12e-4;
      const double x = wave(t, int(s), 1) + 4e-6 * random.normal(), half = 1.5e-5 + 0.15 * std::abs(wave(t - 4e-6, int(s), 1));
      mean.push_back(dropout ? NAN : x), low.push_back(dropout ? NAN : x - half), high.push_back(dropout ? NAN : x + half);
    }
  }
  NetcdfWriter w(dir / (method + ".nc"));
  w.dimension("condition", 1), w.dimension("sensor", names.size()), w.dimension("time", time.size()), w.dimension("record_time", record_time.size());
  w.variable("condition", {"condition"}, conditions);
  w.variable("sensor", {"sensor"}, names);
  w.variable("time", {"time"}, time, {{"units", "s"}});
  w.variable("record_time", {"record_time"}, record_time, {{"units", "s"}});
  w.variable("calibrated", {"condition", "sensor", "time"}, calibrated, {{"units", "1"}});
  w.variable("nominal", {"condition", "sensor", "time"}, nominal, {{"units", "1"}});
  w.variable("record_mean", {"condition", "sensor", "record_time"}, mean, {{"units", "1"}});
  w.variable("band_low", {"condition", "sensor", "record_time"}, low, {{"units", "1"}});
  w.variable("band_high", {"condition", "sensor", "record_time"}, high, {{"units", "1"}});
  w.commit();
}

/// Draws along the ridge rho c = const: 4 chains of 2000; chain 4 lies apart when `apart`.
inline Draws ridge_draws(bool apart = false) {
  Draws draws{.names = {"tensile_cutoff", "density", "sound_speed", "gain_B"}, .chains = 4, .draws = 2000};
  for (std::size_t c = 0; c < 4; ++c) {
    RandomStream random(11, c);
    for (std::size_t i = 0; i < draws.draws; ++i) {
      const double rho = 12900 * std::exp(0.05 * random.normal()) * (apart && c == 3 ? 1.4 : 1), speed = 19.4e6 / rho * std::exp(0.006 * random.normal());
      draws.values.insert(draws.values.end(), {1.1e5 * std::exp(0.35 * random.normal()), rho, speed, 1 + 0.01 * random.normal()});
    }
  }
  return draws;
}

/// posterior.nc and posterior.json of these draws.
inline void write_sample(const std::filesystem::path& dir, const Draws& draws) {
  write_posterior(dir / "posterior.nc", {group_of("posterior", draws)}, provenance("sample"));
  const Convergence convergence = assess(draws);
  Json summary = convergence_json(convergence, convergence.converged ? "converged" : "density differs in chain 4");
  summary["provenance"] = provenance("sample").json();
  write_json(dir / "posterior.json", summary);
}

/// The same with what was known before (density 13 000 +- 1300 evenly, sound_speed 1450 +- 145 normal) and what is predicted: histories of every gauge whose
/// scale is spread evenly by 10 % to either side, against records that are the middle one, with errors of 20 microstrain where `errors`.
inline void write_sample_and_predictions(const std::filesystem::path& dir, const ReportInput& in, const Draws& draws, bool errors = true) {
  write_sample(dir, draws);
  PosteriorGroup prior{.name = "prior", .chains = 1, .draws = 1000, .coordinates = {}, .variables = {{"density", "", {}, {}}, {"sound_speed", "", {}, {}}}};
  RandomStream random(5, 0);
  for (int i = 0; i < 1000; ++i)
    prior.variables[0].values.push_back(13000 + 2600 * (random.uniform() - 0.5)), prior.variables[1].values.push_back(1450 + 145 * random.normal());
  std::vector<std::string> names;
  for (const auto& s : in.sensors) names.push_back(s.name);
  std::vector<double> time, record_time;
  for (int k = 0; k <= 300; ++k) time.push_back(k * 1e-6);
  for (int k = 0; k <= 200; ++k) record_time.push_back(k * 1e-6);
  const PosteriorCoordinate sensor{.name = "sensor", .unit = "", .numbers = {}, .words = names};
  PosteriorGroup predictive{.name = "posterior_predictive",
                            .chains = 4,
                            .draws = 25,
                            .coordinates = {sensor, {.name = "time", .unit = "s", .numbers = time, .words = {}}},
                            .variables = {{"strain", "1", {"sensor", "time"}, {}}}};
  for (int i = 0; i < 100; ++i)
    for (std::size_t s = 0; s < names.size(); ++s)
      for (const double t : time) predictive.variables[0].values.push_back(wave(t, int(s), 1) * (1 + 0.1 * (2 * i - 99) / 99.0));
  PosteriorGroup observed{.name = "observed_data",
                          .coordinates = {sensor, {.name = "record_time", .unit = "s", .numbers = record_time, .words = {}}},
                          .variables = {{"strain", "1", {"sensor", "record_time"}, {}}}};
  for (std::size_t s = 0; s < names.size(); ++s)
    for (const double t : record_time) observed.variables[0].values.push_back(wave(t, int(s), 1));
  if (errors) observed.variables.push_back({"error_sd", "1", {"sensor", "record_time"}, std::vector<double>(names.size() * record_time.size(), 20e-6)});
  write_posterior(dir / "posterior.nc", {group_of("posterior", draws), predictive, observed, prior}, provenance("sample"));
}

/// diagnosis.json and diagnosis.nc of a verdict, "named", "none", "ambiguous" or "unknown": the mismatch is at gauge F from 100 us on.
inline void write_diagnosis(const std::filesystem::path& dir, const ReportInput& in, const std::string& verdict) {
  const bool named = verdict == "named", told = named || verdict == "ambiguous";
  Json mechanisms = Json::array(), sensors = Json::array(), gauges = Json::array(), windows = Json::array(), bands = Json::array(), map = Json::array(),
       map_q = Json::array(), band_map = Json::array(), band_map_q = Json::array();
  if (told) mechanisms.push_back("beam_profile");
  if (verdict == "ambiguous") mechanisms.push_back("interface");
  for (int w = 0; w < 8; ++w)
    windows.push_back({{"begin_s", w * 5e-5}, {"end_s", (w + 1) * 5e-5}, {"score", w < 2 ? 0.9 : 9.0}, {"q_value", w < 2 ? 0.8 : 0.002}});
  for (int b = 0; b < 6; ++b)
    bands.push_back({{"low_hz", b * 1e4}, {"high_hz", (b + 1) * 1e4}, {"score", b == 0 ? 16.0 : 1.0}, {"q_value", b == 0 ? 1e-4 : 0.9}});
  for (std::size_t s = 0; s < in.sensors.size(); ++s) {
    const bool bad = s == 2;
    sensors.push_back({{"name", in.sensors[s].name}, {"score", bad ? 25.0 : 1.21}, {"q_value", bad ? 1e-5 : 0.6}});
    gauges.push_back({{"name", in.sensors[s].name},
                      {"sensor", in.sensors[s].name},
                      {"condition", "default"},
                      {"before", bad ? 0.2 : 0.05},
                      {"after", !bad   ? 0.05
                                : told ? 0.06
                                       : 0.2},
                      {"heldout_before", 0.25},
                      {"heldout_after", told ? 0.125 : 0.25}});
    Json row = Json::array(), q = Json::array();
    for (int w = 0; w < 8; ++w) row.push_back(bad && w > 1 ? 36.0 : 1.0), q.push_back(bad && w > 1 ? 1e-3 : 0.9);
    map.push_back(row), map_q.push_back(q);
    Json by_band = Json::array(), of_band = Json::array();
    for (int b = 0; b < 6; ++b) by_band.push_back(bad && b == 0 ? 25.0 : 1.0), of_band.push_back(bad && b == 0 ? 1e-3 : 0.9);
    band_map.push_back(by_band), band_map_q.push_back(of_band);
  }
  const auto entry = [&](const char* name, const char* plain, double p, double evidence, double explained, const char* why) {
    return Json{{"name", name},
                {"plain_name", plain},
                {"probability", p},
                {"log_evidence", evidence},
                {"log_bayes_factor", evidence},
                {"explained", explained},
                {"fitted", true},
                {"heldout_tried", true},
                {"heldout_gain", 0.5},
                {"size", "offset_z 2.31 \u00b1 0.16 mm in place of 0 mm"},
                {"why", why},
                {"would_change", "Records that speak otherwise."},
                {"same_as", Json::array()},
                {"parameters",
                 {{{"name", std::string(name) + ".offset_z"},
                   {"mean", 2.31e-3},
                   {"sd", 1.6e-4},
                   {"value", "2.31 \u00b1 0.16 mm"},
                   {"off", "0 mm"},
                   {"doc", "of the axis, upwards"},
                   {"deviations_from_off", 14.4}}}}};
  };
  Json ranking{entry("beam_profile", "the proton beam's profile", 0.9, 106.0, 0.92, "Named: it accounts for 92 % of the mismatch."),
               entry("interface", "a wetted wall that the mercury leaves early", 0.0625, 90.0, 0.8, "Less.")};
  ranking[0]["same_as"] = {"interface"}, ranking[1]["same_as"] = {"beam_profile"};
  for (const char* name : {"unknown", "none"})
    ranking.push_back({{"name", name},
                       {"probability", 0.01875},
                       {"log_evidence", -1.5},
                       {"parameters", Json::array()},
                       {"heldout_gain", 0.0},
                       {"why", "<i>because</i>"},
                       {"would_change", ""}});
  const Json before{{"density", {{"mean", 13905.0}, {"sd", 60.0}}}, {"sound_speed", {{"mean", 1455.0}, {"sd", 8.0}}}},
      after{{"density", {{"mean", 13520.0}, {"sd", 70.0}}}, {"sound_speed", {{"mean", 1450.0}, {"sd", 9.0}}}};
  const Json missing{{"sentence", "What is missing acts like a change <b>."},
                     {"terms", {{{"what", "mass"}, {"place", "on the top wall"}, {"value", "+4.67 \u00b1 0.69 kg/m\u00b2"}, {"log_bayes_factor", 8.1}}}}};
  const Json all{{"verdict", verdict},
                 {"missing", verdict == "unknown" ? missing : Json()},
                 {"mechanisms", mechanisms},
                 {"reason", "beam_profile explains 92 %"},
                 {"summary", "The finding of " + verdict + ". The next step <now>."},
                 {"finding", "The finding of " + verdict + "."},
                 {"next_step", "The next step <now>."},
                 {"status", "done"},
                 {"ranking", ranking},
                 {"gauges", gauges},
                 {"location",
                  {{"sensors", sensors},
                   {"windows", windows},
                   {"bands", bands},
                   {"map", map},
                   {"map_q_values", map_q},
                   {"band_map", band_map},
                   {"band_map_q_values", band_map_q},
                   {"region", {{"first_sensor", in.sensors[2].name}, {"first_time_s", 1e-4}}}}},
                 {"base_parameters", {{"before", before}, {"after", told ? after : before}, {"handbook", {{"density", {{"mean", 13500.0}, {"sd", 202.5}}}}}}},
                 {"absorbed", {{{"parameter", "density"}, {"prior_sigmas", 2.0}}}},
                 {"separating_measurement", "beam_profile and interface differ most at gauge C"},
                 {"runs", 412},
                 {"skipped", {"previous_pulses: no room"}},
                 {"provenance", provenance("diagnosis").json()}};
  write_json(dir / "diagnosis.json", all);

  std::vector<std::string> names, conditions{"default"};
  for (const auto& s : in.sensors) names.push_back(s.name);
  std::vector<double> time, record_time, base, explained, held_out, mean, low, high;
  for (int k = 0; k <= 500; ++k) time.push_back(k * 1e-6);
  for (int k = 0; k <= 400; ++k) record_time.push_back(k * 1e-6);
  for (std::size_t s = 0; s < names.size(); ++s) {
    for (const double t : time)
      base.push_back(wave(t, int(s), 1) * (s == 2 && t > 1e-4 ? 0.6 : 1)), explained.push_back(wave(t, int(s), 1.002)),
          held_out.push_back(wave(t, int(s), 1.01));
    for (const double t : record_time) mean.push_back(wave(t, int(s), 1)), low.push_back(mean.back() - 1e-5), high.push_back(mean.back() + 1e-5);
  }
  NetcdfWriter w(dir / "diagnosis.nc");
  w.attribute("explanation", verdict == "none" ? "" : "beam_profile");
  w.attribute("provenance", provenance("diagnosis").json().dump());
  w.dimension("condition", 1), w.dimension("sensor", names.size()), w.dimension("time", time.size()), w.dimension("record_time", record_time.size());
  w.variable("condition", {"condition"}, conditions);
  w.variable("sensor", {"sensor"}, names);
  w.variable("time", {"time"}, time);
  w.variable("record_time", {"record_time"}, record_time);
  const std::vector<std::string> model{"condition", "sensor", "time"}, record{"condition", "sensor", "record_time"};
  w.variable("base", model, base);
  w.variable("held_out_base", model, base);
  if (verdict != "none") w.variable("explained", model, explained), w.variable("held_out_explained", model, held_out);
  w.variable("record_mean", record, mean);
  w.variable("band_low", record, low);
  w.variable("band_high", record, high);
  w.commit();
}

/// sensitivity.json and sensitivity.nc: density does everything before 100 us, sound_speed after it, tensile_cutoff nothing; the record does not vary at all
/// before 10 us.
inline void write_sensitivity(const std::filesystem::path& dir, const ReportInput& in) {
  const std::vector<std::string> parameters{"tensile_cutoff", "density", "sound_speed"};
  const auto indices = [&](std::array<double, 3> values) {
    Json list = Json::array();
    for (std::size_t k = 0; k < 3; ++k)
      list.push_back({{"parameter", parameters[k]}, {"value", values[k]}, {"low", values[k] - 0.01}, {"high", values[k] + 0.01}});
    return list;
  };
  const auto morris = [&](double scale) {
    Json list = Json::array();
    for (std::size_t k = 0; k < 3; ++k)
      list.push_back(
          {{"parameter", parameters[k]}, {"mu", -scale * double(k)}, {"mu_star", scale * double(k)}, {"mu_star_se", 0.1 * scale}, {"sigma", 0.5 * scale}});
    return list;
  };
  Json quantities = Json::array();
  const auto quantity = [&](const char* name, const std::string& sensor, const char* unit, std::array<double, 3> first, std::array<double, 3> total) {
    quantities.push_back({{"name", name},
                          {"sensor", sensor},
                          {"condition", ""},
                          {"unit", unit},
                          {"mean", 1e-4},
                          {"sd", 1e-5},
                          {"first_order", indices(first)},
                          {"total_order", indices(total)},
                          {"morris", Json::array()}});
    if (std::string(name) == "record") return;
    quantities.back()["morris"] = morris(std::string(unit) == "s" ? 1e-6 : 2e-5);
    quantities.back()["polynomial"] = {
        {"order", 3}, {"left_out_r2", 0.97}, {"first_order", indices(first)}, {"total_order", indices({total[0], total[1] + 0.03, total[2]})}};
  };
  for (const auto& s : in.sensors)
    quantity("peak", s.name, "strain", {0, 0.6, 0.3}, {0, 0.7, 0.4}), quantity("time_of_peak", s.name, "s", {0, 0.1, 0.8}, {0.1, 0.2, 0.9}),
        quantity("rms", s.name, "strain", {0, 0.5, 0.5}, {0, 0.5, 0.5});
  for (const auto& s : in.sensors) quantity("record", s.name, "strain", {-0.02, 0.3, 0.6}, {0.005, 0.325, 0.65});
  quantity("record", "", "strain", {-0.004, 0.3, 0.6}, {0.005, 0.4, 0.7});
  write_json(dir / "sensitivity.json", {{"status", "done"},
                                        {"source", "Sobol' indices and elementary effects are those of the surrogate"},
                                        {"measure", "uniform"},
                                        {"samples", 2048},
                                        {"evaluations", 10496},
                                        {"failed", 16},
                                        {"first_order", quantities.back()["first_order"]},
                                        {"total_order", quantities.back()["total_order"]},
                                        {"morris", Json::array()},
                                        {"quantities", quantities},
                                        {"provenance", provenance("sensitivity").json()}});
  std::vector<std::string> names;
  for (const auto& s : in.sensors) names.push_back(s.name);
  std::vector<double> time, sd, first, total;
  for (int k = 0; k <= 400; ++k) time.push_back(k * 1e-6);
  for (std::size_t s = 0; s < names.size(); ++s)
    for (const double t : time) {
      const bool still = t < 9.5e-6, early = t < 9.95e-5;
      sd.push_back(still ? 0 : 1e-5 * double(s + 1));
      for (const double share : {0.0, early ? 1.0 : 0.0, early ? 0.0 : 1.0}) first.push_back(still ? NAN : 0.9 * share), total.push_back(still ? NAN : share);
    }
  NetcdfWriter w(dir / "sensitivity.nc");
  w.attribute("provenance", provenance("sensitivity").json().dump());
  w.dimension("sensor", names.size()), w.dimension("time", time.size()), w.dimension("parameter", 3);
  w.variable("sensor", {"sensor"}, names);
  w.variable("time", {"time"}, time, {{"units", "s"}});
  w.variable("parameter", {"parameter"}, parameters);
  w.variable("sd", {"sensor", "time"}, sd);
  w.variable("first_order", {"sensor", "time", "parameter"}, first);
  w.variable("total_order", {"sensor", "time", "parameter"}, total);
  w.commit();
}

inline void write_study(const std::filesystem::path& dir, const ReportInput& in) {
  write_campaign(dir, in);
  write_train(dir);
  write_calibration(dir, in, "enc");
}

}  // namespace calomel::testing_report
