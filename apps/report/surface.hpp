#pragma once
/// Coarser surfaces for the picture.
#include "apps/report/report.hpp"

namespace calomel {

/// The surface itself when it has at most `most_quads` quadrilaterals; otherwise its vertices are merged within the cells
/// of a regular grid, as coarse as that needs, and what collapses is dropped.
/// Source: Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes (1993).
ReportSurface thinned(const ReportSurface& surface, std::size_t most_quads);

}  // namespace calomel
