#include "forward/mesh/geometry_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace calomel {
namespace {

const std::optional<double>& named_wall(const WallOptions& walls, const std::string& name) {
  if (name == "front") return walls.front;
  if (name == "rear") return walls.rear;
  if (name == "side") return walls.side;
  if (name == "top") return walls.top;
  expect(name == "bottom", "walls are front, rear, side, top and bottom");
  return walls.bottom;
}

void require(const std::optional<double>& value, const std::string& key, const std::string& kind) {
  if (!value)
    throw InputError(
        {.problem = fmt::format("the key is missing and has no default for kind = \"{}\"", kind), .key = key, .suggestion = "add " + key + " = ..."});
}

void refuse(bool given, const std::string& key, const std::string& kind) {
  if (given) throw InputError({.problem = fmt::format("kind = \"{}\" has no such key", kind), .key = key, .suggestion = "leave it out"});
}

/// Walls at both ends of `size` must leave at least 2 % of it to the mercury; the thicker one is blamed.
void leave_mercury(const GeometryOptions& g, double size, const std::string& size_key, const std::vector<std::string>& walls, double multiplicity = 1) {
  double sum = 0;
  std::string thickest;
  for (const auto& w : walls) {
    const double t = g.wall_thickness(w) * multiplicity;
    if (thickest.empty() || t > g.wall_thickness(thickest) * multiplicity) thickest = w;
    sum += t;
  }
  if (thickest.empty() || sum <= 0.98 * size) return;
  const double t = g.wall_thickness(thickest), most = (0.98 * size - (sum - t * multiplicity)) / multiplicity;
  throw InputError({.problem = fmt::format("the {} wall leaves no room for the mercury: walls take {} of {} = {} m", thickest, number_text(sum), size_key,
                                           number_text(size)),
                    .key = g.wall_key(thickest),
                    .value = number_text(t),
                    .range = most > 0 ? "<= " + number_text(most) : "",
                    .suggestion = fmt::format("thinner walls, or more {}", size_key)});
}

}  // namespace

bool GeometryOptions::has_wall(const std::string& name) const {
  if (kind == "mesh") return true;  // its file defines them
  return (name != "rear" || rear == "wall") && (name != "side" || !plane_strain);
}

std::string GeometryOptions::wall_key(const std::string& name) const { return named_wall(walls, name) ? "walls." + name : "wall"; }

double GeometryOptions::wall_thickness(const std::string& name) const {
  if (const auto& own = named_wall(walls, name)) return *own;
  if (!wall)
    throw InputError({.problem = fmt::format("the thickness of the {} wall is missing and has no default", name),
                      .key = "walls." + name,
                      .suggestion = "add wall = ... for all walls, or walls." + name});
  return *wall;
}

GeometryOptions GeometryOptions::resolved() const {
  GeometryOptions g = *this;
  if (kind == "jet_flow") {
    g.length = length.value_or(0.55);
    g.width = width.value_or(0.4);
    g.height = height.value_or(0.12);
    g.wall = wall.value_or(0.004);
    g.nose_radius = nose_radius.value_or(*g.height / 2);
    g.window = window.value_or(0.002);
    g.element_size = element_size.value_or(0.003);
  } else if (kind == "bar" && radius) {
    g.element_size = element_size.value_or(*radius / 4);
  }
  return g;
}

double GeometryOptions::layer_count(double thickness, bool steel) const {
  const double even = std::max(1.0, std::ceil(thickness / *element_size * (1 - 1e-9)));
  return steel ? (wall_elements > 0 ? wall_elements : std::max(2.0, even)) : even;
}

int GeometryOptions::divisions(double thickness, bool steel) const {
  const double n = layer_count(thickness, steel);
  expect(n < 1e9, "the number of elements is checked before layers are divided");
  return int(n);
}

double GeometryOptions::estimated_elements() const {
  const GeometryOptions g = resolved();
  const auto t = [&](const char* name) { return g.wall_thickness(name); };
  if (kind == "bar") {
    const auto n = bar_divisions(g);
    return (quarter ? 1 : 4) * (n.core * n.core + 2 * n.core * n.shell) * n.along;
  }
  double across_y = 1;
  if (!plane_strain) {
    const double side = g.layer_count(t("side"), true);
    across_y = half ? g.layer_count(*g.width / 2 - t("side"), false) + side : g.layer_count(*g.width - 2 * t("side"), false) + 2 * side;
  }
  if (kind == "jet_flow") return across_y * jet_flow_plan(g).elements();
  const double rear_wall = rear == "wall" ? t("rear") : 0;
  return across_y * (g.layer_count(t("top"), true) + g.layer_count(t("bottom"), true) + g.layer_count(*g.height - t("top") - t("bottom"), false)) *
         (g.layer_count(t("front"), true) + g.layer_count(*g.length - t("front") - rear_wall, false) + (rear_wall > 0 ? g.layer_count(rear_wall, true) : 0));
}

