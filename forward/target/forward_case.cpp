#include "forward/target/forward_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "base/finite_number.hpp"
#include "base/input_file.hpp"
#include "base/json.hpp"
#include "forward/case_number.hpp"
#include "forward/mechanism/correction.hpp"

namespace calomel {

namespace {

/// sensors = "sensors.csv": name,x,y,z,dx,dy,dz,gauge_length.
std::vector<SensorOptions> read_sensor_table(const std::filesystem::path& path) {
  std::ifstream in = input_file("sensors", path);
  const std::string columns = "the columns are name,x,y,z,dx,dy,dz,gauge_length in metres";
  std::vector<SensorOptions> all;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#' || (number == 1 && line.rfind("name", 0) == 0)) continue;
    std::vector<std::string> words;
    std::stringstream cells(line);
    for (std::string w; std::getline(cells, w, ',');) words.push_back(w);
    const auto fail = [&](const std::string& problem) {
      return InputError({.problem = problem, .value = '"' + line + '"', .suggestion = columns, .file = path.string(), .line = number});
    };
    if (words.size() < 7 || words.size() > 8) throw fail(fmt::format("7 or 8 columns are expected, {} given", words.size()));
    SensorOptions s;
    s.name = words[0];
    const auto number_in = [&](std::size_t column) {
      const std::string& word = words[column];
      if (const auto x = finite_number(word.substr(0, word.find_last_not_of(" \t\"") + 1))) return *x;
      throw fail(number == 1 ? "a header begins with name, and a row has numbers behind its name" : "numbers are expected behind the name");
    };
    for (std::size_t k = 0; k < 3; ++k) s.position[k] = number_in(1 + k), s.direction[k] = number_in(4 + k);
    if (words.size() == 8) s.gauge_length = number_in(7);
    if (std::ranges::count(all, s.name, &SensorOptions::name) > 0) throw fail("two sensors have the same name");
    try {
      s.validate();
    } catch (const InputError& e) {
      throw fail(e.parts().problem);
    }
    all.push_back(s);
  }
  if (all.empty()) throw InputError({.problem = "the file lists no sensor", .suggestion = columns, .file = path.string()});
  return all;
}

/// The mechanism that a key names and that the case does not enable; empty where there is none.
std::string mechanism_to_enable(const ForwardCase& c, const std::string& key) {
  const std::string table = "mechanism.";
  if (!key.starts_with(table)) return {};
  const std::string name = key.substr(table.size(), key.find('.', table.size()) - table.size());
  return mechanisms().contains(name) && !c.enables(name) ? name : std::string();
}

/// The number at a dotted path. To be read it is only looked for; to be set, a gauge's own value of a mechanism is made, and a word is the index of its choice.
/// Errors: InputError naming the nearest of the known keys.
template <class Self>
FoundNumber<Self> find_number(Self& self, const std::string& key) {
  std::vector<std::string> known;
  FoundNumber<Self> found;
  const auto look = [&](const std::string& path, auto& options) {
    NumberVisitor v(key.rfind(path + '.', 0) == 0 ? key.substr(path.size() + 1) : "");
    const_cast<std::remove_const_t<std::remove_reference_t<decltype(options)>>&>(options).visit(v);  // a visit that only reads
    for (const auto& k : v.known) known.push_back(path + '.' + k);
    if (v.number || v.optional) found = {v.number, v.optional, v.info};
  };
  ForwardCase::visit_tables(self, look);
  for (auto& s : self.sensors) look("sensor." + s.name, s);
  for (auto& m : self.mechanisms) {
    const std::string path = "mechanism." + m.name + '.';
    bool word = false;  // read, a key of choices is no number
    for (const auto& k : m.entry->keys) {
      if (k.choices.empty())
        known.push_back(path + k.name);
      else
        word = word || (std::is_const_v<Self> && key.ends_with('.' + k.name));
    }
    if (key.rfind(path, 0) != 0 || word) continue;
    const std::string rest = key.substr(path.size());
    const auto dot = rest.rfind('.');
    const bool own = dot != std::string::npos;
    if (own && (!m.entry->per_sensor || std::none_of(self.sensors.begin(), self.sensors.end(), [&](const auto& s) { return s.name == rest.substr(0, dot); })))
      continue;
    found.number = m.values.find(rest);
    for (const auto& k : m.entry->keys)
      if (k.name == rest.substr(own ? dot + 1 : 0)) {
        found.info.unit = k.unit;
        found.info.range = between(k.least, k.greatest);
      }
  }
  if (!found.number && !found.optional) {
    const auto absent = mechanism_to_enable(self, key);
    throw InputError({.problem = "names no number of the case",
                      .value = '"' + key + '"',
                      .suggestion = absent.empty() ? name_suggestion(key, known) : fmt::format("set mechanism.{}.enabled = true", absent)});
  }
  return found;
}

}  // namespace

