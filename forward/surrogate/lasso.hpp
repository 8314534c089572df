#pragma once
/// The l1-penalised least-squares problem, min |A z - b|^2 + lambda |z|_1, solved to a duality gap.
#include <Eigen/Core>
#include <span>
#include <vector>

namespace calomel {

/// One solution.
struct LassoFit {
  double lambda = 0;
  Eigen::VectorXd z;        ///< (columns)
  double objective = 0;     ///< |A z - b|^2 + lambda |z|_1, the unpenalised column left out of the norm
  double gap = 0;           ///< bound on objective - optimum, relative to the objective
  int rounds = 0;           ///< of the working set
  std::size_t nonzero = 0;  ///< penalised coefficients that are not 0
  [[nodiscard]] bool all_zero() const { return nonzero == 0; }
};

/// Coordinate descent with covariance updates on a growing set of columns (Friedman, Hastie and Tibshirani 2010, J. Stat. Softw. 33(1)),
/// finished by Newton steps on the support that stop where a coefficient changes its sign (Lee et al. 2006), until the duality gap
/// (Kim et al. 2007, IEEE J. Sel. Top. Signal Process. 1, 606) is `gap` times the objective.
class Lasso {
 public:
  /// A: (rows, columns); b: (rows). `unpenalised`: a column without penalty, -1 for none.
  Lasso(Eigen::MatrixXd A, Eigen::VectorXd b, Eigen::Index unpenalised = -1);

  /// The least lambda at which every penalised coefficient is 0: 2 max |A^T b| (of what the unpenalised column leaves).
  [[nodiscard]] double lambda_max() const { return lambda_max_; }
  /// Solutions for `lambdas` in descending order, each started from the one before. Errors: ContractFailure when they ascend or
  /// one is not positive; NumericsError when the gap is not reached.
  [[nodiscard]] std::vector<LassoFit> path(std::span<const double> lambdas, double gap = 1e-10) const;
  [[nodiscard]] LassoFit solve(double lambda, double gap = 1e-10) const { return path(std::span(&lambda, 1), gap)[0]; }

 private:
  class Workspace;
  Eigen::MatrixXd A_;  ///< orthogonal to the unpenalised column, which is 0
  Eigen::VectorXd b_;
  Eigen::Index unpenalised_;
  Eigen::RowVectorXd along_;  ///< what of each column was along the unpenalised one
  double b_along_ = 0;
  double lambda_max_ = 0;
};

/// `n` values from `high` down to `low`, equally spaced in the logarithm.
std::vector<double> descending(double high, double low, std::size_t n);

}  // namespace calomel
