#pragma once
/// What the report shows of sensitivity.json and sensitivity.nc; all empty where there is none.
#include <string>

#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// First-order and total indices with their intervals of all records together and of each record, a row a parameter.
Table sensitivity_table(const Study& study);
/// Total indices with their intervals as words, a row a record (or another quantity of it, "peak", "time_of_peak", "rms", "dissipated_energy",
/// "time_at_cutoff"), a column a parameter; the greatest of a row is strong.
Table total_order_table(const Study& study, const std::string& quantity);
/// Elementary effects of every number of every record.
Table morris_table(const Study& study, const ReportInput& input);

/// The section. HTML.
std::string sensitivity_section(const Study& study, const ReportInput& input);
/// What its scripts draw: {parameters: [name], rows: [label of a record],
///  map: {begin, end: (window) [us], total: (parameter, record, window)}, curves: {time: (window) [us], first, total: (parameter, record, window), sd: (record,
///  window) [display unit]}, unit, morris: [{title, unit, points: [{record, parameter: index, mu_star, sigma}]}]}.
/// Indices over a window are those of all its values together: means weighted by the values' variances. Null where a window's standard deviation is below a
/// hundredth of the greatest of its record, for there the shares are of next to nothing. `map` and `curves` are null without sensitivity.nc.
Json sensitivity_drawings(const Study& study, const ReportInput& input);

}  // namespace calomel
