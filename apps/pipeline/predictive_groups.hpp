#pragma once
/// What posterior.nc holds beside the draws themselves.
#include <cstdint>
#include <functional>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/posterior_file.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// What is predicted at draws, in a sampler's coordinates q.
struct Predicting {
  std::vector<Parameter> parameters;
  std::vector<Prior> priors;  ///< as the parameters
  std::function<double(const Eigen::VectorXd& q)> log_likelihood;    ///< empty: no such group
  std::function<Eigen::VectorXd(const Eigen::VectorXd& q)> history;  ///< (values of the model)
};
/// On an emulator; the fit outlives it.
Predicting predicting(const PosteriorFit& fit, const std::vector<Parameter>& parameters);

/// The groups log_likelihood (every draw), posterior_predictive (histories at evenly spaced draws of every chain), observed_data (the recorded means) and
/// prior_group.
std::vector<PosteriorGroup> predictive_groups(const Predicting& of, const Problem& problem, const SamplerResult& result, std::uint64_t seed);
/// Draws from the priors, by `seed`.
PosteriorGroup prior_group(const std::vector<Parameter>& parameters, const std::vector<Prior>& priors, std::uint64_t seed);

}  // namespace calomel
