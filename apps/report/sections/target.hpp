#pragma once
/// The section "Target and sensors".
#include <cstddef>

#include "apps/report/data/report_input.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// Positions and directions of the sensors, and their distances from the declared positions.
Table sensor_table(const ReportInput& input);

/// The body of the section.
Html target_section(const ReportInput& input);

/// The picture's data: {outer, wetted: {vertices, quads, thinned}, sensors: [{name, position, direction}]}. The outer surface has at most `quads`
/// quadrilaterals. Null when there is nothing to draw.
Json target_json(const ReportInput& input, std::size_t quads);

}  // namespace calomel
