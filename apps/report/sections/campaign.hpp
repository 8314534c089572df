#pragma once
/// The section "Campaign".
#include <cstddef>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// The first `most` runs that failed, with their parameters and messages.
Table failure_table(const Study& study, std::size_t most);
/// Parameters, status and message of every run.
Table design_table(const Study& study);
/// The scatter between simulated pulses, by sensor.
Table scatter_table(const Study& study, const ReportInput& input);

/// The body of the section.
Html campaign_section(const Study& study, const ReportInput& input);

/// The plot's data: {parameters, done, failed: (run, parameter)}. At most `points` runs are drawn, and all failed runs. Null when there are none.
Json design_json(const Study& study, const ReportInput& input, std::size_t points);

}  // namespace calomel
