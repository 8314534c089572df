#pragma once
/// The uncertain parameters of a case: name, number of the case, bounds, prior and nominal value.
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/case_file.hpp"

namespace calomel {

/// `[parameter.NAME]` of a case file.
struct Parameter {
  std::string name;         ///< the table's name, not a key
  std::string key;          ///< dotted path of the number in the case
  double min = 0, max = 0;  ///< bounds, in the number's own unit
  std::string prior = "uniform";
  std::optional<double> nominal;  ///< default: the value that the case's tables give
  std::optional<double> mean, sd, mu, sigma, scale, alpha, beta;
  std::string unit = {};  ///< of the number that it is, no key; empty or "1": a pure number, or not known

  template <class V>
  void visit(V& v) {
    v("key", key,
      {.doc = "dotted path of the number in the case that this parameter is; default: the number of its name in the model's main table, material.mercury or "
              "line"});
    v("min", min, {.doc = "lower bound", .required = true});
    v("max", max, {.doc = "upper bound", .required = true});
    v("prior", prior, {.doc = "kind of prior", .choices = {"uniform", "normal", "lognormal", "truncated_normal", "half_cauchy", "beta"}});
    v("nominal", nominal, {.doc = "nominal value; default: the value in the case's tables"});
    v("mean", mean, {.doc = "of a normal or truncated normal prior"});
    v("sd", sd, {.range = above(0), .doc = "of a normal or truncated normal prior"});
    v("mu", mu, {.doc = "of a lognormal prior: mean of the logarithm"});
    v("sigma", sigma, {.range = above(0), .doc = "of a lognormal prior: sd of the logarithm"});
    v("scale", scale, {.range = above(0), .doc = "of a half-Cauchy prior"});
    v("alpha", alpha, {.range = above(0), .doc = "of a beta prior"});
    v("beta", beta, {.range = above(0), .doc = "of a beta prior"});
  }
  /// Whether it is searched and boxed by its logarithm: where its lower bound is positive.
  [[nodiscard]] bool logarithmic() const { return min > 0; }
  /// The coordinate of a value, its logarithm or itself; the value of a coordinate; and the width in the coordinate, to first order, of one in natural units
  /// about `at`.
  [[nodiscard]] double coordinate(double value) const { return logarithmic() ? std::log(value) : value; }
  [[nodiscard]] double natural(double coordinate) const { return logarithmic() ? std::exp(coordinate) : coordinate; }
  [[nodiscard]] double coordinate_width(double width, double at) const { return logarithmic() ? width / at : width; }
  /// Errors: InputError when max <= min, the nominal lies outside, or the prior lacks one of its keys.
  void validate() const;
};

/// {name: value} of the values in `theta`, (n) with n no more than the parameters.
Json named(std::span<const Parameter> parameters, std::span<const double> theta);

/// All `[parameter.*]` tables in file order; one without a key is the number of its name in `table`. Errors: InputError with the place, also for two of one
/// number, for a name that posterior.nc has for something else (chain, draw, beyond), and for one of other characters than letters, digits, _ and -, which
/// keys of runs and files cannot hold.
std::vector<Parameter> read_parameters(CaseFile& file, const std::string& table);

/// Holds each parameter against its number in the case, which is its nominal value where it has none of its own. `number`: of a parameter.
/// Errors: InputError at the parameter's place, those of `number` and of Parameter::validate.
void bind_parameters(CaseFile& file, std::vector<Parameter>& parameters, const std::function<double(const Parameter&)>& number);

}  // namespace calomel
