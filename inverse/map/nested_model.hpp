#pragma once
/// The Bayes factor of a model and of a nested model, which is a special case of it, on one emulator and under one covariance.
#include <string>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

enum class NestedVerdict { undecided, added_favoured, added_not_favoured };

struct NestedModel {
  std::string name;                          ///< name of the nested model, in words
  std::vector<std::string> added;            ///< the parameters that only the larger model has
  std::vector<double> theta;                 ///< mode of the nested model, in the parameters of the larger one
  double log_bayes_factor = 0;               ///< log evidence of the larger less that of the nested model, by Laplace; above 0 for the larger
  double low = 0, high = 0;                  ///< the same with priors of the added parameters twice and half as wide
  std::size_t values = 0;                    ///< values of the records that are compared
  double chi2 = 0, nested_chi2 = 0;          ///< at either mode
  double variance = 0, nested_variance = 0;  ///< of the emulator there, in units of one run's numerical noise; the densities include it
  NestedVerdict verdict = NestedVerdict::undecided;
};

/// Compares the models of a fit with a nested hypothesis; `name` and `added` are taken over from `of`. Contract: fit.nested is set.
[[nodiscard]] NestedModel compare_nested(const PosteriorFit& fit, const NestedModel& of);

/// The comparison for map.json. sentence: which model is favoured, for people.
Json nested_json(const NestedModel& nested, const std::vector<Parameter>& parameters, const std::string& sentence);

}  // namespace calomel