void ConditionOptions::validate() const {
  if (peak_pressure.has_value() == energy.has_value())
    throw InputError({.problem = "a condition needs either peak_pressure or energy", .key = "name", .value = '"' + name + '"'});
}

ForwardCase ForwardCase::read(CaseFile& file) {
  ForwardCase c;
  CaseName title;
  file.read("case", title);
  c.name = title.name.empty() ? file.path().stem().string() : title.name;
  c.sensor_unit = title.sensor_unit;
  for (const char* required : {"geometry", "load"})
    if (!file.has(required))
      throw file.located(InputError({.problem = fmt::format("the table [{}] is missing", required), .suggestion = "see docs/case_reference.md or examples/"}));
  file.read("geometry", c.geometry);
  c.geometry.folder = file.path().parent_path();
  NoKeys none;
  const std::vector<std::string> materials{"steel", "mercury"};
  file.read("material", none, materials);
  file.read("material.steel", c.steel);
  file.read("material.mercury", c.mercury);
  file.read("load", c.load);
  file.read("time", c.time);
  file.read("solver", c.solver);
  if (c.load.kind == "end_stress") {
    if (c.geometry.kind != "bar" && c.geometry.kind != "mesh")
      throw file.located(InputError({.problem = "an end_stress acts on the end of a bar, or on the faces of geometry.sets.loaded",
                                     .key = "load.kind",
                                     .suggestion = "set geometry.kind = \"bar\" or \"mesh\", or use initial_pressure"}));
    file.locating([&] { c.end_stress = read_history(file.resolve(c.load.file)); });
    for (auto& v : c.end_stress.value) v *= c.load.stress_scale;
  } else if (c.geometry.kind == "bar") {
    throw file.located(InputError({.problem = "a bar holds no mercury to heat", .key = "load.kind", .suggestion = "use kind = \"end_stress\""}));
  }

  if (const auto table = file.text("sensors")) {
    file.accept("sensors");
    file.locating([&] { c.sensors = read_sensor_table(file.resolve(*table)); });
  }
  if (file.has("sensor") && file.count("sensor") == 0)
    throw file.located(InputError({.problem = "sensors are a list of tables",
                                   .key = "sensor",
                                   .suggestion = "write [[sensor]] above each; one of the file named by sensors is changed there"}));
  for (std::size_t i = 0; i < file.count("sensor"); ++i) {
    SensorOptions s;
    file.read(fmt::format("sensor[{}]", i), s);
    c.sensors.push_back(s);
  }
  file.accept("sensor");
  std::set<std::string> names;
  for (std::size_t i = 0; i < c.sensors.size(); ++i)
    if (!names.insert(c.sensors[i].name).second)
      throw file.located(InputError({.problem = "two sensors have the same name",
                                     .key = file.count("sensor") == c.sensors.size() ? fmt::format("sensor[{}].name", i) : "sensors",
                                     .value = '"' + c.sensors[i].name + '"',
                                     .suggestion = "give each sensor its own"}));
  if (c.sensors.empty())
    throw file.located(InputError({.problem = "the case has no sensor", .suggestion = "add [[sensor]] tables with name, position and direction"}));

  for (std::size_t i = 0; i < file.count("condition"); ++i) {
    ConditionOptions condition;
    file.read(fmt::format("condition[{}]", i), condition);
    for (const auto& other : c.conditions)
      if (other.name == condition.name)
        throw file.located(InputError({.problem = "two conditions have the same name", .key = fmt::format("condition[{}].name", i)}));
    c.conditions.push_back(condition);
  }
  if (!c.conditions.empty() && c.load.kind == "end_stress")
    throw file.located(InputError({.problem = "a condition is another strength of the pulse, and a measured stress on the end has its own",
                                   .key = "condition[0].name",
                                   .value = '"' + c.conditions[0].name + '"',
                                   .suggestion = "make a case of each record, with a file of records of its own"}));
  file.accept("condition");
  std::vector<std::string> sensor_names(names.begin(), names.end());
  auto mechanism_tables = read_mechanisms(file, sensor_names);
  c.mechanisms = std::move(mechanism_tables.enabled);
  c.listed_mechanisms = std::move(mechanism_tables.listed);
  c.notes = std::move(mechanism_tables.notes);
  c.parameters = read_parameters(file, "material.mercury");
  const double low = (1 - gruneisen_reach) * c.mercury.sound_speed, high = (1 + gruneisen_reach) * c.mercury.sound_speed;
  if (c.load.policy == "gruneisen")
    for (const auto& p : c.parameters)
      if (p.key == "material.mercury.sound_speed" && (p.min < low || p.max > high))
        c.notes.push_back(
            fmt::format("load.policy = \"gruneisen\" holds for a sound speed of {:.5g} to {:.5g} m/s, within 15 % of nominal: runs outside of it fail, "
                        "and [parameter.{}] goes from {} to {}",
                        low, high, p.name, number_text(p.min), number_text(p.max)));
  bind_parameters(file, c.parameters, [&](const Parameter& p) {
    const double value = c.number(p.key);
    return p.key.starts_with("mechanism.") && std::abs(value) == anywhere ? std::clamp(value, p.min, p.max)
                                                                          : value;  // an end that a wall's stretch has nowhere
  });
  for (auto& p : c.parameters) take_over(file, p, c.about(p.key));
  return c;
}

