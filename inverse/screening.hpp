#pragma once
/// Whether a residual points where physics that was left out would show, though the covariance it is judged by is too wide.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "inverse/likelihood/likelihood.hpp"

namespace calomel {

/// How physics that the model leaves out would change its values, to first order.
struct LeftOut {
  std::string name;               ///< of the mechanism, or gauge_gains
  std::vector<std::string> keys;  ///< its numbers
  std::vector<double> off;        ///< their values that switch it off
  Eigen::MatrixXd directions;     ///< (values of the model, keys): change of the model's values per unit of the key
  bool like_the_mesh = false;     ///< damping, lag: a coarse mesh does the same, so that it is told but does not count
};

/// A number of a mechanism as the residual would have it, to first order, the fitted parameters moving with it.
struct ScreenedKey {
  std::string name;
  double value = 0, sd = 0;  ///< sd by the scale of what remains
};

struct ScreenedMechanism {
  std::string name;
  int directions = 0;
  double chi2_drop = 0;  ///< share of chi-squared in its directions
  double f = 0, p_value = 1;
  double f_of_pairs = 1;  ///< mean F of the residuals at which nothing was missing; 1 where there are none
  bool counts = true;     ///< not LeftOut::like_the_mesh
  std::vector<ScreenedKey> keys;
};

struct Screening {
  std::vector<ScreenedMechanism> mechanisms;  ///< the most telling first
  double scale = 1;        ///< mean square of the whitened residual outside the parameters' directions: 1 where the covariance is as wide as the residual
  double p_value = 1;      ///< least of those that count, times their number
  bool stands_out = false; ///< p_value below least_screening_p
  std::string sentence;
};

constexpr double least_screening_p = 1e-3;

/// Score tests with a free scale. The whitened residual, outside the directions of the fitted parameters (`jacobian`, whitened, (values, n)), is split into
/// the part in the k directions of a mechanism and the rest: F = (|part|^2 / k) / (|rest|^2 / (values - n - k)), of Fisher's distribution for a Gaussian
/// residual, or multivariate t, of the given covariance times any factor. So a covariance that is too wide by a factor takes nothing from its power, and the residual's size
/// alone tells nothing. Directions that whiten to nothing beside the parameters' are left out; a mechanism with none has p_value 1.
/// `nothing_missing`: residuals of fits (values, k) whose records the model itself made, a mesh's error among them; where their mean F is above 1, the error of the
/// model's numerics looks like the mechanism, and F is held against that mean: p_value is that of F / max(1, f_of_pairs).
/// Errors: contract failure where shapes do not fit.
[[nodiscard]] Screening screen(const Likelihood& likelihood, const Eigen::VectorXd& residual, const Eigen::MatrixXd& jacobian, const std::vector<LeftOut>& left_out,
                               const Eigen::MatrixXd& nothing_missing = {});

/// What another gain of each gauge would do: nothing that the case could enable, but errors of the load, of gauges and of an answer that lies off show as amplitudes
/// that do not fit together. `history`: (values of the model) at the answer.
[[nodiscard]] LeftOut gauge_gains(const Problem& problem, const std::vector<double>& history);

/// For map.json.
Json screening_json(const Screening& screening);

}  // namespace calomel
