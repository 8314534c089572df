#pragma once
/// Targets as hexahedra: parametric, or from a mesh file.
#include "forward/mesh/geometry_options.hpp"
#include "forward/mesh/mesh.hpp"

namespace calomel {

/// The mesh of a `[geometry]`. Errors: InputError (see GeometryOptions::validate).
[[nodiscard]] Mesh make_mesh(const GeometryOptions& options);

/// Steel box filled with mercury. In plane strain one element across y (of thickness element_size, on which no strain
/// depends), both y faces symmetric, no side walls.
[[nodiscard]] Mesh make_box(const GeometryOptions& options);
/// Round steel bar about the x axis: butterfly section, extruded.
[[nodiscard]] Mesh make_bar(const GeometryOptions& options);
/// Target with a rounded nose and plates that lead a jet along the window: a section in x and z, extruded along y.
[[nodiscard]] Mesh make_jet_flow(const GeometryOptions& options);

/// Target from a mesh file: its sets give materials, symmetry planes and boundary faces; wetted faces, where steel and
/// mercury share nodes, are split for wetted = "slip". Errors: InputError for all that a file can be wrong in.
[[nodiscard]] Mesh make_outside_mesh(const GeometryOptions& options);

}  // namespace calomel
