#pragma once
/// Sobol' indices from the coefficients of a polynomial in Legendre's basis.
#include <Eigen/Core>
#include <vector>

namespace calomel {

/// A polynomial of parameters that are uniform on [-1, 1]: sum_a c_a prod_k sqrt(2 a_k + 1) P_{a_k}(x_k), with Legendre polynomials P.
struct LegendreChaos {
  Eigen::MatrixXi degrees;       ///< (terms, d)
  Eigen::VectorXd coefficients;  ///< (terms)
  double left_out_r2 = 0;        ///< 1 - mean squared leave-one-out error / variance of the fitted values
  int order = 0;                 ///< greatest total degree
};

/// Sobol' indices of first and total order, (d) each. They are exact for the polynomial: the basis is orthonormal, so that the squares of the coefficients add
/// up to the variance (Sudret 2008, Reliab. Eng. Syst. Saf. 93, 964). NaN without variance.
struct ChaosIndices {
  Eigen::VectorXd first_order;
  Eigen::VectorXd total_order;
};
[[nodiscard]] ChaosIndices indices_of(const LegendreChaos& chaos);

/// Fits a polynomial to values (n) at x (d, n) in [-1, 1] by least squares. Total degrees from 1 on are tried while a polynomial has at most a third as many
/// terms as there are values; the one with the least leave-one-out error is returned. It has no coefficients where the values do not vary. Errors:
/// NumericsError for fewer values than three times the terms of first order.
[[nodiscard]] LegendreChaos fit_chaos(const Eigen::MatrixXd& x, const Eigen::VectorXd& values);

/// The values (n) of the polynomial at points x (d, n) in [-1, 1].
[[nodiscard]] Eigen::VectorXd values_of(const LegendreChaos& chaos, const Eigen::MatrixXd& x);

}  // namespace calomel
