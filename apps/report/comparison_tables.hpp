#pragma once
/// Tables of the report that hold calibrations, or optimisers, against each other.
#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"
#include "inverse/comparison/comparison.hpp"

namespace calomel {

/// Of the calibrations of the study.
Comparison comparison_of(const Study& study);

/// Differences of every two calibrations in each parameter, in percent and in MAP's standard deviations; its note says which lie within the posterior.
/// Empty for fewer than two.
Table agreement_table(const Study& study);
/// Evaluations, true-model runs and times by method. Empty for fewer than two.
Table effort_table(const Study& study);
/// Mahalanobis distance of every other answer from MAP's and the share of the posterior that lies nearer. Empty without MAP's covariance.
Table place_table(const Study& study);
/// The Bayes factor of MAP's added parameters, in one row; its note says what the records favour. Empty without map.compare_with.
Table hypothesis_table(const Study& study);
/// ENC's optimisers, its own and those that it was compared with, beside the best of all. Empty where enc.json compares none.
Table optimizer_agreement_table(const Study& study);
/// The answers by other formulations of the misfit, each in the true model. Empty where enc.json compares none.
Table formulation_table(const Study& study, const ReportInput& input);
/// Last values of optimizer_comparison.json: best, mean, sd and worst of the trials by function and optimiser.
Table trial_table(const Study& study);
/// Its decay: function, optimiser, evaluations, mean, sd.
Table decay_table(const Study& study);
/// The same for the page's drawing, one entry a function: {title, lines: [{label, group, variant, x, y, low, high}], span, x_label, y_label},
/// low and high three standard deviations about the mean. Null where there is none.
Json decay_json(const Study& study);

}  // namespace calomel