BarDivisions bar_divisions(const GeometryOptions& g) {
  const double R = *g.radius;
  return {
      .core = std::max(2.0, g.layer_count(std::numbers::pi / 4 * R, false)), .shell = g.layer_count(0.45 * R, false), .along = g.layer_count(*g.length, false)};
}

double JetFlowPlan::elements() const {
  double to_corner = 0, from_corner = flat_count;
  for (const double n : leg_counts) to_corner += n;
  for (std::size_t i = 0; i < arc_counts.size(); ++i) (i < corner ? to_corner : from_corner) += (i < corner ? 1 : 2) * arc_counts[i];
  return (2 * to_corner + from_corner) * (wall + channel + plate + transition) + to_corner * from_corner;
}

JetFlowPlan jet_flow_plan(const GeometryOptions& g) {
  const double R = *g.nose_radius, length = *g.length;
  JetFlowPlan plan;
  plan.leg.push_back(length);
  if (g.rear == "wall") {
    plan.leg.push_back(length - g.wall_thickness("rear"));
    plan.leg_counts.push_back(g.layer_count(g.wall_thickness("rear"), true));
  }
  plan.leg_counts.push_back(g.layer_count(plan.leg.back() - R, false));
  plan.leg.push_back(R);

  // The core's corner lies at 45 degrees, or where a plate ends within 15 degrees of that, lest a sliver arise.
  const bool plates = g.jet.thickness > 0;
  double corner = 45;
  plan.angles = {0, 90};
  if (plates) {
    const double near = std::abs(g.jet.lower_turn - 45) <= std::abs(g.jet.upper_turn - 45) ? g.jet.lower_turn : g.jet.upper_turn;
    if (std::abs(near - 45) < 15) corner = near;
    for (const double turn : {g.jet.lower_turn, g.jet.upper_turn})
      if (turn > 0) plan.angles.push_back(turn);
  }
  plan.angles.push_back(corner);
  std::sort(plan.angles.begin(), plan.angles.end());
  plan.angles.erase(std::unique(plan.angles.begin(), plan.angles.end()), plan.angles.end());
  plan.corner = std::size_t(std::find(plan.angles.begin(), plan.angles.end(), corner) - plan.angles.begin());
  // The radial lines converge by a factor of two or three from the outer face to the core: the requested size is met half way down the layers.
  const double wall = std::max({g.wall_thickness("top"), g.wall_thickness("bottom"), *g.window}),
               layers = wall + (plates ? g.jet.channel + g.jet.thickness : 0);
  for (std::size_t i = 0; i + 1 < plan.angles.size(); ++i)
    plan.arc_counts.push_back(g.layer_count((plan.angles[i + 1] - plan.angles[i]) * std::numbers::pi / 180 * (R - layers / 2), false));
  const double flat = *g.height - 2 * R;
  plan.flat_count = flat > 1e-9 * R ? g.layer_count(flat, false) : 0;

  plan.wall = g.layer_count(wall, true);
  if (plates) {
    plan.channel = g.layer_count(g.jet.channel, false);
    plan.plate = g.layer_count(g.jet.thickness, true);
  }
  plan.transition = g.layer_count(0.45 * (R - layers), false);
  return plan;
}

void GeometryOptions::validate_mesh_file() const {
  if (file.empty())
    throw InputError(
        {.problem = "the key is missing and has no default for kind = \"mesh\"", .key = "file", .suggestion = "add file = \"target.exo\" or \"target.inp\""});
  const std::string does = "mesh";
  refuse(length.has_value(), "length", does);
  refuse(width.has_value(), "width", does);
  refuse(height.has_value(), "height", does);
  refuse(wall.has_value(), "wall", does);
  refuse(radius.has_value(), "radius", does);
  refuse(nose_radius.has_value(), "nose_radius", does);
  refuse(window.has_value(), "window", does);
  refuse(element_size.has_value(), "element_size", does);
  refuse(wall_elements != 0, "wall_elements", does);
  for (const char* w : {"front", "rear", "side", "top", "bottom"}) refuse(named_wall(walls, w).has_value(), std::string("walls.") + w, does);
  const auto say_with_sets = [](const char* key, const char* set) {
    throw InputError({.problem = "kind = \"mesh\" has no such key", .key = key, .suggestion = fmt::format("name the faces of the file with sets.{}", set)});
  };
  if (plane_strain) say_with_sets("plane_strain", "symmetry_y");
  if (half) say_with_sets("half", "symmetry_y");
  if (rear != "non_reflecting") say_with_sets("rear", "rear");
}

