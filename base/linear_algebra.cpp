#include "base/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace calomel {

Cholesky::Cholesky(const Eigen::MatrixXd& a) {
  const Eigen::LLT<Eigen::MatrixXd> factor(a);
  positive_definite_ = factor.info() == Eigen::Success;
  factor_ = factor.matrixLLT();
}

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  factor_.adjoint().triangularView<Eigen::Upper>().solveInPlace(x);
  return x;
}

Eigen::MatrixXd Cholesky::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x = b;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  factor_.adjoint().triangularView<Eigen::Upper>().solveInPlace(x);
  return x;
}

Eigen::VectorXd Cholesky::solve_lower(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  return x;
}

Eigen::MatrixXd Cholesky::solve_lower(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x = b;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  return x;
}

Eigen::MatrixXd Cholesky::lower() const { return factor_.triangularView<Eigen::Lower>(); }

double Cholesky::half_log_determinant() const { return factor_.diagonal().array().log().sum(); }

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) { return a.ldlt().solve(b); }
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a.ldlt().solve(b); }
Eigen::MatrixXd inverse_symmetric(const Eigen::MatrixXd& a) { return solve_symmetric(a, Eigen::MatrixXd(Eigen::MatrixXd::Identity(a.rows(), a.cols()))); }

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a) { return a.inverse(); }

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricEigen tridiagonal_eigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
  eigen.computeFromTridiagonal(diagonal, off);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

}  // namespace calomel
