#include "forward/target/effective_load.hpp"

#include <fmt/format.h>

#include <cmath>

#include "forward/mesh/mesh_extent.hpp"

namespace calomel {

namespace {

constexpr double on_mirror_plane = 1e-6;  ///< [m]

/// Where the target is, across the beam.
std::string extent_text(const Mesh& mesh) {
  const auto along = [&](std::size_t c) {
    const auto [low, high] = extent(mesh, c);
    return fmt::format("{:.4g} to {:.4g} m", low, high);
  };
  return mesh.plane_strain ? "the target reaches from z = " + along(2) : "the target reaches from y = " + along(1) + " and from z = " + along(2);
}

/// How the whole is modelled where only one side of a plane across the axis is.
std::string whole_model(char axis, const ForwardCase& at) {
  return axis == 'y' && at.geometry.half ? "set geometry.half = false" : fmt::format("use a mesh without symmetry_{}", axis);
}

void expect_rear(const EnabledMechanism& m, const Mesh& mesh) {
  if (m.entry->needs_rear && mesh.rear.empty())
    throw InputError({.problem = "the target has no rear face that swallows waves, on which alone it acts",
                      .key = "mechanism." + m.name + ".enabled",
                      .value = "true",
                      .suggestion = "set geometry.rear = \"non_reflecting\" (a mesh from a file: geometry.sets.rear), or remove the mechanism"});
}

/// What breaks a symmetry by which only a part is modelled cannot show there.
void expect_symmetric(const EnabledMechanism& m, const ForwardCase& at, const Mesh& mesh) {
  for (const auto& k : m.entry->keys) {
    if (!hidden_by_mirror(k, mesh)) continue;
    const double value = m.values[k.name];
    if (value == at.off_value(k)) continue;
    const char axis = "xyz"[*k.off_centre];
    throw InputError(
        {.problem = fmt::format(
             "only one side of a plane across {0} is modelled, and the other is taken for its mirror image: what is off centre along {0} cannot show", axis),
         .key = "mechanism." + m.name + '.' + k.name,
         .value = number_text(value),
         .suggestion = whole_model(axis, at)});
  }
}

/// A beam off the plane by which only a part is modelled would be two beams.
void expect_on_mirror_planes(const LoadOptions& load, const Mesh& mesh, const ForwardCase& at) {
  if (load.kind != "initial_pressure") return;
  for (const auto& m : mesh.mirrors) {
    if (m.axis == 0) continue;
    const double centre = load.profile.center[std::size_t(m.axis - 1)];
    if (std::abs(centre - m.at) < on_mirror_plane) continue;
    const char axis = "xyz"[m.axis];
    throw InputError(
        {.problem = fmt::format(
             "only one side of the plane {} = {} m is modelled, and the other is taken for its mirror image: a beam off that plane would be two beams", axis,
             number_text(m.at)),
         .key = "load.profile.center",
         .value = number_text(centre),
         .suggestion = whole_model(axis, at) + ", or put the beam on the plane"});
  }
}

}  // namespace

LoadOptions effective_load(const ForwardCase& at, const Mesh& mesh, double front) {
  LoadOptions load = at.load;
  load.profile.front = front;
  expect_on_mirror_planes(load, mesh, at);
  for (const auto& m : at.active_mechanisms()) {
    expect_symmetric(m, at, mesh);
    expect_rear(m, mesh);
    if (m.entry->load) m.entry->load(m.values, mesh, load);
  }
  return load;
}

void expect_something_moves(const ForwardCase& c, const Mesh& mesh) {
  if (c.load.kind == "end_stress" && mesh.loaded.empty())
    throw InputError(
        {.problem = "the mesh has no loaded faces for the end_stress", .key = "geometry.sets.loaded", .suggestion = "name the set of those faces"});
  if (c.load.kind != "end_stress" && mesh.quality.mercury_volume == 0)
    throw InputError({.problem = "the mesh holds no mercury to heat",
                      .key = "load.kind",
                      .suggestion = "name its sets with geometry.sets.mercury, or use kind = \"end_stress\""});
}

void expect_heat(const LoadOptions& load, const HeatingShape& heating, const Mesh& mesh) {
  if (load.kind == "initial_pressure" && !(heating.integral > 0))
    throw InputError({.problem = fmt::format("the pulse passes the mercury by and heats nothing; {}", extent_text(mesh)),
                      .key = "load.profile.center",
                      .suggestion = "lengths are in metres"});
}

}  // namespace calomel
