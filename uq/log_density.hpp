#pragma once
/// The seam between models and samplers: a probability density on R^d, known up to a factor.
///
/// A LogDensity promises:
///  - coordinates that are unconstrained: the density is defined for every x in R^d. What lives on an interval or is positive is transformed by
///    whoever makes the density, with the Jacobian of the transformation in it (a sampler neither knows nor adds one);
///  - log_density(x) = ln p(x) + const, the constant the same at every x and in every call; minus infinity where the density is zero;
///    never NaN and never plus infinity (a sampler takes either for a defect and stops);
///  - the same value for the same x, from any thread, several at a time (the functions are const and keep nothing between calls);
///  - with has_gradient(), the exact gradient of what log_density returns, where that is finite;
///  - constrain(x), the quantities in natural units that are reported. They need not be d: a derived quantity is one more name.
/// A model that cannot be evaluated at x may return minus infinity; an exception ends the run.
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/not_finite.hpp"

namespace calomel {

inline constexpr double never = -infinity;  ///< log density of what cannot be

class LogDensity {
 public:
  virtual ~LogDensity() = default;

  /// Names of the d >= 1 coordinates, e.g. "log density".
  [[nodiscard]] virtual const std::vector<std::string>& coordinates() const = 0;
  [[nodiscard]] std::size_t dimension() const { return coordinates().size(); }

  /// ln p(x) + const; minus infinity outside of the support. x: (d).
  [[nodiscard]] virtual double log_density(std::span<const double> x) const = 0;

  [[nodiscard]] virtual bool has_gradient() const { return false; }
  /// The same value, and its gradient into `gradient`: (d). Only with has_gradient().
  virtual double log_density_and_gradient(std::span<const double> /*x*/, std::span<double> /*gradient*/) const {
    expect(false, "a gradient is asked only of a density that has one");
    return 0;
  }

  /// What is reported; the coordinates themselves unless a density overrides it.
  [[nodiscard]] virtual std::vector<std::string> quantities() const { return coordinates(); }
  /// Their values at x into `values`: (quantities), in the order of quantities().
  virtual void constrain(std::span<const double> x, std::span<double> values) const { std::copy(x.begin(), x.end(), values.begin()); }
  [[nodiscard]] std::vector<double> constrained(std::span<const double> x) const {
    std::vector<double> values(quantities().size());
    constrain(x, values);
    return values;
  }
};

}  // namespace calomel
