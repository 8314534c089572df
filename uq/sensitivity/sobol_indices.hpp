#pragma once
/// Variance-based sensitivity: shares of a quantity's variance that parameters explain alone, and with all others.
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace calomel {

/// A share with its interval.
struct SensitivityIndex {
  double value = 0, low = 0, high = 0;
};

/// Sobol' indices of one quantity, by parameter.
struct SobolIndices {
  std::vector<SensitivityIndex> first_order, total_order;
  double variance = 0;  ///< of the quantity [its unit squared]; summed over the parts of a generalised one
};

/// Rows (A, B, A with B's k-th column) of one quantity: halves of squared differences, summed over the parts of a vector.
struct SobolRows {
  Eigen::VectorXd variance;  ///< (n) |f(A) - f(B)|^2 / 2, of mean V
  Eigen::MatrixXd alone;     ///< (n, d) |f(B) - f(A_B^k)|^2 / 2, of mean V - V_k
  Eigen::MatrixXd total;     ///< (n, d) |f(A) - f(A_B^k)|^2 / 2, of mean E[V | all but k]
};

/// S_k = 1 - mean(alone) / mean(variance), T_k = mean(total) / mean(variance) (Jansen 1999, Comput. Phys. Commun. 117, 35; for a vector the sums over its parts
/// are the generalised indices of Gamboa, Janon, Klein and Lagnoux 2014, Electron. J. Stat. 8, 575), with 95 % intervals by a percentile bootstrap over the
/// rows. NaN without variance; the intervals are NaN of fewer than 8 rows, of which a bootstrap tells little.
[[nodiscard]] SobolIndices sobol_indices(const SobolRows& rows, std::uint64_t seed, int resamples = 500);

/// The design: (d, n (d + 2)) points of the unit cube, of each row A, B, then A_B^1 ... A_B^d; A and B from one Sobol' sequence of 2 d dimensions under a
/// random shift; of more than 20 parameters, which that does not reach, from a Latin hypercube.
[[nodiscard]] Eigen::MatrixXd sobol_rows_design(std::size_t dimensions, std::size_t n, std::uint64_t seed);

/// Indices of many values at once without intervals, block by block of the design's rows: curves over time.
class SobolCurves {
 public:
  SobolCurves(Eigen::Index values, Eigen::Index dimensions);
  /// f: (values, d + 2) of one row, in the design's order. Rows with a value that is not finite are left out.
  void add(const Eigen::MatrixXd& f);
  [[nodiscard]] Eigen::MatrixXd first_order() const;                           ///< (values, d)
  [[nodiscard]] Eigen::MatrixXd total_order() const;                           ///< (values, d)
  [[nodiscard]] const Eigen::VectorXd& variance() const { return variance_; }  ///< (values), summed over the rows

 private:
  Eigen::VectorXd variance_;
  Eigen::MatrixXd alone_, total_;
  Eigen::Index rows_ = 0;
};

}  // namespace calomel
