#pragma once
/// The section "Candidates and the rho-c ridge".
#include <cstddef>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// The candidates of each calibration with their objectives on the surrogate and in the true model.
Table candidate_table(const Study& study, const ReportInput& input);
/// The best point of every round of ENC.
Table round_table(const Study& study, const ReportInput& input);

/// The body of the section.
Html candidates_section(const Study& study, const ReportInput& input);

/// The plot's data: {points: [[density, sound speed, objective, optimiser]], marks: [{label, x, y}], product, x_label, y_label, value_label, minimise}. At most
/// `points` rounds are drawn. Null without ENC, or when the two parameters are not both inferred.
Json ridge_json(const Study& study, const ReportInput& input, std::size_t points);

}  // namespace calomel
