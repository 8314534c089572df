#pragma once
/// What adding a block of numbers to a model would be worth, to first order about a fit.
#include <Eigen/Core>
#include <vector>

#include "base/linear_algebra.hpp"
#include "inverse/posterior/mode.hpp"

namespace calomel {

/// Changes of the compared values per unit of each number, and the priors' standard deviations.
struct AddedDirections {
  Eigen::MatrixXd by_number;  ///< (size, n) on the grid of the fit
  Eigen::VectorXd prior_sd;   ///< (n)
};

struct FirstOrder {
  double log_bayes_factor = 0;  ///< with over without
  Eigen::VectorXd value, sd;    ///< of each number above its off value, (n)
  Eigen::VectorXd shift;        ///< of the fit's coordinates (u of the free parameters, k) that goes with it, (dimension)
};

/// Numbers beside parameters that stay where they are, (1 + D^T D)^-1 D^T r, of the records less the prediction at `at`, under hypothesis j about the errors,
/// (n).
[[nodiscard]] Eigen::VectorXd numbers_beside(const LogPosterior& posterior, const LogPosterior::Point& at, const AddedDirections& directions, std::size_t j);

/// A fit about its mode: linear in its coordinates delta, under every hypothesis j about the errors, of weight w_j. Of n numbers mu with prior N(0, P) and
/// directions D beside it, with the residual r, in units in which the hypothesis' covariance and P are 1, and the prior's curvature H and slope g in delta,
///
///   log Z_j(D) = log w_j L_j(r) + b^T A^-1 b / 2 - log det A / 2,  A = [H + J^T J, J^T D; D^T J, 1 + D^T D],  b = [J^T r + g; D^T r],
///
/// and log B = log sum_j Z_j(D) - log sum_j Z_j(no columns): numbers that explain the residual also bring back the hypotheses without a discrepancy. (Student's
/// t where the errors' scale was learnt from few squares: b^T A^-1 b / 2 is then what the lesser chi-squared gains.) value, sd and shift are those of the
/// likeliest hypothesis with D. H and g are those that make the mode a mode with the covariance that it has; H is at least the inverse variance of the
/// emulator's box, beyond which nothing is linear.
class FirstOrderModel {
 public:
  /// Both outlive the object.
  FirstOrderModel(const LogPosterior& posterior, const LocalMode& mode);

  /// Of the records.
  [[nodiscard]] FirstOrder worth(const AddedDirections& directions) const;

  /// Directions in the units of every hypothesis, made once for many questions.
  struct Block {
    struct One {
      Eigen::MatrixXd d;  ///< whitened, in units of the priors, (size, n)
      Cholesky factor;    ///< of A
    };
    std::vector<One> errors;
  };
  [[nodiscard]] Block block(const AddedDirections& directions) const;

  /// log B of a block for records that differ from the mode by `strength` prior deviations of one number, and by noise of the first hypothesis as it is
  /// expected.
  class Expected {
   public:
    [[nodiscard]] double log_bayes_factor(double strength) const;

   private:
    friend class FirstOrderModel;
    struct One {
      double log_norm, freedom, values, noise;         ///< as Errors
      double chi2, with, without;                      ///< at strength 1: of the change, and b^T A^-1 b with the block and without it
      double half_log_det_with, half_log_det_without;  ///< of A
    };
    std::vector<One> errors_;
  };
  /// Of `block`, for records with number k of `concealed`.
  [[nodiscard]] Expected expected(const Block& concealed, Eigen::Index k, const Block& block) const;

 private:
  /// One hypothesis about the errors.
  struct Errors {
    double log_norm, freedom;  ///< log w_j and the density at residual 0
    Eigen::MatrixXd jacobian;  ///< whitened, (size, dimension)
    Eigen::VectorXd residual;  ///< whitened, of the records
    double noise = 0;          ///< chi-squared of noise of the first hypothesis, as expected
    Cholesky factor;           ///< of H + J^T J
  };

  const LogPosterior& posterior_;
  const LocalMode& mode_;
  std::vector<Errors> errors_;
  Eigen::MatrixXd curvature_;  ///< H
  Eigen::VectorXd slope_;      ///< g
};

}  // namespace calomel
