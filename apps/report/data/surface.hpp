#pragma once
/// Surfaces of a mesh for the picture, and their thinning.
#include <vector>

#include "apps/report/data/report_input.hpp"

namespace calomel {

/// The part of the mesh that `faces` cover, with only the nodes that it needs.
ReportSurface report_surface(const Mesh& mesh, const std::vector<Face>& faces);

/// A surface of at most `most_quads` quadrilaterals: `surface` itself when it has no more. Otherwise vertices are merged within the cells of a regular grid,
/// which is as coarse as needed, and collapsed quadrilaterals are dropped.
/// Source: Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes (1993).
ReportSurface thinned(const ReportSurface& surface, std::size_t most_quads);

}  // namespace calomel
