#pragma once
/// Variance-based sensitivity: the shares of a quantity's variance that each parameter explains alone, and together with all others.
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace calomel {

/// A share with its 95 % interval [-].
struct SensitivityIndex {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// The Sobol' indices of one quantity, by parameter.
struct SobolIndices {
  std::vector<SensitivityIndex> first_order;
  std::vector<SensitivityIndex> total_order;
  double variance = 0;  ///< variance of the quantity [its unit squared]; summed over the parts for generalised indices
};

/// The rows (A, B, A with B's k-th column) of one quantity: halves of squared differences, summed over the parts of a vector.
struct SobolRows {
  Eigen::VectorXd variance;  ///< (n) |f(A) - f(B)|^2 / 2, with the mean V
  Eigen::MatrixXd alone;     ///< (n, d) |f(B) - f(A_B^k)|^2 / 2, with the mean V - V_k
  Eigen::MatrixXd total;     ///< (n, d) |f(A) - f(A_B^k)|^2 / 2, with the mean E[V | all but k]
};

/// S_k = 1 - mean(alone) / mean(variance) and T_k = mean(total) / mean(variance) (Jansen 1999, Comput. Phys. Commun. 117, 35). For a vector the sums over its
/// parts give the generalised indices of Gamboa, Janon, Klein and Lagnoux 2014, Electron. J. Stat. 8, 575. The 95 % intervals come from a percentile bootstrap
/// over the rows. Indices are NaN without variance; intervals are NaN for fewer than 8 rows, which are too few for a bootstrap.
[[nodiscard]] SobolIndices sobol_indices(const SobolRows& rows, std::uint64_t seed, int resamples = 500);

/// The design, (d, n (d + 2)) points of the unit cube; each row is A, B, then A_B^1 ... A_B^d. A and B come from one Sobol' sequence of 2 d dimensions under a
/// random shift, or for more than 20 parameters, for which there is no such sequence, from a Latin hypercube.
[[nodiscard]] Eigen::MatrixXd sobol_rows_design(std::size_t dimensions, std::size_t n, std::uint64_t seed);

/// Running sums for the indices of many values at once, such as curves over time, without intervals.
class SobolCurves {
 public:
  SobolCurves(Eigen::Index values, Eigen::Index dimensions);
  /// Adds one row, f: (values, d + 2), in the design's order. A row with a value that is not finite is left out.
  void add(const Eigen::MatrixXd& f);
  [[nodiscard]] Eigen::MatrixXd first_order() const;                           ///< (values, d)
  [[nodiscard]] Eigen::MatrixXd total_order() const;                           ///< (values, d)
  [[nodiscard]] const Eigen::VectorXd& variance() const { return variance_; }  ///< (values), summed over the rows

 private:
  Eigen::VectorXd variance_;
  Eigen::MatrixXd alone_;
  Eigen::MatrixXd total_;
  Eigen::Index rows_ = 0;
};

}  // namespace calomel
