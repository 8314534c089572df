#include "forward/line/line_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/json.hpp"
#include "forward/case_number.hpp"

namespace calomel {

namespace {

const std::vector<std::pair<std::string, double>> pressure_units{{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"bar", 1e5}};

/// `kind` alone, to know which [line] it is; its other keys are read with that.
struct LineKind {
  std::string kind;
  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "the kind of line", .required = true, .choices = {"bar", "pipe"}});
  }
};

/// The number at a dotted path, or the optional one. Errors: InputError naming the nearest of the known keys.
FoundNumber<LineCase> find_number(LineCase& self, const std::string& key) {
  std::vector<std::string> known;
  FoundNumber<LineCase> found;
  const auto look = [&](const std::string& path, auto& options) {
    NumberVisitor v(key.rfind(path + '.', 0) == 0 ? key.substr(path.size() + 1) : "");
    options.visit(v);
    for (const auto& k : v.known) known.push_back(path + '.' + k);
    if (v.number || v.optional) found = {v.number, v.optional, v.info};
  };
  LineCase::visit_tables(self, look);
  for (auto& s : self.stations) look("station." + s.name, s);
  for (auto& m : self.mechanisms) {
    const std::string path = "mechanism." + m.name + '.';
    for (const auto& k : m.entry->keys) known.push_back(path + k.name);
    if (key.rfind(path, 0) != 0) continue;
    const std::string rest = key.substr(path.size());
    const auto dot = rest.rfind('.');
    if (dot != std::string::npos &&
        (!m.entry->per_station || std::none_of(self.stations.begin(), self.stations.end(), [&](const auto& s) { return s.name == rest.substr(0, dot); })))
      continue;
    found.number = m.values.find(rest);
  }
  if (!found.number && !found.optional)
    throw InputError({.problem = "names no number of the case", .value = '"' + key + '"', .suggestion = name_suggestion(key, known)});
  return found;
}

void read_stations(CaseFile& file, LineCase& c) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < file.count("station"); ++i) {
    const std::string path = fmt::format("station[{}]", i);
    StationOptions s;
    file.read(path, s);
    if (!names.insert(s.name).second)
      throw file.located(InputError({.problem = "two stations have the same name", .key = path + ".name", .suggestion = "give each station its own"}));
    if (c.kind == "pipe" && s.distance > c.pipe.length)
      throw file.located(
          InputError({.problem = "a station of a pipe lies on it", .key = path + ".distance", .range = fmt::format("0 to {} m", number_text(c.pipe.length))}));
    c.stations.push_back(s);
  }
  file.accept("station");
  if (c.stations.empty()) throw file.located(InputError({.problem = "the case has no station", .suggestion = "add [[station]] tables with name and distance"}));
}

void read_unit(CaseFile& file, LineCase& c) {
  CaseName title;
  file.read("case", title);
  c.name = title.name.empty() ? file.path().stem().string() : title.name;
  c.unit = title.sensor_unit;
  if (c.kind == "bar") return;
  if (!file.has("case.sensor_unit")) c.unit = "Pa";
  const auto unit = std::find_if(pressure_units.begin(), pressure_units.end(), [&](const auto& u) { return u.first == c.unit; });
  if (unit == pressure_units.end()) {
    std::vector<std::string> known;
    for (const auto& u : pressure_units) known.push_back(u.first);
    throw file.located(
        InputError({.problem = "the readings of a pipe are pressures", .key = "case.sensor_unit", .value = '"' + c.unit + '"', .range = join(known)}));
  }
  c.pascals_per_unit = unit->second;
}

void read_bound_parameters(CaseFile& file, LineCase& c) {
  c.parameters = read_parameters(file, "line");
  bind_parameters(file, c.parameters, [&](const Parameter& p) {
    for (const auto& m : c.mechanisms)
      if (p.key.starts_with("mechanism." + m.name + '.') && !m.enabled)
        throw InputError(
            {.problem = "this mechanism is not part of the model", .value = '"' + p.key + '"', .suggestion = "set mechanism." + m.name + ".enabled = true"});
    return c.number(p.key);
  });
  for (auto& p : c.parameters) take_over(file, p, find_number(c, p.key).info);
}

}  // namespace

