#include "forward/mechanism/mechanism.hpp"

#include <algorithm>

#include "base/artefact.hpp"

namespace calomel {

double* MechanismValues::find(const std::string& path) {
  const auto common = common_.find(path);
  if (common != common_.end()) return &common->second;
  const auto dot = path.rfind('.');
  if (dot == std::string::npos) return nullptr;
  const auto key = common_.find(path.substr(dot + 1));
  return key == common_.end() ? nullptr : &by_sensor_.try_emplace(path, key->second).first->second;
}

const double* MechanismValues::find(const std::string& path) const {
  const auto own = by_sensor_.find(path);
  if (own != by_sensor_.end()) return &own->second;
  const auto dot = path.rfind('.');
  const auto common = common_.find(dot == std::string::npos ? path : path.substr(dot + 1));
  return common == common_.end() ? nullptr : &common->second;
}

bool EnabledMechanism::off(const std::function<double(const MechanismKey&)>& off_value) const {
  return std::all_of(entry->keys.begin(), entry->keys.end(), [&](const MechanismKey& k) {
    if (!k.decides) return true;
    const double off = off_value(k);
    if (values[k.name] != off) return false;
    return std::all_of(values.by_sensor().begin(), values.by_sensor().end(),
                       [&](const auto& own) { return !own.first.ends_with('.' + k.name) || own.second == off; });
  });
}

namespace {

/// One table of keys, as the case file's reader visits it.
struct KeyTable {
  const std::vector<MechanismKey>& keys;
  std::string prefix;  ///< "SENSOR." for a gauge's own
  MechanismValues& values;
  bool* enabled;
  template <class V>
  void visit(V& v) {
    if (enabled) v("enabled", *enabled, {.doc = "part of the base model"});
    for (const auto& k : keys) {
      double& value = *values.find(prefix + k.name);
      if (k.choices.empty()) {
        v(k.name.c_str(), value, {.unit = k.unit, .range = between(k.least, k.greatest), .doc = k.doc});
        continue;
      }
      std::string word = k.choices.at(std::size_t(value));
      v(k.name.c_str(), word, {.doc = k.doc, .choices = k.choices});
      value = double(std::find(k.choices.begin(), k.choices.end(), word) - k.choices.begin());
    }
  }
};

const MechanismEntry& entry_of(const CaseFile& file, const std::string& name, const std::string& path) {
  return *file.locating([&] {
    try {
      return &mechanisms().get(name, path);
    } catch (const InputError& e) {
      auto parts = e.parts();
      parts.value.clear();
      throw InputError(parts);
    }
  });
}

/// Names of the gauges that have a table below `path`. Errors: InputError when a table names no sensor.
std::vector<std::string> gauge_tables(const CaseFile& file, const std::string& path, std::span<const std::string> sensors) {
  std::vector<std::string> gauges;
  for (const auto& name : file.names(path)) {
    if (file.names(path + '.' + name).empty()) continue;  // a number, not a table
    if (std::find(sensors.begin(), sensors.end(), name) == sensors.end())
      throw file.located(InputError({.problem = "names no sensor of the case", .key = path + '.' + name, .suggestion = name_suggestion(name, sensors)}));
    gauges.push_back(name);
  }
  return gauges;
}

}  // namespace

MechanismTable read_mechanism_table(CaseFile& file, const std::string& name, const std::vector<MechanismKey>& keys, bool per_sensor,
                                    std::span<const std::string> sensors, std::vector<std::string> extra) {
  const std::string path = "mechanism." + name;
  if (file.has(path + ".parameter"))
    throw file.located(InputError(
        {.problem = "only an external model has its mechanisms' numbers here",
         .key = path + ".parameter",
         .suggestion = fmt::format("to fit a number write [parameter.NAME] with key = \"{}.{}\", min and max", path, keys.empty() ? "KEY" : keys[0].name)}));
  MechanismTable table{.values = MechanismValues(keys)};
  const std::vector<std::string> gauges = per_sensor ? gauge_tables(file, path, sensors) : std::vector<std::string>{};
  extra.insert(extra.end(), gauges.begin(), gauges.end());
  KeyTable common{keys, "", table.values, &table.enabled};
  file.read(path, common, extra);
  for (const auto& gauge : gauges) {
    KeyTable own{keys, gauge + '.', table.values, nullptr};
    file.read(path + '.' + gauge, own);
    for (const auto& k : keys)
      if (!file.has(path + '.' + gauge + '.' + k.name)) table.values.forget(gauge + '.' + k.name);
  }
  return table;
}

MechanismTables read_mechanisms(CaseFile& file, std::span<const std::string> sensors) {
  MechanismTables tables;
  file.accept("mechanism");
  for (const auto& name : file.names("mechanism")) {
    const std::string path = "mechanism." + name;
    const MechanismEntry& entry = entry_of(file, name, path);
    tables.listed.push_back(name);
    auto [values, enabled] = read_mechanism_table(file, name, entry.keys, entry.per_sensor, sensors);
    EnabledMechanism mechanism{name, &entry, std::move(values)};
    if (enabled && !entry.built())
      throw file.located(InputError({.problem = "this mechanism is not built yet in this version, so it cannot be enabled",
                                     .key = path + ".enabled",
                                     .value = "true",
                                     .suggestion = "remove the line; a listed mechanism without it is accepted"}));
    if (!entry.built())
      tables.notes.push_back("mechanism." + name + ": not built yet, not offered");
    else if (enabled)
      tables.enabled.push_back(std::move(mechanism));
  }
  return tables;
}

}  // namespace calomel
