#include "apps/rival_fit.hpp"

#include <algorithm>
#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"

namespace calomel {

namespace {

const std::string key = "map.compare_with";

/// This problem's parameters with those of another fit put in by name; names that are not here are left out, which the comparison refuses.
std::vector<double> in_full(const ModelShape& shape, const std::vector<std::string>& names, std::span<const double> values) {
  std::vector<double> theta = nominal(shape);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto at = std::find_if(shape.parameters.begin(), shape.parameters.end(), [&](const Parameter& p) { return p.name == names[k]; });
    if (at != shape.parameters.end()) theta[std::size_t(at - shape.parameters.begin())] = values[k];
  }
  return theta;
}

/// The runs that its MAP asked for; all of a file that does not tell who asked.
std::vector<AddedRun> runs_of_map(const std::filesystem::path& path, const ModelShape& shape) {
  std::vector<std::string> names;
  std::vector<AddedRun> runs;
  for (auto& k : read_added_runs(path, shape.values(), names)) {
    if (!k.asked_by.empty() && std::find(k.asked_by.begin(), k.asked_by.end(), "map") == k.asked_by.end()) continue;
    k.run.theta = in_full(shape, names, k.run.theta);
    runs.push_back(std::move(k.run));
  }
  return runs;
}

}  // namespace

RivalFit read_rival_fit(const std::filesystem::path& directory, const ModelShape& shape, const MapOptions& options, const std::string& recordings) {
  const auto refuse = [&](const std::string& problem, const std::string& suggestion) {
    throw InputError({.problem = directory.string() + " " + problem, .key = key, .value = "\"" + options.compare_with + "\"", .suggestion = suggestion});
  };
  if (!std::filesystem::exists(directory / "map.json")) refuse("holds no map.json", "fit the smaller model first: calomel calibrate ITS.toml --method map");
  const Json json = read_json(directory / "map.json");
  if (json.value("status", "") != "done") refuse("holds a fit that did not end well", "see its map.json");
  if (json.value(Json::json_pointer("/provenance/inputs/recordings"), "") != recordings) refuse("holds a fit of other recordings", "both must be fitted to the same file");
  if (json.value("product", "") != options.product) refuse("holds the product " + json.value("product", ""), "set map.product alike");
  RivalFit out{.name = directory.lexically_normal().filename().string()};
  std::vector<double> answer;
  for (const auto& name : json.at("parameters")) out.sought.push_back(name), answer.push_back(json.at("theta").at(out.sought.back()));
  out.theta = in_full(shape, out.sought, answer);
  const NetcdfReader file(directory / "map.nc");
  out.history = file.doubles(file.has("calibrated_working_mesh") ? "calibrated_working_mesh" : "calibrated");
  out.runs = runs_of_map(directory / "added_runs.nc", shape);
  out.discrepancy_scale = json.value(Json::json_pointer("/discrepancy/scale"), 0.0);
  return out;
}

}  // namespace calomel
