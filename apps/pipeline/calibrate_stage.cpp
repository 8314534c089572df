#include "apps/pipeline/calibrate_stage.hpp"

#include <algorithm>
#include <optional>

#include "apps/inputs/provenances.hpp"
#include "apps/pipeline/campaign_stage.hpp"
#include "apps/pipeline/enc_stage.hpp"
#include "apps/pipeline/map_stage.hpp"
#include "apps/pipeline/spe_stage.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/pipeline/train_stage.hpp"
#include "apps/presentation/comparison_words.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "base/artefact.hpp"
#include "base/identity.hpp"
#include "base/provenance.hpp"
#include "inverse/comparison/comparison.hpp"

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

/// METHOD.json if it exists, is finished and has the identity of this case; nothing otherwise.
std::optional<Json> finished(const StudyInputs& inputs, const std::string& method) {
  const auto path = inputs.artefact(method + ".json");
  if (!std::filesystem::exists(path)) return std::nullopt;
  Json json = read_json(path);
  const auto missing = [&](const char* name) { return !std::filesystem::exists(inputs.artefact(name)); };
  if ((method == "enc" && missing("surrogate.nc")) || (method == "spe" && missing("campaign.nc")) ||
      (basin_on_surrogate(inputs.study()) && missing("surrogate.nc")))
    return std::nullopt;
  const bool same = identity_of(json.value("provenance", Json::object())) == calibration_provenance(inputs, method).identity();
  return same && json.value("status", "") == "done" ? std::optional(std::move(json)) : std::nullopt;
}

/// Makes the missing training data of the method; returns the status of the campaign. Errors in other inputs are reported before that long work.
ExitStatus make_upstream(StageCall& call, const std::string& method) {
  auto& inputs = call.inputs;
  const bool emulator = takes_emulator(inputs.study(), method);
  (void)inputs.problem();
  if (method == "map" && !std::filesystem::exists(inputs.artefact("map.json"))) (void)compared_fit(inputs);
  if (method != "map" && emulator) expect_own_mesh_among_emulators(inputs.study(), method);
  const auto status = method == "map" ? ExitStatus::done : method == "spe" ? campaign_stage(call, Requested::upstream) : train_stage(call, Requested::upstream);
  if (emulator) need_basin(call);
  return status;
}

Calibration calibrated_by(StageCall& call, const std::string& method, const Provenance& provenance) {
  const auto progress = stage_progress(method, call.inputs.command().quiet);
  return call.inputs.study().file.locating([&]() -> Calibration {
    if (method == "spe") return spe_stage(call, provenance, progress);
    if (method == "map") return map_stage(call, provenance, progress);
    return enc_stage(call, provenance, progress);
  });
}

ExitStatus calibrate(StageCall& call, const std::string& method) {
  auto& inputs = call.inputs;
  const auto upstream = make_upstream(call, method);
  const auto provenance = calibration_provenance(inputs, method);
  if (!call.finished.due(provenance, {method + ".json", method + ".nc"}, Requested::by_user)) {
    inputs.notes().say(reused_line(method));
    const auto before = read_json(inputs.artefact(method + ".json"));
    return worse(upstream, before.value("status", "") == "done" ? ExitStatus::done : ExitStatus::not_to_be_trusted);
  }
  const auto summary = calibrated_by(call, method, provenance);
  const auto& said = inputs.problem().warnings;
  for (const auto& w : summary.warnings)
    if (std::find(said.begin(), said.end(), w) == said.end()) inputs.notes().warn(w);
  inputs.notes().say(stage_line(method, summary.message));
  return worse(upstream, summary.trusted() ? ExitStatus::done : ExitStatus::not_to_be_trusted);
}

/// Writes comparison.json from the calibrations of these recordings in --out, when there are two or more.
void compare(const StudyInputs& inputs) {
  std::vector<MethodSummary> summaries;
  Provenance provenance = comparison_provenance(inputs);
  for (const auto& method : every_method) {
    const auto path = inputs.artefact(method + ".json");
    auto json = finished(inputs, method);
    if (!json) continue;
    provenance.inputs[method + ".json"] = hash_file(path);
    summaries.push_back({method, std::move(*json)});
  }
  const auto path = inputs.artefact("comparison.json");
  if (summaries.size() < 2) {  // one of an earlier call would describe answers that no longer exist
    set_aside(path);
    return;
  }
  const auto comparison = compare_calibrations(summaries);
  write_json(path, comparison_json(comparison, comparison_sentence(comparison), provenance));
  inputs.notes().say(comparison_text(comparison));
}

}  // namespace

ExitStatus calibrate_stage(StageCall& call, const std::vector<std::string>& methods) {
  auto status = ExitStatus::done;
  for (const auto& method : written_out(methods)) status = worse(status, calibrate(call, method));
  compare(call.inputs);
  return status;
}

}  // namespace calomel
