#include <fmt/format.h>

#include <algorithm>

#include "apps/stages.hpp"
#include "apps/verbs.hpp"
#include "inverse/comparison.hpp"

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

ExitStatus run_calibrate(const CommandLine& command) { return Stages(command).calibrate(command.methods); }

}  // namespace calomel
