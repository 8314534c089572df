#pragma once
/// Tables of the sensitivity analysis, from sensitivity.json. They are empty without it.
#include <string>
#include <vector>

#include "apps/report/data/quantities.hpp"
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// First-order and total indices with their intervals, of all records together and of each record, a row a parameter.
Table sensitivity_table(const Study& study);
/// Total indices with their intervals as words, a row a record, a column a parameter. The greatest index of a row is strong. `quantity` is "record", "value",
/// "peak", "time_of_peak", "rms", "dissipated_energy" or "time_at_cutoff".
Table total_order_table(const Study& study, const std::string& quantity);
/// Elementary effects on every quantity of every record.
Table morris_table(const Study& study, const ReportInput& input);

/// sensitivity.json; null without an analysis.
const Json& sensitivity_summary(const Study& study);
/// Names of the quantities of the whole run, in the order of the report.
const std::vector<std::string>& run_total_names();
/// Whether a quantity of sensitivity.json belongs to the whole run.
bool is_run_total(const std::string& quantity);
/// The label of a quantity's record: its sensor and condition.
std::string record_label(const Json& quantity);
/// The name of a quantity in words, "time of the greatest value".
std::string plain_quantity(const std::string& name);
/// The unit in which effects on a quantity are shown, and the factor from the quantity's own unit to it.
DisplayUnit effect_unit(const Json& quantity, const DisplayUnit& of_records, const DisplayUnit& of_times);
/// The parameters of a list of indices.
std::vector<std::string> names_of(const Json& indices);

}  // namespace calomel
