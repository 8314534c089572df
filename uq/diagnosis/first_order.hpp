#pragma once
/// Evidence of a block of numbers that is added to a model, to first order about a fit.
#include <Eigen/Core>
#include <vector>

#include "base/linear_algebra.hpp"
#include "inverse/posterior/mode.hpp"

namespace calomel {

/// Effects of a block of numbers on the compared values, and the priors of the numbers.
struct AddedDirections {
  Eigen::MatrixXd by_number;  ///< change of the values per unit of each number, (size, n) on the grid of the fit
  Eigen::VectorXd prior_sd;   ///< prior standard deviations, (n)
};

/// A block of numbers to first order: its evidence and the numbers that come with it.
struct FirstOrderEstimate {
  double log_bayes_factor = 0;  ///< of the model with the block over the model without it
  Eigen::VectorXd value, sd;    ///< each number above its off value, and its standard deviation, (n)
  Eigen::VectorXd shift;        ///< move of the fit's coordinates (u of the free parameters, k) that goes with it, (dimension)
};

/// The numbers of a block with fixed parameters, (1 + D^T D)^-1 D^T r, (n). r is the residual of the records at `at` under hypothesis j
/// about the errors.
[[nodiscard]] Eigen::VectorXd numbers_beside(const LogPosterior& posterior, const LogPosterior::Point& at, const AddedDirections& directions, std::size_t j);

/// A fit about its mode: linear in its coordinates delta, under every hypothesis j about the errors, of weight w_j. A block has n numbers mu with prior N(0, P)
/// and directions D. With the residual r, in units in which the hypothesis' covariance and P are 1, and the prior's curvature H and gradient g in delta,
///
///   log Z_j(D) = log w_j L_j(r) + b^T A^-1 b / 2 - log det A / 2,  A = [H + J^T J, J^T D; D^T J, 1 + D^T D],  b = [J^T r + g; D^T r],
///
/// and log B = log sum_j Z_j(D) - log sum_j Z_j(no columns): numbers that explain the residual also bring back the hypotheses without a discrepancy. Where the
/// scale of the errors was estimated from few squares, L is Student's t, and b^T A^-1 b / 2 is what the lesser chi-squared gains. value, sd and shift are those
/// of the likeliest hypothesis with D. H and g make the mode a mode with the covariance that it has. H is at least the inverse variance of the emulator's box,
/// because beyond the box nothing is linear.
class FirstOrderModel {
 public:
  /// `posterior` and `mode` outlive the object.
  FirstOrderModel(const LogPosterior& posterior, const LocalMode& mode);

  /// The block as the records estimate it.
  [[nodiscard]] FirstOrderEstimate estimate(const AddedDirections& directions) const;

  /// Directions in the units of every hypothesis, computed once for many candidates.
  struct Block {
    struct One {
      Eigen::MatrixXd d;  ///< whitened, in units of the priors, (size, n)
      Cholesky factor;    ///< of A
    };
    std::vector<One> errors;
  };
  [[nodiscard]] Block block(const AddedDirections& directions) const;

  /// Expected log B of a block for records that differ from the mode by `strength` prior deviations of one number, and by noise of the first hypothesis.
  class Expected {
   public:
    [[nodiscard]] double log_bayes_factor(double strength) const;

   private:
    friend class FirstOrderModel;
    struct One {
      double log_norm, freedom, values, noise;         ///< as in Errors
      double chi2, with, without;                      ///< at strength 1: of the change, and b^T A^-1 b with the block and without it
      double half_log_det_with, half_log_det_without;  ///< of A
    };
    std::vector<One> errors_;
  };
  /// Expectation for `block` where the records conceal number k of `concealed`.
  [[nodiscard]] Expected expected(const Block& concealed, Eigen::Index k, const Block& block) const;

 private:
  /// One hypothesis about the errors.
  struct Errors {
    double log_norm, freedom;  ///< log w_j and the density at residual 0; freedom of the errors' scale
    Eigen::MatrixXd jacobian;  ///< whitened, (size, dimension)
    Eigen::VectorXd residual;  ///< whitened residual of the records
    double noise = 0;          ///< expected chi-squared of noise of the first hypothesis
    Cholesky factor;           ///< of H + J^T J
  };

  const LogPosterior& posterior_;
  const LocalMode& mode_;
  std::vector<Errors> errors_;
  Eigen::MatrixXd curvature_;  ///< H
  Eigen::VectorXd gradient_;   ///< g
};

}  // namespace calomel
