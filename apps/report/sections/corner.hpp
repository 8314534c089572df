#pragma once
/// The corner plot of the posterior.
#include <cstddef>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"

namespace calomel {

/// The plot's data, of at most six quantities, those of the case's parameters first:
/// {axes: [{name, label, span, density: on an even grid over the span, q05, q50, q95}],
///  pairs: [{i, j: axes of x and y, cells, density: (cell of y, cell of x) in thousandths of its maximum, level50, level90}],
///  points: (point, axis), marks: [{label, values: (axis), null where there is none}], ridge: {i, j, product} or null, of: number of quantities}.
/// Marks are the optima of the calibrations, the nominal values and the published optima; the published ones do not enlarge the frame.
/// Densities on the diagonal are Gaussian kernel estimates (density_curve.hpp). They are reflected at the parameter's bounds when all draws lie within these.
/// Densities of pairs are histograms of 32 by 32 cells, smoothed by a Gaussian of one cell. 50 and 90 % of the draws lie above the two levels. The ridge is
/// rho c = median of the draws' products. At most `points` draws are drawn as points, thinned evenly. Null without posterior.nc.
Json corner_json(const Study& study, const ReportInput& input, std::size_t points);

}  // namespace calomel
