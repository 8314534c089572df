#pragma once
/// Bayes factor of a model and of one that it holds as a special case, on one emulator and under one covariance.
#include <string>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

enum class NestedVerdict { undecided, added_favoured, added_not_favoured };

struct NestedModel {
  std::string name;                          ///< of the nested model, in words
  std::vector<std::string> added;            ///< the parameters that only the larger model has
  std::vector<double> theta;                 ///< mode of the nested one, in the larger one's parameters
  double log_bayes_factor = 0;               ///< log evidence of the larger less that of the nested model, by Laplace; above 0 for the larger
  double low = 0, high = 0;                  ///< with priors of the added parameters twice and half as wide
  double chi2 = 0, nested_chi2 = 0;          ///< at either mode
  double variance = 0, nested_variance = 0;  ///< of the emulator there, in units of one run's numerical noise; the densities know of it
  NestedVerdict verdict = NestedVerdict::undecided;
  std::string sentence;
};

/// Of a fit with a nested hypothesis; `name` and `added` are taken over from `of`. Contract: fit.nested is there.
[[nodiscard]] NestedModel compare_nested(const PosteriorFit& fit, const NestedModel& of);

/// For map.json.
Json nested_json(const NestedModel& nested, const std::vector<Parameter>& parameters);

}  // namespace calomel
