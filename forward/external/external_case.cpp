#include "forward/external/external_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/json.hpp"
#include "forward/simulation/case_tables.hpp"

namespace calomel {

namespace {

constexpr double widest_gain = 0.15;  ///< about 1, and its change over the record, of a gauge that does not read true

/// A parameter of a mechanism: that of any other, and the value that switches it off.
struct MechanismParameter {
  Parameter parameter;
  double off = 0;
  template <class V>
  void visit(V& v) {
    parameter.visit(v);
    v("off", off, {.doc = "value at which the mechanism does nothing", .required = true});
  }
};

struct MechanismSwitch {
  bool enabled = false;
  template <class V>
  void visit(V& v) {
    v("enabled", enabled, {.doc = "part of the base model: its parameters are fitted like any other"});
  }
};

ExternalMechanism read_mechanism(CaseFile& file, const std::string& name) {
  const std::string path = "mechanism." + name;
  ExternalMechanism m{.name = name};
  MechanismSwitch on;
  const std::vector<std::string> others{"parameter"};
  file.read(path, on, others);
  m.enabled = on.enabled;
  for (const auto& p : file.names(path + ".parameter")) {
    const std::string at = path + ".parameter." + p;
    MechanismParameter one;
    file.read(at, one);
    one.parameter.name = name + '.' + p;
    one.parameter.key = at;
    if (!(one.parameter.min < one.parameter.max))
      throw file.located(InputError({.problem = "the upper bound must exceed the lower one, min = " + number_text(one.parameter.min),
                                     .key = at + ".max",
                                     .value = number_text(one.parameter.max)}));
    if (!one.parameter.nominal) one.parameter.nominal = one.off;
    one.parameter.min = std::min(one.parameter.min, one.off);
    one.parameter.max = std::max(one.parameter.max, one.off);
    try {
      one.parameter.validate();
    } catch (const InputError& e) {
      auto parts = e.parts();
      parts.key = at + '.' + parts.key;
      throw file.located(InputError(parts));
    }
    m.parameters.push_back(std::move(one.parameter));
    m.off.push_back(one.off);
  }
  if (m.parameters.empty())
    throw file.located(InputError({.problem = "a mechanism of an external model is a group of its inputs, and this group is empty",
                                   .key = path,
                                   .suggestion = fmt::format("add [{}.parameter.NAME] with off, min and max", path)}));
  return m;
}

/// P of a parameter that is called "NAME.P".
std::string short_name(const ExternalMechanism& m, std::size_t i) { return m.parameters[i].name.substr(m.name.size() + 1); }

/// `model.config`, which is handed on as it is. Errors: InputError where it is no table.
Json read_config(const CaseFile& file) {
  Json config = file.json("model.config");
  if (!config.is_object())
    throw file.located(InputError({.problem = "UM-Bridge's config is a table",
                                   .key = "model.config",
                                   .value = config.dump().substr(0, 40),
                                   .suggestion = "e.g. config = { level = 2 }"}));
  return config;
}

/// Values at which the effect of a number is first looked at: small, middling and great by its prior.
std::vector<double> strengths_of(const Parameter& p, double off) {
  std::vector<double> out;
  const auto put = [&](double x) {
    if (x != off && x >= p.min && x <= p.max && std::find(out.begin(), out.end(), x) == out.end()) out.push_back(x);
  };
  if (p.prior == "half_cauchy")
    for (const double part : {0.3, 1.0, 3.0}) put(part * *p.scale);
  else if (p.prior == "lognormal")
    for (const double z : {-1.0, 0.0, 1.0}) put(std::exp(*p.mu + z * *p.sigma));
  else if (p.prior == "normal" || p.prior == "truncated_normal")
    for (const double z : {-1.0, 0.0, 1.0}) put(*p.mean + z * *p.sd);
  if (!out.empty()) return out;
  for (const double part : {0.02, 0.1, 0.4}) put(off + part * (p.max - off)), put(off + part * (p.min - off));
  return out;
}

}  // namespace

ExternalCase ExternalCase::read(CaseFile& file) {
  ExternalCase c;
  CaseName title;
  file.read("case", title);
  c.name = title.name.empty() ? file.path().stem().string() : title.name;
  c.unit = title.sensor_unit;
  ServerOptions server;
  const std::vector<std::string> config{"config"};
  file.read("model", server, config);
  c.server = {.url = server.url, .name = server.name, .timeout = server.timeout, .retries = server.retries, .pause = server.pause, .config = read_config(file)};
  if (!file.has("output"))
    throw file.located(
        InputError({.problem = "the table [output], which describes the model's first output block, is missing",
                    .key = "model.kind",
                    .suggestion = "add [output] with sensors = [\"A\"] and time = { start = 0.0, step = 1e-3, count = 40 }, or kind = \"log_density\""}));
  const std::vector<std::string> time{"time"};
  file.read("output", c.output, time);
  if (c.is_log_density()) {
    for (const char* of_records : {"output.sensors", "output.time"})
      if (file.has(of_records)) throw file.located(InputError({.problem = "a log density has no records", .key = of_records, .suggestion = "take it out"}));
    if (file.has("recordings"))
      throw file.located(InputError({.problem = "a log density holds its own data", .key = "recordings", .suggestion = "take the table out"}));
    c.output.sensors = {"log_density"};
    c.time = {.start = 0, .step = 1, .count = 1};
  } else {
    if (!file.has("output.time"))
      throw file.located(InputError(
          {.problem = "the times of the records are missing", .key = "output", .suggestion = "add time = { start = 0.0, step = 1e-3, count = 40 }"}));
    file.read("output.time", c.time);
    if (c.output.sensors.empty())
      throw file.located(InputError({.problem = "the names of the recorded quantities are missing", .key = "output", .suggestion = "add sensors = [\"A\"]"}));
    std::set<std::string> names;
    for (const auto& s : c.output.sensors)
      if (!names.insert(s).second)
        throw file.located(
            InputError({.problem = "two sensors have the same name", .key = "output.sensors", .value = '"' + s + '"', .suggestion = "give each its own"}));
  }
  c.parameters = read_parameters(file, "parameter");
  for (const auto& p : c.parameters)
    if (file.has("parameter." + p.name + ".key"))
      throw file.located(InputError(
          {.problem = "the inputs of an external model have no key, only their order", .key = "parameter." + p.name + ".key", .suggestion = "take it out"}));
  bind_parameters(file, c.parameters, [](const Parameter& p) -> double {
    if (p.nominal) return *p.nominal;
    if (p.prior == "normal" || p.prior == "truncated_normal") return p.mean ? *p.mean : 0.5 * (p.min + p.max);
    if (p.prior == "lognormal" && p.mu) return std::exp(*p.mu);
    return 0.5 * (p.min + p.max);
  });
  c.own = c.parameters.size();
  if (c.parameters.empty())
    throw file.located(InputError({.problem = "the case has no parameter",
                                   .key = "model.kind",
                                   .suggestion = "add [parameter.NAME] tables with min and max, in the order of the model's inputs"}));
  for (const auto& name : file.names("mechanism")) {
    c.mechanisms.push_back(read_mechanism(file, name));
    const auto& m = c.mechanisms.back();
    if (m.enabled) c.parameters.insert(c.parameters.end(), m.parameters.begin(), m.parameters.end());
  }
  file.accept("mechanism");
  return c;
}

std::size_t ExternalCase::inputs() const {
  std::size_t n = own;
  for (const auto& m : mechanisms) n += m.parameters.size();
  return n;
}

Json ExternalCase::echo() const {
  Json j;
  j["model"] = {{"kind", "umbridge"}, {"url", server.url}, {"name", server.name}, {"config", server.config}};
  j["case"] = {{"sensor_unit", unit}};
  j["output"] = calomel::echo(output);
  if (!is_log_density()) j["output"]["time"] = calomel::echo(time);
  for (std::size_t i = 0; i < own; ++i) j["parameter"][parameters[i].name] = calomel::echo(parameters[i]);
  for (const auto& m : mechanisms) {
    j["mechanism"][m.name]["enabled"] = m.enabled;
    for (std::size_t i = 0; i < m.parameters.size(); ++i) {
      Json& p = j["mechanism"][m.name]["parameter"][short_name(m, i)];
      p = calomel::echo(m.parameters[i]);
      p["off"] = m.off[i];
    }
  }
  return j;
}

Json ExternalCase::model_options() const {
  Json j = echo();
  j["model"].erase("url");
  j["parameter"] = Json::object();
  for (const auto& p : parameters) {  // those of the mechanisms that are enabled among them, as a design sees them
    j["parameter"][p.name] = {{"min", p.min}, {"max", p.max}};
    if (p.nominal) j["parameter"][p.name]["nominal"] = *p.nominal;
  }
  Json order = Json::array(), off = Json::object();
  for (std::size_t i = 0; i < own; ++i) order.push_back(parameters[i].name);
  for (const auto& m : mechanisms)
    for (std::size_t i = 0; i < m.parameters.size(); ++i) order.push_back(m.parameters[i].key), off[m.parameters[i].key] = m.off[i];
  j.erase("mechanism");
  j["inputs"] = std::move(order);
  j["off"] = std::move(off);
  return j;
}

std::vector<ParameterGroup> offered_groups(const ExternalCase& external) {
  std::vector<ParameterGroup> groups;
  for (const auto& m : external.mechanisms) {
    if (m.enabled) continue;
    ParameterGroup g{.name = m.name};
    for (std::size_t i = 0; i < m.parameters.size(); ++i) {
      AddedParameter a{.parameter = m.parameters[i]};
      a.parameter.nominal = m.off[i];
      a.strengths = strengths_of(a.parameter, m.off[i]);
      g.added.push_back(std::move(a));
    }
    groups.push_back(std::move(g));
  }
  const bool own = std::any_of(external.mechanisms.begin(), external.mechanisms.end(), [](const auto& m) { return m.name == "sensor_response"; });
  if (own || external.output.sensors.size() < 2) return groups;
  for (const auto& sensor : external.output.sensors) {
    AddedParameter gain, drift;
    gain.parameter = {.name = reading_gain, .key = reading_gain + '.' + sensor, .min = 1 - widest_gain, .max = 1 + widest_gain};
    gain.parameter.nominal = 1;
    gain.strengths = {1.1};
    gain.doc = "reading per true value";
    drift.parameter = {.name = reading_drift, .key = reading_drift + '.' + sensor, .min = -widest_gain, .max = widest_gain};
    drift.parameter.nominal = 0;
    drift.strengths = {0.1};
    drift.doc = "by which the gain rises over the record";
    groups.push_back({.name = "sensor_response",
                      .place = sensor,
                      .added = {gain, drift},
                      .sensor = sensor,
                      .plain = "the response of the gauges",
                      .check = "check the calibration of the gauges"});
  }
  return groups;
}

}  // namespace calomel
