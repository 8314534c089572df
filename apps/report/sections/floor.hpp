#pragma once
/// The section "Repeatability floor", from campaign.json or floor.json. The tables are empty when neither has a floor.
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// The floor and the comparisons with it, a row each: the mean over the gauges and the worst gauge, in percent of the signal.
Table floor_table(const Study& study);
/// The same by gauge, a column each.
Table floor_sensor_table(const Study& study);
/// The standard deviation of the floor by window (rows) and gauge (columns), in the unit of the data.
Table floor_window_table(const Study& study, const ReportInput& input);

/// The body of the section. Without a floor it names the command that measures one.
Html floor_section(const Study& study, const ReportInput& input);

}  // namespace calomel
