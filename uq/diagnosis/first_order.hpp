#pragma once
/// What adding a block of numbers to a model would be worth, to first order about a fit.
#include <Eigen/Core>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// Changes of the model's values per unit of each number, and the priors' standard deviations.
struct AddedDirections {
  Eigen::MatrixXd by_number;  ///< (values of the model, n)
  Eigen::VectorXd prior_sd;   ///< (n)
};

struct FirstOrder {
  double log_bayes_factor = 0;  ///< with over without
  Eigen::VectorXd value, sd;    ///< of each number above its off value, (n)
  Eigen::VectorXd shift;        ///< of the fit's coordinates (u of the free parameters, k) that goes with it, (dimension)
};

/// Gaussian evidence of d numbers mu with prior covariance P beside a fit at its mode: with the whitened residual r, whitened directions D and Jacobian J of the fit's
/// own coordinates, whose posterior covariance is C,
///
///   A = D^T (1 - J C J^T) D + P^-1,  b = D^T r,  log B = (b^T A^-1 b - log det(P A)) / 2,  mu = A^-1 b.
///
/// Exact where the model is linear in mu and in the parameters over their posterior. The errors are those of the likeliest hypothesis at the mode.
[[nodiscard]] FirstOrder first_order(const LogPosterior& posterior, const LocalMode& mode, const Decimation& grid, const AddedDirections& directions);

}  // namespace calomel
