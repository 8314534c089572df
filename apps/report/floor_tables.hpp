#pragma once
/// What the report says of the repeatability floor, from campaign.json or floor.json; all empty where neither holds one.
#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// The floor and what stands beside it, a row each: mean over the gauges and the worst of them, in percent of the signal.
Table floor_table(const Study& study);
/// The same by gauge, a column each.
Table floor_sensor_table(const Study& study);
/// The floor's standard deviation by window (rows) and gauge (columns), in the data's unit.
Table floor_window_table(const Study& study, const ReportInput& input);
/// The body of the page's section; says how to measure a floor where there is none. HTML.
std::string floor_section(const Study& study, const ReportInput& input, const std::string& how_to_measure);

}  // namespace calomel
