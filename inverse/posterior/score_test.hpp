#pragma once
/// Score tests: whether the residual of a fit points where physics that was left out would show, though the covariance it is judged by is too wide.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "forward/simulation/mechanism_directions.hpp"
#include "inverse/posterior/log_posterior.hpp"

namespace calomel {

/// A number of a mechanism as the residual would have it, to first order, the fitted parameters moving with it.
struct ScoredKey {
  std::string name;
  double value = 0, sd = 0;  ///< sd by the scale of what remains
};

struct ScoreTest {
  std::string name;
  int directions = 0;
  double chi2_drop = 0;  ///< share of chi-squared in its directions
  double f = 0, p_value = 1;
  double f_of_runs = 1;  ///< mean F of the emulator's residuals at its runs, at which nothing was missing; 1 where there are none
  bool counts = true;    ///< not MechanismDirections::like_the_mesh
  std::vector<ScoredKey> keys;
};

struct ScoreTests {
  std::vector<ScoreTest> mechanisms;  ///< the most telling first
  double scale = 1;         ///< mean square of the whitened residual outside the parameters' directions: 1 where the covariance is as wide as the residual
  double p_value = 1;       ///< least of those that count, times their number
  bool stands_out = false;  ///< p_value below least_score_p
  bool with_runs = false;   ///< F is held against runs at which nothing was missing

  /// The most telling one of those that count, or null.
  [[nodiscard]] const ScoreTest* first() const;
  /// Number of those that count.
  [[nodiscard]] std::size_t counted() const;
};

constexpr double least_score_p = 1e-3;
constexpr const char* gauge_gains_name = "gauge_gains";  ///< of the test that gauge_gains() is for

/// Score tests with a free scale. The whitened residual at a mode, outside the directions of the fitted parameters and of the multiple beyond the finest mesh,
/// is split into the part in the k directions of a mechanism and the rest: F = (|part|^2 / k) / (|rest|^2 / (values - n - k)), of Fisher's distribution for a
/// Gaussian residual, or multivariate t, of the given covariance times any factor. So a covariance that is too wide by a factor takes nothing from its power,
/// and the residual's size alone says nothing. Directions that whiten to nothing beside the parameters' are left out; a mechanism with none has p_value 1.
/// `nothing_missing`: residuals of the emulator at its runs (values, k): where their mean F is above 1, numerical noise looks like the mechanism, and F is held
/// against that mean: p_value is that of F / max(1, f_of_runs). Errors: contract failure where shapes do not fit.
[[nodiscard]] ScoreTests score_tests(const LogPosterior& posterior, const LogPosterior::Point& at, const Decimation& grid,
                                     const std::vector<MechanismDirections>& left_out, const Eigen::MatrixXd& nothing_missing = {});

/// What another gain of each gauge would do: nothing that the case could enable, but errors of the load, of gauges and of an answer that lies off show as
/// amplitudes that do not fit together. `history`: (values of the model) at the answer.
[[nodiscard]] MechanismDirections gauge_gains(const Problem& problem, const std::vector<double>& history);

/// For map.json. sentence: what the tests show, for people.
Json score_tests_json(const ScoreTests& tests, const std::string& sentence);

}  // namespace calomel
