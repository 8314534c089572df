#pragma once
/// Prior densities of the parameters, and the coordinates in which they are searched.
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "forward/parameter.hpp"
#include "forward/simulation/inference_hints.hpp"

namespace calomel {

/// Density of one parameter in its own unit. uniform: on [min, max]; normal (mean, sd); truncated_normal (mean, sd) on [min, max]; lognormal
/// (mu, sigma of the logarithm) on x > 0; half_cauchy (scale) on x >= 0, 2 / (pi s (1 + (x/s)^2)); beta (alpha, beta) on
/// [min, max]. Normal, lognormal and half_cauchy densities integrate to 1 over their own support, whatever the bounds of the search.
class Prior {
 public:
  /// Errors: InputError where Parameter::validate would complain.
  explicit Prior(const Parameter& parameter);

  [[nodiscard]] const std::string& kind() const { return kind_; }
  [[nodiscard]] double low() const { return low_; }    ///< of the support
  [[nodiscard]] double high() const { return high_; }  ///< of the support
  /// -infinity outside the support.
  [[nodiscard]] double log_density(double x) const;
  [[nodiscard]] double log_density_slope(double x) const;
  /// Value with the probability u below it, 0 < u < 1.
  [[nodiscard]] double quantile(double u) const;
  /// u with quantile(u) = x: the probability below x.
  [[nodiscard]] double probability_below(double x) const;
  /// A scale of the density: sd of normal, truncated and lognormal (of ln x times its median); the interval over sqrt(12) for uniform; the scale of
  /// half_cauchy; the sd of beta.
  [[nodiscard]] double scale() const;

 private:
  std::string kind_;
  double a_ = 0, b_ = 1;  ///< the kind's two numbers
  double low_, high_;
  double log_norm_ = 0;
};

/// One prior a parameter.
std::vector<Prior> priors_of(std::span<const Parameter> parameters);
/// Sum of the log densities.
double log_prior(std::span<const Prior> priors, std::span<const double> theta);

/// Distance of a value from the middle of a normal, truncated normal or lognormal prior, in its standard deviations (of the logarithm); none of another prior.
std::optional<double> prior_deviation(const Parameter& parameter, double value);

/// Where a value is expected: within the bounds, and of a truncated normal prior within two of its standard deviations.
std::pair<double, double> expected_range(const Parameter& parameter);

/// The parameters with the handbook's priors where it has any: normal about the nominal value, or lognormal about its logarithm. Others keep the case's prior;
/// one that is uniform is refused, because a free discrepancy explains anything that such a parameter does (Brynjarsdottir and O'Hagan 2014, Inverse Problems
/// 30, 114007). Errors: InputError for such a parameter, and for a lognormal prior about a nominal value of 0.
std::vector<Parameter> with_handbook_priors(std::vector<Parameter> parameters, const std::vector<HandbookPrior>& handbook);

}  // namespace calomel
