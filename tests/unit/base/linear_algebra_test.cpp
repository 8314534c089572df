#include "base/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"

using namespace calomel;

namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t stream) {
  RandomStream random(7, stream);
  Eigen::MatrixXd m(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) m(i, j) = random.normal();
  return m;
}

/// M^T M + 1, positive definite.
Eigen::MatrixXd definite(Eigen::Index n) {
  const Eigen::MatrixXd m = random_matrix(n, n, 1);
  return m.transpose() * m + Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n));
}

double off_identity(const Eigen::MatrixXd& m) { return (m - Eigen::MatrixXd(Eigen::MatrixXd::Identity(m.rows(), m.cols()))).norm(); }

}  // namespace

TEST(Cholesky, SolvesAndMultipliesBackToTheMatrix) {
  const Eigen::MatrixXd a = definite(6), b = random_matrix(6, 3, 2);
  const Cholesky c(a);
  ASSERT_TRUE(c.positive_definite());
  EXPECT_EQ(c.size(), 6);
  const Eigen::MatrixXd l = c.lower();
  EXPECT_EQ(l(0, 5), 0);
  EXPECT_LT((l * l.transpose() - a).norm(), 1e-12 * a.norm());
  EXPECT_LT((a * c.solve(b) - b).norm(), 1e-12 * b.norm());
  EXPECT_LT((l * c.solve_lower(b) - b).norm(), 1e-12 * b.norm());
  const Eigen::VectorXd first = b.col(0);
  EXPECT_LT((c.solve(first) - c.solve(b).col(0)).norm(), 1e-13);
  EXPECT_LT((c.solve_lower(first) - c.solve_lower(b).col(0)).norm(), 1e-13);
  EXPECT_NEAR(c.half_log_determinant(), 0.5 * symmetric_eigenvalues(a).array().log().sum(), 1e-12);
}

TEST(Cholesky, ReportsAMatrixThatIsNotPositiveDefinite) {
  Eigen::MatrixXd a = definite(4);
  a(2, 2) = -1;
  EXPECT_FALSE(Cholesky(a).positive_definite());
  EXPECT_FALSE(Cholesky().positive_definite());
}

TEST(LinearSystems, AreSolvedByEveryWay) {
  const Eigen::MatrixXd a = definite(5), b = random_matrix(5, 2, 3), g = random_matrix(5, 5, 4);
  const Eigen::VectorXd first = b.col(0);
  EXPECT_LT((a * solve_symmetric(a, b) - b).norm(), 1e-12);
  EXPECT_LT((a * solve_symmetric(a, first) - first).norm(), 1e-12);
  EXPECT_LT(off_identity(a * inverse_symmetric(a)), 1e-12);
  EXPECT_LT(off_identity(g * inverse(g)), 1e-11);
}

TEST(SymmetricEigen, HasAscendingValuesAndOrthonormalVectors) {
  const Eigen::MatrixXd a = definite(7);
  const SymmetricEigen e = symmetric_eigen(a);
  for (Eigen::Index k = 1; k < 7; ++k) EXPECT_GE(e.values[k], e.values[k - 1]);
  EXPECT_LT(off_identity(e.vectors.transpose() * e.vectors), 1e-13);
  EXPECT_LT((a * e.vectors - e.vectors * e.values.asDiagonal()).norm(), 1e-12 * a.norm());
  EXPECT_LT((symmetric_eigenvalues(a) - e.values).norm(), 1e-13 * a.norm());
}

// The second difference of n points has the eigenvalues 2 - 2 cos(k pi / (n + 1)).
TEST(SymmetricEigen, OfATridiagonalMatrixIsThatOfTheSecondDifference) {
  const Eigen::Index n = 9;
  const SymmetricEigen e = tridiagonal_eigen(Eigen::VectorXd::Constant(n, 2), Eigen::VectorXd::Constant(n - 1, -1));
  for (Eigen::Index k = 1; k <= n; ++k) EXPECT_NEAR(e.values[k - 1], 2 - 2 * std::cos(double(k) * M_PI / double(n + 1)), 1e-13);
  EXPECT_LT(off_identity(e.vectors.transpose() * e.vectors), 1e-13);
}

TEST(OrthogonalFactor, LeavesAnUpperTriangleWithAPositiveDiagonal) {
  const Eigen::MatrixXd a = random_matrix(6, 6, 5), q = orthogonal_factor(a), r = q.transpose() * a;
  EXPECT_LT(off_identity(q.transpose() * q), 1e-13);
  for (Eigen::Index j = 0; j < 6; ++j) {
    EXPECT_GT(r(j, j), 0);
    for (Eigen::Index i = j + 1; i < 6; ++i) EXPECT_NEAR(r(i, j), 0, 1e-13);
  }
}

TEST(LeastSquares, LeavesAResidualAcrossTheColumnsWhateverTheirRank) {
  Eigen::MatrixXd a = random_matrix(8, 3, 6);
  const Eigen::VectorXd b = random_matrix(8, 1, 7);
  EXPECT_LT((a.transpose() * (a * least_squares(a, b) - b)).norm(), 1e-12);
  a.col(2) = a.col(0) - 2 * a.col(1);
  EXPECT_LT((a.transpose() * (a * least_squares(a, b) - b)).norm(), 1e-12);
}

TEST(SingularValues, DescendAndDiagonaliseTheMatrix) {
  const Eigen::MatrixXd a = random_matrix(30, 20, 8);
  const SingularValues s = singular_values(a);
  ASSERT_EQ(s.left.rows(), 30);
  ASSERT_EQ(s.left.cols(), 20);
  for (Eigen::Index k = 1; k < 20; ++k) EXPECT_LE(s.values[k], s.values[k - 1]);
  EXPECT_LT(off_identity(s.left.transpose() * s.left), 1e-12);
  const Eigen::MatrixXd gram = s.left.transpose() * (a * (a.transpose() * s.left));
  EXPECT_LT((gram - Eigen::MatrixXd(s.values.cwiseAbs2().asDiagonal())).norm(), 1e-11 * gram.norm());
}
