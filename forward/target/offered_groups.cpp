#include "forward/target/offered_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "forward/mechanism/added_number.hpp"
#include "forward/mechanism/correction.hpp"
#include "forward/mechanism/mechanism.hpp"
#include "forward/mesh/mesh.hpp"
#include "forward/target/forward_case.hpp"

namespace calomel {

namespace {

/// A key that shapes what the mechanism looks like.
AddedParameter shape_of(const std::string& mechanism, const MechanismKey& k) {
  AddedParameter a;
  Parameter& p = a.parameter;
  p.name = mechanism + '.' + k.name;
  p.key = "mechanism." + p.name;
  p.min = k.low;
  p.max = k.high;
  p.nominal = k.off;
  const double ratio = std::log(k.high / k.low);
  p.prior = "lognormal";
  p.mu = 0.5 * std::log(k.high * k.low);
  p.sigma = ratio / 4;
  for (const double part : {1.0 / 6, 0.5, 5.0 / 6}) a.strengths.push_back(k.low * std::exp(part * ratio));
  a.unit = k.unit;
  a.doc = k.doc;
  return a;
}

/// Where a stretch begins or ends: examined first at its given place.
AddedParameter place_of(const std::string& mechanism, const std::string& key, double low, double at, double high, double sd) {
  AddedParameter a;
  Parameter& p = a.parameter;
  p.name = mechanism + '.' + key;
  p.key = "mechanism." + p.name;
  p.min = low;
  p.max = high;
  p.nominal = at;
  p.prior = "truncated_normal";
  p.mean = at;
  p.sd = sd;
  a.unit = "m";
  a.doc = "where the stretch " + key + 's';
  return a;
}

/// Stretches of a wall of this length: the whole, and quarters half a quarter apart.
std::vector<std::pair<double, double>> stretches(std::optional<double> length) {
  std::vector<std::pair<double, double>> all{{-anywhere, anywhere}};
  if (length)
    for (int i = 0; i + 2 <= 8; ++i) all.emplace_back(i * *length / 8, (i + 2) * *length / 8);
  return all;
}

/// The words for a mechanism's laws; one without any has one law without a word.
std::vector<std::string> laws_of(const MechanismEntry& entry) {
  std::vector<std::string> laws;
  for (const auto& k : entry.keys)
    if (!k.law.empty() && std::find(laws.begin(), laws.end(), k.law) == laws.end()) laws.push_back(k.law);
  return laws.empty() ? std::vector<std::string>{""} : laws;
}

/// A mechanism of a wall at each of the walls that there are, and on stretches of them; another as it is.
void add_at_each_wall(std::vector<ParameterGroup>& groups, ParameterGroup group, const MechanismEntry& entry, const ForwardCase& c) {
  const auto word = std::find_if(entry.keys.begin(), entry.keys.end(), [](const auto& k) { return !k.choices.empty(); });
  if (word == entry.keys.end()) {
    groups.push_back(std::move(group));
    return;
  }
  const std::string prefix = "mechanism." + group.name + '.';
  const bool has_stretch = std::any_of(entry.keys.begin(), entry.keys.end(), [](const auto& k) { return k.name == "begin"; });
  for (std::size_t i = 0; i < word->choices.size(); ++i) {
    if (!c.geometry.has_wall(word->choices[i])) continue;
    const bool upright = word->choices[i] == "front" || word->choices[i] == "rear";
    const auto length = c.geometry.kind == "box" && has_stretch ? (upright ? c.geometry.height : c.geometry.length) : std::nullopt;
    for (const auto& [begin, end] : stretches(length)) {
      ParameterGroup one = group;
      one.place = word->choices[i];
      one.part = end < anywhere;
      for (auto& a : one.added) a.with = {{prefix + word->name, double(i)}};
      if (length) {  // its ends are likeliest where they are looked at first, and may lie anywhere that leaves its middle within
        const double from = one.part ? begin : 0, to = one.part ? end : *length, reach = one.part ? 0.25 * (to - from) : 0.125 * *length,
                     middle = 0.5 * (from + to), least = 0.25 * reach;
        one.shapes.push_back(place_of(group.name, "begin", 0, from, middle - least, reach)),
            one.shapes.push_back(place_of(group.name, "end", middle + least, to, *length, reach));
      }
      if (one.part) {
        one.place += fmt::format(", {:.3g} to {:.3g} mm", 1e3 * begin, 1e3 * end);
        for (auto& a : one.added) a.with.insert(a.with.end(), {{prefix + "begin", begin}, {prefix + "end", end}});
      }
      groups.push_back(std::move(one));
    }
  }
}

/// What a coarser or a looser discretisation would do in the place of physics.
ParameterGroup numerics_of(const ForwardCase& c) {
  const auto number = [](const char* name, const char* doc, double now, double other) {
    AddedParameter a;
    a.doc = doc;
    a.parameter = {
        .name = std::string("numerics.") + name, .key = std::string("material.mercury.") + name, .min = std::min(now, other), .max = std::max(now, other)};
    a.parameter.nominal = now;
    a.strengths = {other};
    return a;
  };
  return {.name = "numerics",
          .added = {number("hourglass", "stiffness of the springs that keep elements of the mercury in shape", c.mercury.hourglass, 10 * c.mercury.hourglass),
                    number("collapse_viscosity", "viscosity of voids that close", c.mercury.collapse_viscosity, 2 * c.mercury.collapse_viscosity)},
          .numerical = true,
          .like_the_mesh = true,
          .plain = "the simulation's own discretisation",
          .check = "repeat the diagnosis on finer meshes (emulator.element_sizes)"};
}

}  // namespace

std::vector<ParameterGroup> offered_groups(const ForwardCase& c, const Mesh& mesh) {
  std::vector<ParameterGroup> groups;
  for (const auto& row : mechanisms().rows()) {
    const MechanismEntry& entry = row.entry;
    const bool listed = c.listed_mechanisms.empty() || std::find(c.listed_mechanisms.begin(), c.listed_mechanisms.end(), row.name) != c.listed_mechanisms.end();
    if (!listed || c.enables(row.name) || !entry.built() || (entry.needs_rear && mesh.rear.empty())) continue;
    for (const auto& law : laws_of(entry)) {
      ParameterGroup g{.name = row.name,
                       .place = law,
                       .law = !law.empty(),
                       .by_sensor = entry.per_sensor,
                       .linear = entry.left != nullptr,
                       .like_the_mesh = entry.like_the_mesh,
                       .cost = entry.cost,
                       .plain = entry.plain,
                       .check = entry.check};
      for (const auto& k : entry.keys) {
        if ((!k.law.empty() && k.law != law) || hidden_by_mirror(k, mesh)) continue;
        if (k.decides && k.screened) g.added.push_back(added_number(row.name, k, c.off_value(k), k.shows_below.empty() ? 1 : c.number(k.shows_below)));
        if (g.linear && !g.added.empty()) g.added.back().strengths.resize(1);
        if (k.shapes) g.shapes.push_back(shape_of(row.name, k));
      }
      add_at_each_wall(groups, std::move(g), entry, c);
    }
  }
  groups.push_back(numerics_of(c));
  return groups;
}

}  // namespace calomel
