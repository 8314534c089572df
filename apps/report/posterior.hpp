#pragma once
/// The posterior's part of the report: its summary and the corner plot.
#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// Means, deviations, quantiles and diagnostics of posterior.json.
Table posterior_table(const Study& study, const ReportInput& input);

/// The answer in a sentence for the top of the page: medians and what 90 % of the draws lie between, or that they are not to be used. HTML; empty without
/// posterior.json.
std::string posterior_headline(const Study& study, const ReportInput& input);
/// The section. HTML.
std::string posterior_section(const Study& study, const ReportInput& input);

/// One table of all draws: chain, draw, one column a quantity. Empty where there is no posterior.nc.
std::string posterior_draws_csv(const Study& study);

/// What the corner plot shows, at most six quantities, those of the case's parameters first:
/// {axes: [{name, label, span, density: on an even grid over the span, q05, q50, q95}],
///  pairs: [{i, j: axes of x and y, cells, density: (cell of y, cell of x) in thousandths of its greatest, level50, level90}],
///  points: (point, axis), marks: [{label, values: (axis), null where there is none}], ridge: {i, j, product} or null, of: number of quantities}.
/// Marks are the answers of the calibrations, the nominal values and the published answers, which do not widen the frame.
/// Densities on the diagonal are Gaussian kernel estimates (density_curve.hpp), reflected at the parameter's bounds where all draws keep them;
/// those of pairs are histograms of 32 by 32 cells under a Gaussian of one cell, with the levels of it above which 50 and 90 % of the draws lie. The ridge is
/// rho c = median of the draws' products. `points` bounds the draws that are drawn as points, thinned evenly. Null where there is no posterior.nc.
Json corner_json(const Study& study, const ReportInput& input, std::size_t points);

}  // namespace calomel
