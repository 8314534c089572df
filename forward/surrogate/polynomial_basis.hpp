#pragma once
/// Chebyshev polynomials on the unit box, orthonormal under the Chebyshev (arcsine) probability measure, and sparse expansions in them.
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace calomel {

/// Which products of one-dimensional polynomials of degrees (i_1, ..., i_d) are taken.
struct PolynomialSpace {
  /// total_degree: sum i_k <= order; tensor_product: max i_k <= order; hyperbolic_cross: prod (i_k + 1) <= order + 1; sparse_grid: sum l(i_k) <= order,
  /// l(i) the sparse_grid_level of the degree: the union of all boxes i_k <= g(l_k) with levels sum l_k <= order, g(0) = 0, g(l) = 2^l.
  std::string kind = "total_degree";
  int order = 10;

  [[nodiscard]] std::string name() const { return kind + " " + std::to_string(order); }
  /// Number of products in `dimensions` parameters; no more than `cap` are counted.
  [[nodiscard]] std::size_t terms(std::size_t dimensions, std::size_t cap) const;
  /// Degrees of every product, in lexicographic order: the constant comes first. Shape (dimensions, terms).
  [[nodiscard]] Eigen::MatrixXi degrees(std::size_t dimensions) const;
};

/// Least level l >= 0 of a nested Clenshaw-Curtis rule (1, 3, 5, 9, 17, ... nodes) whose interpolant holds polynomials of this degree >= 0:
/// 0 for the constant, otherwise the least l >= 1 with 2^l >= degree.
int sparse_grid_level(int degree);

/// Psi_0 .. Psi_order at x in [-1, 1] and their derivatives: Psi_0 = 1, Psi_k = sqrt(2) T_k, orthonormal under dx / (pi sqrt(1 - x^2)).
/// value, slope: (order + 1); slope may be empty.
void chebyshev(double x, std::span<double> value, std::span<double> slope);

/// Matrix of a basis at points. degrees: (d, terms); units: (d, n), coordinates in [0, 1]; result: (n, terms).
Eigen::MatrixXd basis_matrix(const Eigen::MatrixXi& degrees, const Eigen::MatrixXd& units);

/// sum_j c_j prod_k Psi_{i_jk}(2 u_k - 1), with the terms of coefficient 0 left out.
class Expansion {
 public:
  Expansion() = default;
  /// degrees: (d, terms) in lexicographic order; coefficients: (terms).
  Expansion(const Eigen::MatrixXi& degrees, const Eigen::VectorXd& coefficients);

  [[nodiscard]] std::size_t terms() const { return coefficients_.size(); }
  [[nodiscard]] std::size_t dimensions() const { return std::size_t(highest_.size()); }
  /// units: (d, n), coordinates in [0, 1]; values: (n). About one multiply-add a term and point.
  void evaluate(const Eigen::MatrixXd& units, std::span<double> values) const;
  /// The same, with the gradient by the unit coordinates. gradients: (d, n).
  void evaluate(const Eigen::MatrixXd& units, std::span<double> values, Eigen::MatrixXd& gradients) const;

 private:
  template <bool with_gradient>
  void run(const Eigen::MatrixXd& units, std::span<double> values, Eigen::MatrixXd* gradients) const;

  std::vector<double> coefficients_;
  std::vector<int> degrees_;  ///< (terms, d)
  std::vector<int> shared_;   ///< (terms): leading degrees that a term has in common with the one before
  std::vector<int> highest_;  ///< (d): highest degree in each coordinate
};

}  // namespace calomel
