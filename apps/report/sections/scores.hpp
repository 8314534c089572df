#pragma once
/// The section "Accuracy and error by sensor".
#include <string>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// Scores by sensor; `key` is "accuracy" or "mae". There is a column of nominal scores and one for each method. Bold: the calibrated simulation scores as well
/// as the nominal one, or better.
Table score_table(const Study& study, const ReportInput& input, const std::string& key);
/// Each method's scores over the whole record in one row, for the first screen.
Table headline_table(const Study& study, const ReportInput& input);
/// Scores with and without the correction for the mesh, of the calibrations that have it.
Table mesh_table(const Study& study, const ReportInput& input);

/// The body of the section.
Html scores_section(const Study& study, const ReportInput& input);

}  // namespace calomel
