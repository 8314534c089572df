#pragma once
/// Sensitivity of numbers that are known at the points of some runs only.
#include <Eigen/Core>
#include <vector>

#include "uq/sensitivity/sensitivity.hpp"

namespace calomel {

/// thetas (n_parameters, n) with each parameter's range counted as 0 to 1.
[[nodiscard]] Eigen::MatrixXd unit_of(const Eigen::MatrixXd& thetas, const std::vector<Parameter>& parameters);

/// Of each of in.totals: a polynomial is fitted to the runs (fit_chaos), its indices follow from its coefficients where parameters vary evenly, and by sampling
/// from its values at `design` (sobol_rows_design); elementary effects from those at `steps` (morris_design). Runs without a number are left out. A total that
/// does not vary, or has too few runs for a polynomial, has a note that says so and no polynomial; without runs enough mean, sd and indices are NaN.
[[nodiscard]] std::vector<QuantitySensitivity> analyse_totals(const SensitivityInputs& in, const Eigen::MatrixXd& design, const Eigen::MatrixXd& steps);

}  // namespace calomel
