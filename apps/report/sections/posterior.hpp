#pragma once
/// The section "Posterior", and its result for the first screen.
#include <string>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// Means, standard deviations, quantiles and diagnostics of posterior.json.
Table posterior_table(const Study& study, const ReportInput& input);

/// The result in a sentence for the top of the page: medians and central 90 % intervals, or that they are not to be used. Empty without posterior.json.
Html posterior_headline(const Study& study, const ReportInput& input);
/// The body of the section.
Html posterior_section(const Study& study, const ReportInput& input);

/// One table of all draws: chain, draw, one column a quantity. Empty without posterior.nc.
std::string posterior_draws_csv(const Study& study);

}  // namespace calomel
