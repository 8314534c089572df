#include <fmt/format.h>

#include <algorithm>

#include "apps/stages.hpp"
#include "apps/unknowns.hpp"
#include "apps/verbs.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/repeatability_floor.hpp"
#include "inverse/comparison.hpp"
#include "inverse/feasibility.hpp"

namespace calomel {

namespace {

constexpr double assumed_mesh_error = 80;   ///< over the local amplitude, per metre of element size: of the first order
constexpr double greatest_wave_speed = 40;  ///< [m/s], over the element size: the frequency up to which waves on the mesh are fast enough

const std::vector<std::string> every_method{"enc", "spe", "map"};

/// Each method once, "all" written out.
std::vector<std::string> written_out(const std::vector<std::string>& methods) {
  std::vector<std::string> out;
  for (const auto& m : methods)
    for (const auto& name : m == "all" ? every_method : std::vector{m})
      if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  return out;
}

/// METHOD.json where it stands, finished, and belongs to these recordings; nothing otherwise.
std::optional<Json> finished(const std::filesystem::path& path, const std::string& recordings) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  Json json = read_json(path);
  const auto hash = json.value(Json::json_pointer("/provenance/inputs/recordings"), "");
  return hash == recordings && json.value("status", "") == "done" ? std::optional(std::move(json)) : std::nullopt;
}

}  // namespace

ExitStatus Stages::calibrate(const std::vector<std::string>& methods) {
  auto status = ExitStatus::done;
  for (const auto& method : written_out(methods)) status = worse(status, calibrate(method));
  compare();
  return status;
}

void Stages::compare() {
  std::vector<MethodSummary> summaries;
  Provenance provenance{.stage = "comparison", .seed = command_.seed, .inputs = {{"recordings", hash_file(study_.recordings_file())}}};
  for (const auto& method : every_method) {
    const auto path = command_.out / (method + ".json");
    auto json = finished(path, provenance.inputs.at("recordings"));
    if (!json) continue;
    provenance.inputs[method + ".json"] = hash_file(path);
    summaries.push_back({method, std::move(*json)});
  }
  const auto path = command_.out / "comparison.json";
  if (summaries.size() < 2) {  // one of an earlier call would tell of answers that are gone
    set_aside(path);
    return;
  }
  const auto comparison = compare_calibrations(summaries);
  write_json(path, comparison_json(comparison, provenance));
  say(comparison_text(comparison));
}

bool Stages::draws_errors(const std::string& method) const { return (method == "enc" && study_.enc.draws > 0) || (method == "spe" && study_.spe.draws > 0); }

bool Stages::needs_floor(const std::string& method) const {
  const bool drawn = draws_errors(method) && study_.campaign.floor;  // without one the energies' scatter stands for it
  return study_.map.likelihood.floor > 0 && (method == "map" || drawn || (method == "enc" && study_.enc.needs_likelihood()));
}

LikelihoodOptions Stages::likelihood_options() const {
  LikelihoodOptions options = study_.map.likelihood;
  const double element = study_.forward.geometry.resolved().element_size.value_or(0);
  if (!options.band && element > 0) options.band = greatest_wave_speed / element;
  return options;
}

Recordings Stages::recordings() {
  std::vector<std::string> said;
  return study_.matched_recordings(model().shape().sensors, said);
}

MapModels Stages::models_with_errors(const ForwardModel& true_model, const Surrogate* surrogate) {
  MapModels models{.true_model = true_model, .surrogate = surrogate};
  if (surrogate) models.surrogate_variance = [surrogate](std::span<const double> theta) { return surrogate->error_variance(theta); };
  const auto floor = command_.out / "floor.json";
  if (study_.map.likelihood.floor > 0 && std::filesystem::exists(floor)) {  // one that is needed was made before
    const Json measured = read_json(floor);
    if (measured.value(Json::json_pointer("/provenance/identity"), "") == floor_provenance().identity()) models.floor_variance = floor_variance(measured, model().shape());
  }
  models.mesh_relative = study_.map.mesh_error.value_or(assumed_mesh_error * study_.forward.geometry.resolved().element_size.value_or(0));
  models.positions.resize(Eigen::Index(study_.forward.sensors.size()), 3);
  for (std::size_t s = 0; s < study_.forward.sensors.size(); ++s)
    for (std::size_t i = 0; i < 3; ++i) models.positions(Eigen::Index(s), Eigen::Index(i)) = study_.forward.sensors[s].position[i];
  return models;
}