LineCase LineCase::read(CaseFile& file) {
  LineCase c;
  LineKind line;
  if (!file.has("line"))
    throw file.located(InputError(
        {.problem = "the table [line] is missing", .key = "model.kind", .suggestion = "add [line] with kind = \"bar\" or \"pipe\", see docs/theory/line.md"}));
  // The kind decides which keys are known; a wrong kind is reported before them.
  const std::vector<std::string> any_key = file.names("line");
  file.read("line", line, any_key);
  c.kind = line.kind;
  if (c.kind == "bar")
    file.read("line", c.bar);
  else
    file.read("line", c.pipe);
  read_unit(file, c);
  file.read("time", c.time);
  read_stations(file, c);
  if (c.kind == "bar") {
    if (!file.has("drive"))
      throw file.located(InputError(
          {.problem = "the table [drive] is missing: what passes a bar's first gauge", .key = "line.kind", .suggestion = "add [drive] with file = ..."}));
    file.read("drive", c.drive);
    file.locating([&] { c.record = read_drive(file.resolve(c.drive.file), c.drive); });
    double known = std::numeric_limits<double>::infinity();
    for (const auto& s : c.stations) known = std::min(known, c.record.end() + s.distance / c.bar.wave_speed + s.delay);
    if (c.time.end > known + 0.5 * c.record.interval)
      throw file.located(InputError({.problem = "the record that drives the bar does not reach that far at every station",
                                     .key = "time.end",
                                     .value = number_text(c.time.end),
                                     .range = fmt::format("at most {} s", number_text(known))}));
  } else if (file.has("drive")) {
    throw file.located(InputError(
        {.problem = "a pipe is driven by its valve, not by a record", .key = "drive", .suggestion = "take the table out, or set line.kind = \"bar\""}));
  }
  std::vector<std::string> names;
  for (const auto& s : c.stations) names.push_back(s.name);
  c.mechanisms = read_line_mechanisms(file, line_mechanisms(c.kind), names);
  for (const auto& m : c.mechanisms)
    if (m.enabled && !c.has_what_it_needs(m))
      throw file.located(
          InputError({.problem = "this mechanism needs " + m.entry->needs, .key = "mechanism." + m.name + ".enabled", .suggestion = "set " + m.entry->needs}));
  read_bound_parameters(file, c);
  return c;
}

double LineCase::number(const std::string& key) const {
  LineCase looked_at = *this;  // a station's own value of a mechanism is made where it is first named
  return find_number(looked_at, key).value(key);
}

void LineCase::set_number(const std::string& key, double value) { find_number(*this, key).set(value); }

LineCase LineCase::at(std::span<const double> theta) const {
  expect(theta.size() == parameters.size(), "one value for each parameter");
  LineCase c = *this;
  for (std::size_t i = 0; i < theta.size(); ++i) c.set_number(parameters[i].key, theta[i]);
  return c;
}

bool LineCase::has_what_it_needs(const LineMechanism& mechanism) const {
  if (mechanism.entry->needs.empty()) return true;
  LineCase looked_at = *this;
  const auto v = find_number(looked_at, mechanism.entry->needs);
  return v.number || v.optional->has_value();
}

double LineCase::friction_factor() const {
  const double reynolds = pipe.viscosity > 0 ? pipe.density * pipe.velocity * pipe.diameter / pipe.viscosity : 0;
  return pipe.friction_factor ? *pipe.friction_factor : haaland(reynolds, pipe.roughness);
}

Json LineCase::echo() const {
  Json j;
  j["model"] = {{"kind", "line"}};
  j["case"] = {{"sensor_unit", unit}};
  visit_tables(*this, [&](const std::string& path, const auto& options) { j[path] = calomel::echo(options); });
  for (const auto& s : stations) j["station"].push_back(calomel::echo(s));
  for (const auto& p : parameters) j["parameter"][p.name] = calomel::echo(p);
  for (const auto& m : mechanisms)
    if (m.enabled)
      for (const auto* values : {&m.values.common(), &m.values.by_sensor()})
        for (const auto& [key, value] : *values) j["mechanism"][m.name][key] = std::isfinite(value) ? Json(value) : Json("none");
  return j;
}

}  // namespace calomel
