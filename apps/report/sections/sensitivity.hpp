#pragma once
/// The section "Sensitivity", from sensitivity.json and sensitivity.nc.
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/html.hpp"

namespace calomel {

/// The body of the section.
Html sensitivity_section(const Study& study, const ReportInput& input);

/// The data of its plots: {parameters: [name], rows: [label of a record], unit, time_unit,
///  map: {begin, end: (window) [time_unit], total: (parameter, record, window)},
///  curves: {time: (window) [time_unit], first, total: (parameter, record, window), sd: (record, window) [display unit]},
///  morris: [{title, unit, points: [{record, parameter: index, mu_star, sigma}]}]}.
/// The indices of a window are means over its values, weighted by the values' variances. An index is null where the standard deviation of the window is below a
/// hundredth of the greatest of its record, since shares mean little there. `map` and `curves` are null without sensitivity.nc. Null without an analysis.
Json sensitivity_drawings(const Study& study, const ReportInput& input);

}  // namespace calomel
