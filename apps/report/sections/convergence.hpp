#pragma once
/// The section "Convergence of the optimisers": ENC's optimisers, and the optimisers that were compared on one surrogate.
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// The best objective of each round of ENC, by optimiser.
Table optimizer_table(const Study& study);
/// The best objective by generation, in the best round of each optimiser of ENC.
Table convergence_table(const Study& study);
/// The optimisers of ENC and those that ENC compared with them, each beside the best of all. Empty when enc.json compares none.
Table optimizer_agreement_table(const Study& study);
/// The optima by other formulations of the misfit, each run in the true model. Empty when enc.json compares none.
Table formulation_table(const Study& study, const ReportInput& input);
/// The last values of optimizer_comparison.json: best, mean, standard deviation and worst of the trials, by function and optimiser.
Table trial_table(const Study& study);
/// The decay in optimizer_comparison.json: function, optimiser, evaluations, mean, standard deviation.
Table decay_table(const Study& study);

/// The body of the section.
Html convergence_section(const Study& study, const ReportInput& input);

/// The lines of convergence_table for the plot: {lines, x_label, y_label}. Null when there are none.
Json convergence_json(const Study& study);
/// The decay for the plots, one entry a function: {title, lines: [{label, group, variant, x, y, low, high}], span, x_label, y_label}. `low` and `high` are
/// three standard deviations below and above the mean. Null when there is none.
Json decay_json(const Study& study);

}  // namespace calomel
