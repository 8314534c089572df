#pragma once
/// The sparse polynomial surrogates of SPE, from spe.json, for the section "Surrogate quality".
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// Every surrogate with its errors and its weight of the l1 norm. The weight is also given as a share of the least weight at which all coefficients vanish.
Table polynomial_table(const Study& study);
/// The weights that the held-out runs and the cross-validation prefer, space by space, with the errors that decided.
Table lambda_table(const Study& study);
/// Modes of the pooled optima, densest first.
Table mode_table(const Study& study, const ReportInput& input);
/// The smallest, mean and largest errors of the surrogates.
Table polynomial_error_table(const Study& study);

/// The part of the section; empty when SPE has not run.
Html polynomials_part(const Study& study, const ReportInput& input);

}  // namespace calomel
