#include <fmt/format.h>

#include <algorithm>

#include "apps/interrupt.hpp"
#include "apps/pipeline/stages.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"
#include "inverse/comparison/comparison.hpp"
#include "forward/surrogate/feasibility.hpp"

namespace calomel {

namespace {


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

Recordings Stages::recordings() {
  std::vector<std::string> said;
  return study_.matched_recordings(model().shape().sensors, said);
}

void Stages::say_failures(const Archive& archive, const Feasibility& feasibility) const {
  if (!feasibility.any_failed()) return;
  say(fmt::format("{} of {} runs of the campaign failed and are left out; searches keep off where runs are likely to fail ({:.0f} % of the runs are told rightly from the others)",
                  feasibility.failures(), archive.runs(), 100 * feasibility.leave_one_out_accuracy()));
  for (const auto& [reason, count] : failure_reasons(archive)) say(fmt::format("  {} x {}", count, reason));
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
  const auto make_runs = [&](const Eigen::MatrixXd& thetas) {
    const auto& parameters = model().shape().parameters;
    std::vector<RunPoint> points;
    for (Eigen::Index i = 0; i < thetas.cols(); ++i) points.push_back(point_at(parameters, {thetas.col(i).data(), parameters.size()}));
    const auto evaluate = [&](const RunPoint& p) { return evaluate_run(model(), theta_at(parameters, p), false); };
    return run_store().run(points, evaluate, command_.threads, {}, [&](std::size_t done, std::size_t all) { progress("runs of the true model", done, all); }, &stop_requested());
  };
  const auto summary = run_spe(problem(), archive, model(), study_.spe, command_.seed, command_.threads, progress, make_runs, correction);
  write_spe(summary, problem(), provenance, command_.out);
  if (!summary.mesh.sentence.empty()) say("spe: " + summary.mesh.sentence);
  return summary;
}

}  // namespace calomel
