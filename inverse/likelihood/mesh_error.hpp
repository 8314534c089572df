#pragma once
/// The difference between the working mesh and a finer one, from pairs of runs: a shift that depends on the parameters, and how sure it is.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "inverse/likelihood/kriging.hpp"

namespace calomel {

/// How far beyond the finer mesh the answer lies, in units of (fine - coarse): the shift goes to 1 + mean, and its sd is `sd`. Errors that fall with the
/// first power of the element size sum to 1 beyond a mesh of half the size; what is recorded may stop short of that.
struct BeyondFiner {
  double mean = 1, sd = 0.5;
  double remainder = 0.4;  ///< what no multiple of the difference takes away, over its local amplitude
};

/// fine - coarse by kriging over the pairs, carried on beyond the finer mesh.
class MeshError {
 public:
  MeshError() = default;
  /// theta: (n_parameters, pairs), two or more; differences: (values, pairs), fine - coarse, in the data's unit. Errors: contract failure for other shapes.
  MeshError(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& differences, BeyondFiner beyond = {});

  [[nodiscard]] bool empty() const { return kriging_.empty(); }
  [[nodiscard]] Eigen::Index pairs() const { return kriging_.size(); }
  /// fine - coarse as predicted at theta, (values).
  [[nodiscard]] Eigen::VectorXd difference(std::span<const double> theta) const { return differences_ * kriging_.weights(theta); }
  /// To be added to the working mesh's history, (values): (1 + beyond.mean) difference.
  [[nodiscard]] Eigen::VectorXd shift(std::span<const double> theta) const { return (1 + beyond_.mean) * difference(theta); }
  /// (values, pairs) such that the shift is these times kriging().weights(theta).
  [[nodiscard]] Eigen::MatrixXd shift_directions() const { return (1 + beyond_.mean) * differences_; }
  /// Gradient of sum_i weights_i shift_i(theta) by theta, (n_parameters); weights: (values).
  [[nodiscard]] Eigen::VectorXd pull_back(std::span<const double> theta, std::span<const double> weights) const;
  /// Covariance of the shift at theta: the outer products of the columns of `known`, how the pairs' own scatter is correlated, and of the unknown
  /// multiple beyond the finer mesh; and the sd (values) of what is not of these directions, few pairs showing few of them. The scatter is that of the
  /// smooth difference: the roughness of one more pair (the nugget) has no part in the shift, and that of the run at the answer is the repeatability floor's.
  struct Spread {
    Eigen::MatrixXd known;      ///< (values, pairs)
    Eigen::VectorXd scatter;    ///< (values)
    Eigen::VectorXd remainder;  ///< (values): beyond.remainder times the difference
  };
  [[nodiscard]] Spread spread(std::span<const double> theta) const;
  /// The same whose spread has no part of the pairs' scatter in the directions that they show, for those who draw it.
  [[nodiscard]] MeshError with_known_scatter_drawn() const;
  /// The same for records that lie `mean` +- `sd` beyond the finer mesh, wherever its own shift goes: what is left between the two is part of the spread.
  [[nodiscard]] MeshError with_records_beyond(double mean, double sd) const;
  /// One draw of that part: what the shift is off by, as a function of the parameters.
  class Draw {
   public:
    /// (values), as the shift.
    [[nodiscard]] Eigen::VectorXd at(std::span<const double> theta) const { return directions_ * error_.at(theta); }

   private:
    friend class MeshError;
    Draw(KrigingError error, Eigen::MatrixXd directions) : error_(std::move(error)), directions_(std::move(directions)) {}
    KrigingError error_;
    Eigen::MatrixXd directions_;  ///< (values, pairs - 1)
  };
  /// The object outlives what is returned.
  [[nodiscard]] Draw draw(RandomStream& random) const;
  [[nodiscard]] const Kriging& kriging() const { return kriging_; }
  [[nodiscard]] const BeyondFiner& beyond() const { return beyond_; }

 private:
  /// Of the scatter's variance, what lies in the directions that the pairs show.
  [[nodiscard]] double known_share() const;
  /// The process's covariance in these directions, per squared unit of its deviation: its root, (values, pairs - 1).
  [[nodiscard]] Eigen::MatrixXd root() const { return (1 + beyond_.mean) * (differences_ * kriging_.residual_root()); }
  Kriging kriging_;
  BeyondFiner beyond_;
  bool known_drawn_ = false;
  Eigen::MatrixXd differences_;  ///< (values, pairs)
};

}  // namespace calomel
