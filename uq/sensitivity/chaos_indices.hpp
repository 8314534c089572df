#pragma once
/// Sobol' indices from the coefficients of a polynomial in Legendre's basis.
#include <Eigen/Core>
#include <vector>

namespace calomel {

/// A polynomial of parameters that are uniform on [-1, 1]: sum_a c_a prod_k sqrt(2 a_k + 1) P_{a_k}(x_k).
struct LegendreChaos {
  Eigen::MatrixXi degrees;       ///< (terms, d)
  Eigen::VectorXd coefficients;  ///< (terms)
  double left_out_r2 = 0;        ///< 1 - mean squared leave-one-out error / variance of the values it was fitted to
  int order = 0;
};

/// First and total order, (d) each, exact for the polynomial: the basis is orthonormal, so that squares of coefficients add to the variance (Sudret 2008,
/// Reliab. Eng. Syst. Saf. 93, 964). NaN without variance.
struct ChaosIndices {
  Eigen::VectorXd first_order, total_order;
};
[[nodiscard]] ChaosIndices indices_of(const LegendreChaos& chaos);

/// Least squares on values (n) at x (d, n) in [-1, 1]: of all total degrees from 1 on whose terms are at most a third of the values, the one with the least
/// leave-one-out error; without coefficients where the values do not vary. Errors: NumericsError for fewer values than three times the terms of a straight
/// line.
[[nodiscard]] LegendreChaos fit_chaos(const Eigen::MatrixXd& x, const Eigen::VectorXd& values);

/// The polynomial at points x (d, n) in [-1, 1], (n).
[[nodiscard]] Eigen::VectorXd values_of(const LegendreChaos& chaos, const Eigen::MatrixXd& x);

}  // namespace calomel
