#pragma once
/// The section "Parameters": the calibrated values and their comparison.
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// Nominal and calibrated values, their changes and bounds, and the impedance.
Table parameter_table(const Study& study, const ReportInput& input);

/// The body of the section.
Html parameters_section(const Study& study, const ReportInput& input);

}  // namespace calomel