void GeometryOptions::validate() const {
  if (kind == "mesh") return validate_mesh_file();
  const bool bar = kind == "bar", box = kind == "box", jet_flow = kind == "jet_flow";
  if (!bar && !box && !jet_flow)
    throw InputError({.problem = "not a known shape", .key = "kind", .value = '"' + kind + '"', .range = "box, jet_flow, bar, mesh"});
  refuse(!file.empty(), "file", kind);
  refuse(scale != 1, "scale", kind);
  refuse(merge_distance != 0, "merge_distance", kind);
  for (const auto& [key, names] : sets.by_key()) refuse(!names->empty(), "sets." + key, kind);
  if (!bar) refuse(radius.has_value(), "radius", kind);
  if (!jet_flow) refuse(nose_radius.has_value(), "nose_radius", kind), refuse(window.has_value(), "window", kind);
  if (jet_flow && walls.front)
    throw InputError({.problem = "the front wall of a jet_flow target is its window", .key = "walls.front", .suggestion = "set window instead"});
  if (!box) refuse(plane_strain, "plane_strain", kind);
  if (bar) {
    refuse(width.has_value(), "width", kind);
    refuse(height.has_value(), "height", kind);
    refuse(wall.has_value(), "wall", kind);
    for (const char* w : {"front", "rear", "side", "top", "bottom"}) refuse(named_wall(walls, w).has_value(), std::string("walls.") + w, kind);
    refuse(half, "half", kind);
    require(length, "length", kind);
    require(radius, "radius", kind);
  }
  if (box) {
    require(length, "length", kind);
    require(width, "width", kind);
    require(height, "height", kind);
    require(element_size, "element_size", kind);
  }
  if (wall_elements == 1)
    throw InputError({.problem = "one element through a wall cannot represent its bending", .key = "wall_elements", .value = "1", .range = "0, or at least 2"});
  const GeometryOptions g = resolved();
  if (!bar) {
    leave_mercury(g, *g.height, "height", {"top", "bottom"});
    if (box) leave_mercury(g, *g.length, "length", rear == "wall" ? std::vector<std::string>{"front", "rear"} : std::vector<std::string>{"front"});
    if (!plane_strain) leave_mercury(g, *g.width, "width", {"side"}, 2);
  }
  if (jet_flow) {
    const double R = *g.nose_radius, thickest = std::max({g.wall_thickness("top"), g.wall_thickness("bottom"), *g.window});
    const double used = thickest + (jet.thickness > 0 ? jet.channel + jet.thickness : 0);
    if (R > *g.height / 2 * (1 + 1e-12))
      throw InputError(
          {.problem = "the nose is higher than the target", .key = "nose_radius", .value = number_text(R), .range = "<= " + number_text(*g.height / 2)});
    if (used > 0.75 * R)
      throw InputError({.problem = fmt::format("wall, channel and plate ({:.4g} m) do not fit into a nose of radius {:.4g} m", used, R),
                        .key = jet.thickness > 0 ? "jet.channel" : "nose_radius",
                        .range = jet.thickness > 0 ? fmt::format("< {:.4g}", 0.75 * R - thickest - jet.thickness) : ""});
    const double rear_wall = rear == "wall" ? g.wall_thickness("rear") : 0;
    if (*g.length < 1.5 * R + rear_wall)
      throw InputError({.problem = "the target is shorter than its nose",
                        .key = "length",
                        .value = number_text(*g.length),
                        .range = fmt::format(">= {:.4g}", 1.5 * R + rear_wall)});
  }
  const double n = estimated_elements();
  if (!(n <= max_elements))
    throw InputError({.problem = fmt::format("this needs about {:.3g} elements, more than max_elements = {:.3g}", n, max_elements),
                      .key = element_size ? "element_size" : "max_elements",
                      .value = element_size ? number_text(*element_size) : "",
                      .suggestion = "use larger elements, or raise max_elements when the memory is there (about 1 kB an element)"});
}

}  // namespace calomel