Likelihood Stages::likelihood_at_nominal(const Surrogate& surrogate) {
  return likelihood_at(problem(), recordings(), *study_.recordings, likelihood_options(), study_.map.discrepancy.distance, models_with_errors(model(), &surrogate),
                       nominal(problem().shape), true);
}

ErrorsAt Stages::errors_at(const Surrogate* surrogate) {
  return [this, surrogate](std::span<const double> theta, const MeshError& mesh, const RefinedModel::Variance& surrogate_variance) {
    const RememberingModel once(model());
    MapModels models = models_with_errors(once, surrogate);
    models.mesh = mesh.with_records_beyond(study_.map.mesh_beyond, study_.map.mesh_beyond_sd), models.surrogate_variance = surrogate_variance;
    const UnknownOptions& unknowns = study_.map.unknowns;
    if (unknowns.young_sd > 0 || unknowns.gauge_place_sd > 0) models.unknowns = unknown_directions(model(), theta, unknowns, command_.threads);
    return answer_errors(problem(), recordings(), *study_.recordings, likelihood_options(), study_.map.discrepancy.distance, models, theta);
  };
}

EncSummary Stages::calibrate_enc(const Provenance& provenance, const Surrogate& surrogate, const Archive& archive, const CalibrationProgress& progress) {
  const Feasibility feasibility(archive);
  say_failures(archive, feasibility);
  std::optional<Likelihood> likelihood;
  if (study_.enc.needs_likelihood()) likelihood.emplace(likelihood_at_nominal(surrogate));
  auto added = added_runs("enc", false, study_.enc.mesh_pairs > 0);
  const EncRuns runs{run_source(added, progress), archive, study_.enc.draws > 0 ? errors_at(&surrogate) : ErrorsAt(),
                     [&](std::span<const double> theta) { return surrogate.error_variance(theta); }};
  const auto summary =
      run_enc(problem(), GuardedModel(surrogate, feasibility), model(), study_.enc, command_.seed, command_.threads, progress, likelihood ? &*likelihood : nullptr, &runs);
  write_enc(summary, problem(), provenance, command_.out);
  say_mesh("enc", summary);
  if (!summary.agreement.sentence.empty()) say("enc: " + summary.agreement.sentence);
  return summary;
}

void Stages::say_mesh(const std::string& method, const Calibration& summary) const {
  if (!summary.mesh.sentence.empty()) say(method + ": " + summary.mesh.sentence);
  if (!summary.spread.sentence.empty()) say(method + ": " + summary.spread.sentence);
}

SpeSummary Stages::calibrate_spe(const Provenance& provenance, const CalibrationProgress& progress) {
  const Archive archive = read_archive(command_.out / "campaign.nc");
  say_failures(archive, Feasibility(archive));
  auto added = added_runs("spe", study_.spe.zoom > 0, study_.spe.mesh_pairs > 0);
  const RunSource source = run_source(added, progress);
  const auto summary = run_spe(problem(), archive, model(), study_.spe, command_.seed, command_.threads, progress, &source, study_.spe.draws > 0 ? errors_at(nullptr) : ErrorsAt());
  write_spe(summary, problem(), provenance, command_.out);
  say_mesh("spe", summary);
  return summary;
}

ExitStatus run_calibrate(const CommandLine& command) { return Stages(command).calibrate(command.methods); }

}  // namespace calomel
