#include <cmath>
#include <limits>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"
#include "inverse/calibration/calibration.hpp"
#include "inverse/data/history_file.hpp"

namespace calomel {

namespace {

Json candidate(const Candidate& c, const ModelShape& shape, bool corrected) {
  Json j{{"theta", named(shape.parameters, c.theta)},
         {"objective_surrogate", number(c.objective_surrogate)},
         {"objective_model", c.objective_model ? number(*c.objective_model) : Json()}};
  if (c.score.ok) {
    j["accuracy"] = number(c.score.accuracy);
    j["mae"] = number(c.score.mae);
  }
  if (corrected) j["inside_emulator"] = c.inside_emulator;
  if (!c.message.empty()) j["message"] = c.message;
  return j;
}

/// rho c of both parameter sets, where both factors are parameters.
Json impedance(const ModelShape& shape, const Calibration& s) {
  int rho = -1, c = -1;
  for (std::size_t k = 0; k < shape.parameters.size(); ++k) {
    if (shape.parameters[k].name == "density") rho = int(k);
    if (shape.parameters[k].name == "sound_speed") c = int(k);
  }
  if (rho < 0 || c < 0) return {};
  const auto product = [&](const std::vector<double>& theta) { return theta[std::size_t(rho)] * theta[std::size_t(c)]; };
  return {{"value", product(s.theta)}, {"nominal", product(s.nominal)}, {"unit", "kg m-2 s-1"}};
}

/// One entry a sensor; several conditions are averaged, and listed beside.
Json sensors(const Score& best, const Score& at_nominal, const Problem& problem) {
  const auto mean = [](const Score& score, const std::string& name, double SensorScore::*field) {
    double sum = 0;
    int n = 0;
    if (score.ok)
      for (const auto& x : score.sensors)
        if (x.name == name && std::isfinite(x.*field)) {
          sum += x.*field;
          ++n;
        }
    return n > 0 ? Json(sum / n) : Json();
  };
  Json all = Json::array();
  for (const auto& name : problem.shape.sensors) {
    Json j{{"name", name},
           {"accuracy", mean(best, name, &SensorScore::accuracy)},
           {"mae", mean(best, name, &SensorScore::mae)},
           {"nominal_accuracy", mean(at_nominal, name, &SensorScore::accuracy)},
           {"nominal_mae", mean(at_nominal, name, &SensorScore::mae)},
           {"rrmse", mean(best, name, &SensorScore::rrmse)},
           {"nominal_rrmse", mean(at_nominal, name, &SensorScore::rrmse)}};
    bool recorded = false;
    std::size_t samples = 0, banded = 0, narrow = 0;
    Json pulses = Json::array(), conditions = Json::array();
    for (std::size_t i = 0; i < problem.observations.size(); ++i) {
      const auto& o = problem.observations[i];
      if (problem.shape.sensors[o.sensor] != name) continue;
      recorded = true;
      samples += o.samples;
      banded += o.banded_samples;
      narrow += o.narrow;
      pulses.push_back(o.pulses);
      const auto of = [&](const Score& score, double SensorScore::*field) { return score.ok ? number(score.sensors[i].*field) : Json(); };
      conditions.push_back({{"condition", problem.shape.conditions[o.condition]},
                            {"accuracy", of(best, &SensorScore::accuracy)},
                            {"mae", of(best, &SensorScore::mae)},
                            {"nominal_accuracy", of(at_nominal, &SensorScore::accuracy)},
                            {"nominal_mae", of(at_nominal, &SensorScore::mae)}});
    }
    if (!recorded) continue;
    j["pulses"] = pulses.size() == 1 ? pulses[0] : pulses;
    j["samples"] = samples;
    j["banded_samples"] = banded;
    j["narrow_samples"] = narrow;
    if (problem.shape.conditions.size() > 1) j["conditions"] = conditions;
    all.push_back(std::move(j));
  }
  return all;
}

Json mesh_json(const CorrectionReport& m, const Calibration& s, const Problem& problem) {
  const auto of = [](const Score& score, double Score::*field) { return score.ok ? number(score.*field) : Json(); };
  Json j{{"sentence", m.sentence},
         {"relative_difference", s.calibrated.empty() ? Json() : number(m.difference)},
         {"nominal_inside_emulator", s.at_nominal.inside_emulator}};
  if (!m.without.empty()) j["theta_without_correction"] = named(problem.shape.parameters, m.without);
  j["working_mesh"] = {{"accuracy", of(m.best, &Score::accuracy)},
                       {"mae", of(m.best, &Score::mae)},
                       {"nominal_accuracy", of(m.at_nominal, &Score::accuracy)},
                       {"nominal_mae", of(m.at_nominal, &Score::mae)},
                       {"sensors", sensors(m.best, m.at_nominal, problem)}};
  return j;
}

}  // namespace

Json calibration_json(const Calibration& s, const Problem& problem, const Json& own, const Provenance& provenance) {
  const auto& shape = problem.shape;
  const auto average = [](const Candidate& c, double Score::*field) { return c.score.ok ? number(c.score.*field) : Json(); };
  const auto accuracy = [&](const Candidate& c) { return c.score.banded_sensors > 0 ? average(c, &Score::accuracy) : Json(); };
  Json j;
  j["status"] = s.status == CalibrationStatus::done           ? "done"
                : s.status == CalibrationStatus::not_settled  ? "not_settled"
                : s.status == CalibrationStatus::no_candidate ? "no_candidate"
                                                              : "not_run";
  j["message"] = s.message;
  j["theta"] = named(shape.parameters, s.theta);
  j["nominal"] = named(shape.parameters, s.nominal);
  const double value = s.best.objective_model.value_or(std::numeric_limits<double>::quiet_NaN());
  j["objective"] = {{"name", s.objective.name},
                    {"value", number(value)},
                    {"sense", s.objective.sense()},
                    {"surrogate", number(s.best.objective_surrogate)},
                    {"nominal", s.at_nominal.objective_model ? number(*s.at_nominal.objective_model) : Json()}};
  j["product"] = s.product;
  j["meaning"] =
      "tuned: the values with which this model imitates these recordings best within the case's bounds; not a material property. They compensate for "
      "whatever the model omits, and the published objective mixes percent with strain.";
  j["accuracy"] = accuracy(s.best);
  j["mae"] = average(s.best, &Score::mae);
  j["nominal_accuracy"] = accuracy(s.at_nominal);
  j["nominal_mae"] = average(s.at_nominal, &Score::mae);
  j["nrmse"] = average(s.best, &Score::nrmse);
  j["nominal_nrmse"] = average(s.at_nominal, &Score::nrmse);
  j["delta1"] = average(s.best, &Score::delta1);
  j["delta2"] = average(s.best, &Score::delta2);
  j["nominal_delta1"] = average(s.at_nominal, &Score::delta1);
  j["nominal_delta2"] = average(s.at_nominal, &Score::delta2);
  j["mae_unit"] = problem.mae_unit;
  j["scores_on"] = s.mesh.scores_on;
  if (const Json z = impedance(shape, s); !z.is_null()) j["impedance"] = z;
  j["candidates"] = Json::array();
  j["failed_candidates"] = Json::array();
  for (const auto& c : s.candidates) j["candidates"].push_back(candidate(c, shape, s.mesh.used));
  for (const auto& c : s.failed) j["failed_candidates"].push_back(candidate(c, shape, s.mesh.used));
  j["sensors"] = sensors(s.best.score, s.at_nominal.score, problem);
  if (s.mesh.used) j["mesh"] = mesh_json(s.mesh, s, problem);
  for (const auto& [key, value] : own.items()) j[key] = value;
  j["compared_times"] = problem.time.size();
  j["times_outside_simulation"] = problem.outside;
  j["evaluations"] = s.evaluations;
  j["model_runs"] = s.model_runs;
  j["search_s"] = s.search_s;
  j["model_s"] = s.model_s;
  j["warnings"] = s.warnings;
  j["provenance"] = provenance.json();
  return j;
}

void write_calibration(const std::string& method, const Calibration& s, const Problem& problem, const Json& json, const Provenance& provenance,
                       const std::filesystem::path& out_dir) {
  const std::vector<double> absent(problem.shape.values(), std::numeric_limits<double>::quiet_NaN());
  const auto or_absent = [&](const std::vector<double>& values) -> const std::vector<double>& { return values.empty() ? absent : values; };
  const std::string with = s.mesh.used ? ", corrected for the mesh" : "";
  HistoryFile file(out_dir / (method + ".nc"), problem, provenance);
  file.history("calibrated", or_absent(s.calibrated), "true model at the calibrated parameters" + with);
  file.history("nominal", or_absent(s.nominal_values), "true model at the nominal parameters" + with);
  if (s.mesh.used) {
    file.history("calibrated_working_mesh", or_absent(s.mesh.calibrated), "true model at the calibrated parameters, on the case's mesh");
    file.history("nominal_working_mesh", or_absent(s.mesh.nominal_values), "true model at the nominal parameters, on the case's mesh");
  }
  file.commit();
  write_json(out_dir / (method + ".json"), json);
}

}  // namespace calomel
