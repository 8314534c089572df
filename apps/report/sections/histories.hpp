#pragma once
/// The section "Measured and simulated histories".
#include <cstddef>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/html.hpp"

namespace calomel {

/// The body of the section.
Html histories_section(const Study& study, const ReportInput& input);

/// histories_json with `scores`: a line of scores by sensor.
Json scored_histories_json(const Study& study, const ReportInput& input, std::size_t most);

}  // namespace calomel
