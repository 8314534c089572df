#pragma once
/// The first screen of the page.
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/html.hpp"

namespace calomel {

/// The case, the stages that have run, their results in words, and the warnings.
Html header_html(const Study& study, const ReportInput& input);

}  // namespace calomel
