#pragma once
/// Tables of the report about sparse polynomial surrogates, from spe.json; each may be empty.
#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// Every surrogate with its weight of the l1 norm, absolute and as a share of the least one at which everything vanishes, and its errors.
Table polynomial_table(const Study& study);
/// Which weight the held-out runs and which the cross-validation prefers, space by space, with the errors that decided.
Table lambda_table(const Study& study);
/// Modes of the pooled optima, densest first.
Table mode_table(const Study& study, const ReportInput& input);
/// Smallest, mean and largest errors over the surrogates.
Table polynomial_error_table(const Study& study);

}  // namespace calomel
