#include "forward/campaign/repeatability_floor.hpp"

#include <algorithm>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"

namespace calomel {

namespace {

InputError no_floor(const Json::exception& e) {
  return InputError(
      {.problem = std::string("is no repeatability floor: ") + e.what(), .suggestion = "measure it again: calomel check --floor", .file = "floor.json"});
}

}  // namespace

void FloorOptions::validate() const {
  if (single_runs == 1)
    throw InputError({.problem = "one run has no scatter", .key = "single_runs", .value = "1", .suggestion = "2 or more, or 0 to leave them out"});
}

Json floor_json(const RepeatabilityFloor& floor) {
  Json j;
  j["mean"] = floor.mean;
  j["worst"] = floor.worst;
  j["members"] = Json::array();
  for (const auto& m : floor.members)
    j["members"].push_back({{"viscosity_factor", m.viscosity_factor}, {"energy_shift", m.energy_shift}, {"ok", m.ok}, {"message", m.message}});
  j["window_begin_s"] = floor.window_begin;
  j["window_end_s"] = floor.window_end;
  j["sensors"] = Json::array();
  j["comparisons"] = Json::array();
  const std::size_t windows = floor.window_begin.size();
  const auto each_record = [&](auto&& f) {
    for (std::size_t c = 0, row = 0; c < floor.conditions.size(); ++c)
      for (std::size_t s = 0; s < floor.sensors.size(); ++s, ++row) f(Json{{"condition", floor.conditions[c]}, {"name", floor.sensors[s]}}, row);
  };
  each_record([&](Json record, std::size_t row) {
    const auto first = std::ptrdiff_t(row * windows), last = std::ptrdiff_t((row + 1) * windows);
    record["relative"] = floor.relative[row];
    record["sd"] = std::vector<double>(floor.sd.begin() + first, floor.sd.begin() + last);
    record["signal"] = std::vector<double>(floor.signal.begin() + first, floor.signal.begin() + last);
    j["sensors"].push_back(std::move(record));
  });
  for (const auto& c : floor.comparisons) {
    Json comparison{{"name", c.name}, {"what", c.what}, {"message", c.message}};
    if (!c.relative.empty()) {
      comparison["mean"] = c.mean;
      comparison["worst"] = c.worst;
      each_record([&](Json record, std::size_t row) {
        record["relative"] = c.relative[row];
        comparison["sensors"].push_back(std::move(record));
      });
    }
    j["comparisons"].push_back(std::move(comparison));
  }
  return j;
}

RepeatabilityFloor read_floor(const Json& json) try {
  RepeatabilityFloor floor;
  floor.mean = json.at("mean");
  floor.worst = json.at("worst");
  for (const auto& m : json.at("members")) floor.members.push_back({m.at("viscosity_factor"), m.at("energy_shift"), m.at("ok"), m.at("message")});
  floor.window_begin = json.at("window_begin_s").get<std::vector<double>>();
  floor.window_end = json.at("window_end_s").get<std::vector<double>>();
  for (const auto& row : json.at("sensors")) {
    for (auto [list, name] : {std::pair{&floor.conditions, row.at("condition").get<std::string>()}, {&floor.sensors, row.at("name").get<std::string>()}})
      if (std::find(list->begin(), list->end(), name) == list->end()) list->push_back(name);
    floor.relative.push_back(row.at("relative"));
    for (auto [list, key] : {std::pair{&floor.sd, "sd"}, {&floor.signal, "signal"}})
      for (const auto& x : row.at(key)) list->push_back(x);
  }
  for (const auto& c : json.value("comparisons", Json::array())) {
    FloorComparison comparison{
        .name = c.at("name"), .what = c.at("what"), .message = c.at("message"), .relative = {}, .mean = c.value("mean", 0.0), .worst = c.value("worst", 0.0)};
    for (const auto& row : c.value("sensors", Json::array())) comparison.relative.push_back(row.at("relative"));
    floor.comparisons.push_back(std::move(comparison));
  }
  return floor;
} catch (const Json::exception& e) {
  throw no_floor(e);
}

void write_floor(NetcdfWriter& file, const RepeatabilityFloor& floor, const std::string& units) {
  file.dimension("window", floor.window_begin.size());
  file.variable("window_begin", {"window"}, floor.window_begin, {{"units", "s"}});
  file.variable("window_end", {"window"}, floor.window_end, {{"units", "s"}});
  std::vector<std::string> dims{"sensor"};
  if (floor.conditions.size() > 1) dims.insert(dims.begin(), "condition");
  file.variable("floor_relative", dims, floor.relative, {{"units", "1"}, {"long_name", "repeatability floor over the signal, whole record"}});
  for (const auto& c : floor.comparisons)
    if (!c.relative.empty()) file.variable("floor_" + c.name, dims, c.relative, {{"units", "1"}, {"long_name", c.what}});
  dims.push_back("window");
  file.variable("floor_sd", dims, floor.sd, {{"units", units}, {"long_name", "repeatability floor: standard deviation of the ensemble mean over the jitters"}});
  file.variable("floor_signal", dims, floor.signal, {{"units", units}, {"long_name", "root mean square of the mean over the jitters"}});
}

}  // namespace calomel
