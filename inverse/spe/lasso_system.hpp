#pragma once
/// The l1 problem of one polynomial space on scattered data, and the weight of its norm that held-out runs or cross-validation prefer.
#include <vector>

#include "forward/surrogate/lasso.hpp"
#include "inverse/spe/surrogates.hpp"

namespace calomel {

class LassoSystem {
 public:
  /// degrees: (d, terms), the constant first. `data` outlives the object.
  LassoSystem(const Eigen::MatrixXi& degrees, const ScatteredData& data, bool penalise_constant);

  /// (n, terms), without the rows' factors.
  [[nodiscard]] const Eigen::MatrixXd& basis() const { return basis_; }
  [[nodiscard]] Lasso lasso(const std::vector<std::size_t>& rows) const;
  /// The best of 33 weights from lambda_max down to 1e-4 of it, by the mean squared error, weighted as the fit is.
  [[nodiscard]] LambdaChoice by_validation() const;
  /// The same by `folds` parts of the training runs, drawn by `seed`; shares of each part's own lambda_max.
  [[nodiscard]] LambdaChoice by_cross_validation(int folds, std::uint64_t seed) const;

 private:
  void add_curve(const std::vector<std::size_t>& train, const std::vector<std::size_t>& test, std::vector<double>& curve) const;
  [[nodiscard]] double squares(const Eigen::VectorXd& z, const std::vector<std::size_t>& rows) const;
  [[nodiscard]] LambdaChoice best_of(const std::vector<double>& curve, int parts) const;

  Eigen::MatrixXd basis_;
  const ScatteredData& data_;
  Eigen::Index free_;  ///< the unpenalised column, or -1
};

}  // namespace calomel
