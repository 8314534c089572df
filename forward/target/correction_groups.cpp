#include "forward/target/correction_groups.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "forward/target/forward_case.hpp"
#include "forward/mechanism/added_number.hpp"
#include "forward/mechanism/correction.hpp"
#include "forward/mechanism/wall_stretch.hpp"

namespace calomel {

namespace {

/// A term by its key, in words, and whether it is a wall's or the mercury's.
struct Term {
  const char *key, *word;
  bool of_a_wall;
};
constexpr Term terms[] = {{"stiffness", "bulk modulus", false},
                          {"cutoff", "tensile cutoff", false},
                          {"viscosity", "viscosity", false},
                          {"quadratic_viscosity", "quadratic viscosity", false},
                          {"lag", "the share of the pressure that comes 5 µs late", false},
                          {"void_lag", "the time in which voids close", false},
                          {"mass", "mass", true},
                          {"damping", "drag on its motion", true},
                          {"slip", "drag of the mercury along it", true}};

/// A place with the keys of a correction that name it.
struct Place {
  std::string word;
  std::vector<std::pair<std::string, double>> keys;
};

Place zone(std::string word, double x0, double x1, double z0, double z1) {
  return {std::move(word), {{"x_begin", x0}, {"x_end", x1}, {"z_begin", z0}, {"z_end", z1}}};
}

std::string millimetres(double begin, double end) { return fmt::format("{:.3g} to {:.3g} mm", 1e3 * begin, 1e3 * end); }

constexpr int parts_of_length = 3, parts_of_wall = 4;
constexpr double beside_wall = 0.25;  ///< of the height, what counts as beside a wall

std::vector<Place> places_in_mercury(const GeometryOptions& g) {
  std::vector<Place> all{zone("in all of the mercury", -anywhere, anywhere, -anywhere, anywhere)};
  if (g.kind != "box" || !g.length || !g.height) return all;
  const double length = *g.length, height = *g.height, depth = beside_wall * height;
  for (int i = 0; i < parts_of_length; ++i) {
    const double x0 = length * i / parts_of_length, x1 = length * (i + 1) / parts_of_length;
    all.push_back(zone("in the mercury at x = " + millimetres(x0, x1), i == 0 ? -anywhere : x0, i + 1 == parts_of_length ? anywhere : x1, -anywhere, anywhere));
  }
  all.push_back(zone("in the mercury beside the front wall", -anywhere, g.wall_thickness("front") + depth, -anywhere, anywhere));
  for (const char* wall : {"top", "bottom"}) {
    const bool top = wall == std::string("top");
    const double z0 = top ? height - g.wall_thickness(wall) - depth : -anywhere, z1 = top ? anywhere : g.wall_thickness(wall) + depth;
    for (int i = -1; i < parts_of_wall; ++i) {  // all of it, then its parts
      const double x0 = i < 0 ? -anywhere : length * i / parts_of_wall, x1 = i < 0 ? anywhere : length * (i + 1) / parts_of_wall;
      all.push_back(zone(fmt::format("in the mercury beside the {} wall", wall) + (i < 0 ? "" : ", x = " + millimetres(x0, x1)), x0, x1, z0, z1));
    }
  }
  return all;
}

std::vector<Place> places_on_walls(const GeometryOptions& g) {
  std::vector<Place> all;
  for (std::size_t w = 0; w < wall_names().size(); ++w) {
    const std::string& wall = wall_names()[w];
    if (!g.has_wall(wall)) continue;
    all.push_back({fmt::format("on the {} wall", wall), {{"wall", double(w)}, {"begin", -anywhere}, {"end", anywhere}}});
    const bool upright = wall == "front" || wall == "rear";
    const auto length = upright ? g.height : g.length;
    for (int i = 0; g.kind == "box" && wall != "side" && length && i < parts_of_wall; ++i) {
      const double begin = *length * i / parts_of_wall, end = *length * (i + 1) / parts_of_wall;
      all.push_back(
          {fmt::format("on the {} wall, {} = {}", wall, upright ? 'z' : 'x', millimetres(begin, end)), {{"wall", double(w)}, {"begin", begin}, {"end", end}}});
    }
  }
  return all;
}

}  // namespace

std::vector<ParameterGroup> correction_groups(const ForwardCase& c) {
  std::vector<ParameterGroup> groups;
  const auto in_mercury = places_in_mercury(c.geometry), on_walls = places_on_walls(c.geometry);
  for (const auto& t : terms) {
    const auto& keys = correction().keys;
    const MechanismKey& key = *std::find_if(keys.begin(), keys.end(), [&](const auto& k) { return k.name == t.key; });
    for (const auto& place : t.of_a_wall ? on_walls : in_mercury) {
      const std::string name = fmt::format("correction_{}", groups.size() + 1);
      AddedParameter number = added_number(name, key, key.off);
      number.strengths.resize(1);  // one way: about off it is taken for linear
      for (const auto& [place_key, value] : place.keys) number.with.emplace_back("mechanism." + name + '.' + place_key, value);
      groups.push_back({.name = t.word, .place = place.word, .added = {std::move(number)}, .plain = t.word});
    }
  }
  return groups;
}

}  // namespace calomel
