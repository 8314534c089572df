#pragma once
/// Decompositions of dense matrices of any size, by Eigen. Compiling one takes seconds (Cholesky 1.5, symmetric eigenvalues 4.5, singular values 20), so each
/// is compiled once, here, and no other file includes Eigen's Cholesky, Eigenvalues, LU, QR or SVD for matrices of this kind.
#include <Eigen/Core>

namespace calomel {

/// Cholesky factor of a symmetric positive definite matrix, A = L L^T; the lower triangle of A is read (Eigen's LLT).
class Cholesky {
 public:
  Cholesky() = default;
  /// a: (n, n). A matrix that is not positive definite leaves positive_definite() false and the rest without meaning.
  explicit Cholesky(const Eigen::MatrixXd& a);

  [[nodiscard]] bool positive_definite() const { return positive_definite_; }
  [[nodiscard]] Eigen::Index size() const { return factor_.rows(); }
  /// A^-1 b; columns at once.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  /// L^-1 b; columns at once.
  [[nodiscard]] Eigen::VectorXd solve_lower(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& b) const;
  /// L, zero above its diagonal.
  [[nodiscard]] Eigen::MatrixXd lower() const;
  /// log(det A) / 2, the sum of the logarithms of L's diagonal.
  [[nodiscard]] double half_log_determinant() const;

 private:
  Eigen::MatrixXd factor_;  ///< L in and below the diagonal
  bool positive_definite_ = false;
};

/// A^-1 b of a symmetric semidefinite matrix by A = P^T L D L^T P with pivots (Eigen's LDLT); columns at once.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// A^-1 of a symmetric semidefinite matrix in the same way.
Eigen::MatrixXd inverse_symmetric(const Eigen::MatrixXd& a);

/// A^-1 of any square matrix by LU with partial pivots; not finite where A is singular.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

/// A = V diag(values) V^T, values ascending, eigenvectors in the columns of V.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
/// Of a symmetric matrix; its lower triangle is read (Eigen's SelfAdjointEigenSolver: Householder, then QR iterations).
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
/// Its eigenvalues alone, ascending.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);
/// Of a symmetric tridiagonal matrix; diagonal: (n), off: (n - 1).
SymmetricEigen tridiagonal_eigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off);

/// A = Q R of a square matrix with the diagonal of R positive, which makes Q unique: Q, (n, n), by Householder reflections.
Eigen::MatrixXd orthogonal_factor(const Eigen::MatrixXd& a);
/// x of least |A x - b|, A (m, n) of any rank, by Householder QR with pivoted columns.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// A = U diag(values) V^T, values descending; U: (m, min(m, n)).
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd left;  ///< U
};
/// By bidiagonalisation and divide and conquer (Eigen's BDCSVD).
SingularValues singular_values(const Eigen::MatrixXd& a);

}  // namespace calomel
