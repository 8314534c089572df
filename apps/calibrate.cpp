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

bool Stages::needs_floor(const std::string& method) const { return method == "map" && study_.map.likelihood.floor > 0; }

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

EncSummary Stages::calibrate_enc(const Provenance& provenance, const Surrogate& surrogate, const Archive& archive, const CalibrationProgress& progress) {
  const Feasibility feasibility(archive);
  say_failures(archive, feasibility);
  const auto summary = run_enc(problem(), GuardedModel(surrogate, feasibility), model(), study_.enc, command_.seed, command_.threads, progress,
                               mesh_correction("enc", study_.enc.mesh_correction, progress));
  write_enc(summary, problem(), provenance, command_.out);
  if (!summary.mesh.sentence.empty()) say("enc: " + summary.mesh.sentence);
  if (!summary.agreement.sentence.empty()) say("enc: " + summary.agreement.sentence);
  return summary;
}

SpeSummary Stages::calibrate_spe(const Provenance& provenance, const CalibrationProgress& progress) {
  const Archive archive = read_archive(command_.out / "campaign.nc");
  say_failures(archive, Feasibility(archive));
  const MeshCorrection* correction = mesh_correction("spe", study_.spe.mesh_correction, progress);
  auto added = added_runs("spe", study_.spe.zoom > 0, false);
  const RunSource source = run_source(added, progress);
  MakeRuns make_runs;
  if (source.run)
    make_runs = [&source](const Eigen::MatrixXd& thetas) {
      std::vector<RunRecord> records;
      for (auto& r : source.run(thetas, std::vector<bool>(std::size_t(thetas.cols())))) records.push_back(std::move(r.working));
      return records;
    };
  const auto summary = run_spe(problem(), archive, model(), study_.spe, command_.seed, command_.threads, progress, make_runs, correction);
  write_spe(summary, problem(), provenance, command_.out);
  if (!summary.mesh.sentence.empty()) say("spe: " + summary.mesh.sentence);
  return summary;
}

ExitStatus run_calibrate(const CommandLine& command) { return Stages(command).calibrate(command.methods); }

}  // namespace calomel
