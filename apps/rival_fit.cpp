#include "apps/rival_fit.hpp"

#include <algorithm>
#include <cmath>

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

RunRecord record(const std::vector<double>& values, std::size_t run, std::size_t count, int status) {
  RunRecord r{.done = status == 0};
  if (r.done) r.mean.assign(values.begin() + std::ptrdiff_t(run * count), values.begin() + std::ptrdiff_t((run + 1) * count));
  return r;
}

std::vector<AddedRun> read_runs(const std::filesystem::path& path, const ModelShape& shape) {
  std::vector<AddedRun> runs;
  if (!std::filesystem::exists(path)) return runs;
  const NetcdfReader file(path);
  const auto names = file.strings("parameter");
  const auto theta = file.doubles("theta"), working = file.doubles("strain");
  const auto status = file.integers("status"), status_fine = file.integers("status_fine");
  const auto fine = file.has("strain_fine") ? file.doubles("strain_fine") : std::vector<double>{};
  const std::size_t n = names.size(), values = shape.values();
  if (working.size() != status.size() * values) throw InputError({.problem = path.string() + " holds histories of another length than this case's", .key = key});
  for (std::size_t i = 0; i < status.size(); ++i) {
    AddedRun r{.theta = in_full(shape, names, {theta.data() + i * n, n}), .working = record(working, i, values, status[i])};
    if (!fine.empty() && status_fine[i] != 2) r.fine = record(fine, i, values, status_fine[i]);
    runs.push_back(std::move(r));
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
  out.history = NetcdfReader(directory / "map.nc").doubles("calibrated");
  out.runs = read_runs(directory / "added_runs.nc", shape);
  out.discrepancy_scale = json.value(Json::json_pointer("/discrepancy/scale"), 0.0);
  return out;
}

}  // namespace calomel
