#pragma once
/// Multistart least squares of a model with cheap runs. It gives the first box of the emulator and the starts of the chains.
#include <optional>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

struct MultistartFit {
  std::vector<double> theta;              ///< of least |whitened residual|^2 - 2 log prior
  Eigen::MatrixXd covariance;             ///< of the parameters' coordinates (Parameter::coordinate), of Gauss and Newton
  std::vector<std::vector<double>> ends;  ///< of all descents, among them `theta`
  double chi2 = 0;                        ///< of the records' errors
  Eigen::Index values = 0;                ///< records' values compared
  int runs = 0;                           ///< that were requested
};

/// Where the search begins.
struct MultistartOptions {
  std::size_t design_runs = 32, design_runs_a_parameter = 24;
  std::size_t descents = 5;                 ///< from the best points of the design
  int iterations = 60;                      ///< of a descent, at most
  double tolerance = 1e-9;                  ///< of the sum of squares, relative, in an iteration
  std::vector<std::vector<double>> starts;  ///< (n_parameters) further ones, natural units
  const ErrorModel* errors = nullptr;       ///< of the records; none: those of the inputs without a discrepancy
};

/// What two runs of nearly one point, 1e-6 prior widths apart at the nominal values, differ by: next to nothing of a model that repeats itself.
struct Jitter {
  double standard_errors = 0;  ///< of all values together: |L^-1 (run 2 - run 1)|, L L^T the covariance of the records' errors. Above 1 the model's own jitter
                               ///< (steps that it chooses itself, a loose tolerance) hides a standard error, and its finite differences are useless
  double variance = 0;         ///< of one run, summed over the values compared, in the square of the records' unit
};

/// Nothing where a run fails.
[[nodiscard]] std::optional<Jitter> jitter_of_the_model(const PosteriorInputs& in);

/// Runs a design over the priors, then least squares (Levenberg and Marquardt, gradients by finite differences) from the best points of it and from those that
/// are given. Errors: NumericsError when no run comes through; those of in.run.
[[nodiscard]] MultistartFit multistart_least_squares(const PosteriorInputs& in, const MultistartOptions& options = {});

/// A fit of a model whose runs carry no noise, held to the model: least squares by the model itself from the fit's mode, under the errors that are likeliest
/// there, gives the mode; the emulator is shifted so that it is the run there, and its own noise, which was what a quadratic misses, counts no more as an error
/// of the records. Unchanged where no run comes through.
[[nodiscard]] PosteriorFit held_to_the_model(const PosteriorInputs& in, PosteriorFit fit);

/// Puts the first box of `in` about that start: as wide as the data alone would leave it, with errors as large as the residuals, and no wider than the priors.
void place_box_by_least_squares(PosteriorInputs& in, const MultistartOptions& options = {});

}  // namespace calomel
