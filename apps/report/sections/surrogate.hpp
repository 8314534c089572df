#pragma once
/// The section "Surrogate quality".
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// The errors of each surrogate on runs that it was not trained on.
Table surrogate_table(const Study& study, const ReportInput& input);
/// The training and test loss by epoch.
Table loss_table(const Study& study);

/// The body of the section.
Html surrogate_section(const Study& study, const ReportInput& input);

/// The lines of loss_table for the plot: {lines, x_label, y_label}. Null when there are none.
Json loss_json(const Study& study);

}  // namespace calomel