double ForwardCase::number(const std::string& key) const {
  const auto v = find_number(*this, key);
  if (v.number && std::isnan(*v.number))  // a mechanism's key that follows another number
    for (const auto& m : mechanisms)
      for (const auto& k : m.entry->keys)
        if (!k.off_at.empty() && key.starts_with("mechanism." + m.name + '.') && key.ends_with('.' + k.name)) return number(k.off_at);
  return v.value(key);
}

FieldInfo ForwardCase::about(const std::string& key) const { return find_number(*this, key).info; }

void ForwardCase::set_number(const std::string& key, double value) { find_number(*this, key).set(value); }

ForwardCase ForwardCase::at(std::span<const double> theta) const {
  expect(theta.size() == parameters.size(), "one value for each parameter");
  ForwardCase c = *this;
  for (std::size_t i = 0; i < theta.size(); ++i) c.set_number(parameters[i].key, theta[i]);
  return c;
}

bool ForwardCase::enables(const std::string& mechanism) const {
  return std::any_of(mechanisms.begin(), mechanisms.end(), [&](const auto& m) { return m.name == mechanism; });
}

std::vector<EnabledMechanism> ForwardCase::active_mechanisms() const {
  std::vector<EnabledMechanism> active;
  for (EnabledMechanism m : mechanisms) {
    for (const auto& k : m.entry->keys)
      if (std::isnan(m.values[k.name])) *m.values.find(k.name) = off_value(k);
    if (!m.off([this](const MechanismKey& k) { return off_value(k); })) active.push_back(std::move(m));
  }
  return active;
}

Json ForwardCase::echo() const {
  Json j;
  j["case"] = {{"sensor_unit", sensor_unit}};
  visit_tables(*this, [&](const std::string& path, const auto& options) {
    const auto dot = path.find('.');
    (dot == std::string::npos ? j[path] : j[path.substr(0, dot)][path.substr(dot + 1)]) = calomel::echo(options);
  });
  for (const auto& s : sensors) j["sensor"].push_back(calomel::echo(s));
  for (const auto& s : conditions) j["condition"].push_back(calomel::echo(s));
  for (const auto& p : parameters) j["parameter"][p.name] = calomel::echo(p);
  for (const auto& m : mechanisms)
    for (const auto* values : {&m.values.common(), &m.values.by_sensor()})
      for (const auto& [name, own] : *values) {
        const auto key = std::find_if(m.entry->keys.begin(), m.entry->keys.end(), [&](const auto& k) { return k.name == name && !k.choices.empty(); });
        if (key != m.entry->keys.end()) {
          j["mechanism"][m.name][name] = key->choices.at(std::size_t(own));
          continue;
        }
        const double value = std::isnan(own) ? number("mechanism." + m.name + '.' + name) : own;
        j["mechanism"][m.name][name] = std::isfinite(value) ? Json(value) : Json("none");
      }
  return j;
}

}  // namespace calomel
