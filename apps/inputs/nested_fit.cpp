#include "apps/inputs/nested_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"

namespace calomel {

namespace {

constexpr double same_model = 1e-3;  ///< relative difference of two histories: what single precision and another build leave

[[noreturn]] void refuse(const MapOptions& options, const std::string& problem, const std::string& suggestion) {
  throw InputError({.problem = problem, .key = "map.compare_with", .value = "\"" + options.compare_with + "\"", .suggestion = suggestion});
}

}  // namespace

NestedFit read_nested_fit(const std::filesystem::path& directory, const std::vector<Parameter>& parameters, std::size_t own, const MapOptions& options,
                          const std::string& recordings) {
  const std::string where = directory.string();
  if (!std::filesystem::exists(directory / "map.json"))
    refuse(options, where + " holds no map.json", "fit the smaller model first: calomel calibrate ITS.toml --method map");
  const Json json = read_json(directory / "map.json");
  const auto status = json.value("status", "");
  if (status != "done" && status != "not_settled") refuse(options, where + " holds a fit that did not end well", "see its map.json");
  if (!json.contains("emulator")) refuse(options, where + " has a fit by an earlier version", "repeat the fit");
  if (json.value(Json::json_pointer("/provenance/inputs/recordings"), "") != recordings)
    refuse(options, where + " holds a fit of other recordings", "both must be fitted to the same file");
  if (json.value("product", "") != options.product) refuse(options, where + " holds the product " + json.value("product", ""), "set map.product alike");
  NestedFit out;
  out.model.name = directory.lexically_normal().filename().string();
  const Json& theta = json.at("emulator").at("theta");
  for (const auto& [name, value] : theta.items())
    if (std::none_of(parameters.begin(), parameters.end(), [&, sought = name](const Parameter& p) { return p.name == sought; }))
      refuse(options, fmt::format("the fit in {} sought {}, which is not a parameter of this case", where, name),
             "the smaller model's parameters must be among this one's");
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const Parameter& p = parameters[k];
    if (theta.contains(p.name)) {
      out.theta.push_back(theta.at(p.name));
      continue;
    }
    if (k >= own)
      refuse(options, fmt::format("the fit in {} holds the nuisance {}, which this case samples", where, p.name), "set [emulator] alike in both cases");
    out.theta.push_back(*p.nominal);
    out.held.emplace_back(Eigen::Index(k), *p.nominal);
    out.model.added.push_back(p.name);
  }
  if (out.held.empty())
    refuse(options, where + " holds a fit of all of these parameters", "the smaller model has fewer parameters: this case adds those of what was left out");
  const NetcdfReader file(directory / "map.nc");
  out.history = file.doubles("calibrated");
  return out;
}

void expect_nested(const NestedFit& nested, const RunRecord& record, const MapOptions& options) {
  double apart = 0, size = 0;
  const bool comparable = record.done && record.mean.size() == nested.history.size();
  for (std::size_t i = 0; comparable && i < nested.history.size(); ++i) {
    apart += std::pow(record.mean[i] - nested.history[i], 2);
    size += std::pow(nested.history[i], 2);
  }
  if (!comparable || apart > same_model * same_model * size)
    refuse(
        options,
        fmt::format("this case's model, with the added parameters at their nominal values, is not that of {}: at its answer their histories differ by {:.2g} %",
                    nested.model.name, comparable ? 100 * std::sqrt(apart / size) : 100.0),
        "both cases need the same tables, meshes and --set, and nominal values that switch the mechanism off");
}

}  // namespace calomel
