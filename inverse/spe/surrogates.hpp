#pragma once
/// The sparse polynomial surrogates of a scalar misfit: every space with every lambda, from the same training runs.
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "forward/surrogate/polynomial_basis.hpp"
#include "inverse/spe/options.hpp"

namespace calomel {

/// A scalar known at points of the unit box.
struct ScatteredData {
  Eigen::MatrixXd units;                       ///< (d, n)
  Eigen::VectorXd values;                      ///< (n), after the transform
  Eigen::VectorXd weights;                     ///< (n) sqrt(Chebyshev density / density of the design): the rows' factors
  std::vector<std::size_t> train, validation;  ///< indices of the runs
};

/// Errors of a surrogate over some runs, in the misfit itself (the transform undone).
struct PolynomialFit {
  double rrmse = 0;  ///< |surrogate - misfit| / |misfit|, Euclidean norms
  double r2 = 0;     ///< 1 - sum error^2 / sum (misfit - mean)^2
};

/// A choice of lambda and the mean squared error, in the transformed values, that it was made by.
struct LambdaChoice {
  double lambda = 0, error = 0;
};

/// One space with the information of its runs on lambda.
struct SpaceChoice {
  PolynomialSpace space;
  std::size_t terms = 0;
  double lambda_max = 0;  ///< of the training runs
  LambdaChoice validation, cross_validation;
};

struct SparsePolynomial {
  PolynomialSpace space;
  std::size_t terms = 0, nonzero = 0;
  double lambda = 0, lambda_max = 0;  ///< of the training runs
  double gap = 0;                     ///< relative duality gap of the fit
  PolynomialFit train, validation;
  Expansion expansion;  ///< of the transformed misfit; empty when the fit failed
  std::string failure;  ///< why there is none

  [[nodiscard]] bool ok() const { return failure.empty(); }
};

struct SparsePolynomials {
  std::vector<SpaceChoice> spaces;
  std::vector<SparsePolynomial> surrogates;  ///< spaces by lambdas, in the order of the options
  std::vector<std::string> too_large;        ///< names of spaces that have more terms than SpeOptions::most_terms and were left out
};

/// The scale of misfit -> what is approximated, and back.
double transformed(const std::string& transform, double cost);
double restored(const std::string& transform, double value);

/// Fits all of them on `threads` threads; `done` is called after each space. A fit whose every coefficient vanishes is a failure with its reason.
/// Errors: InputError when no space is small enough.
SparsePolynomials fit_sparse_polynomials(const ScatteredData& data, const SpeOptions& options, std::uint64_t seed, int threads,
                                         const std::function<void(std::size_t done, std::size_t total)>& done = {});

}  // namespace calomel
