#pragma once
/// Comparisons of the calibrations with each other, for the section "Parameters".
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"
#include "inverse/comparison/comparison.hpp"

namespace calomel {

/// The comparison of the study's calibrations.
Comparison comparison_of(const Study& study);

/// The differences of every two calibrations in each parameter, in percent and in standard deviations of MAP. Its note lists which optima lie within the
/// posterior. Empty for fewer than two calibrations.
Table agreement_table(const Study& study);
/// Evaluations, true-model runs and times by method. Empty for fewer than two calibrations.
Table effort_table(const Study& study);
/// The Mahalanobis distance of every other optimum from that of MAP, and the share of the posterior that lies nearer. Empty without the covariance of MAP.
Table place_table(const Study& study);
/// The Bayes factor of the parameters that MAP adds, in one row. Its note names the model that the records favour. Empty without map.compare_with.
Table hypothesis_table(const Study& study);

}  // namespace calomel
