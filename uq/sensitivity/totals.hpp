#pragma once
/// Sensitivity of numbers that are known for some runs only.
#include <Eigen/Core>
#include <vector>

#include "uq/sensitivity/sensitivity.hpp"

namespace calomel {

/// thetas (n_parameters, n) with the range of each parameter mapped to [0, 1].
[[nodiscard]] Eigen::MatrixXd unit_of(const Eigen::MatrixXd& thetas, const std::vector<Parameter>& parameters);

/// Analyses each of in.totals by a polynomial that is fitted to the runs (fit_chaos). Indices come from its values at `design` (sobol_rows_design), and also
/// from its coefficients where parameters are uniform; elementary effects come from its values at `steps` (morris_design). Runs without a number are left out.
/// A total that does not vary, or has too few runs for a polynomial, has a note that says so and no polynomial. With too few runs, mean, sd and indices are
/// NaN.
[[nodiscard]] std::vector<QuantitySensitivity> analyse_totals(const SensitivityInputs& in, const Eigen::MatrixXd& design, const Eigen::MatrixXd& steps);

}  // namespace calomel
