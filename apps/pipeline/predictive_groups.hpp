#pragma once
/// What posterior.nc holds beside the draws themselves.
#include <cstdint>
#include <functional>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/posterior_file.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// What is predicted at draws, in a sampler's coordinates q.
struct Predicting {
  std::vector<Parameter> parameters;
  std::vector<Prior> priors;                                         ///< as the parameters
  std::function<double(const Eigen::VectorXd& q)> log_prior;         ///< the log density in q without the log likelihood, which is what is left of a draw's own
  std::function<Eigen::VectorXd(const Eigen::VectorXd& q)> history;  ///< (values of the model)
  Eigen::VectorXd error_variance{};                                  ///< of the differences between a history and a mean record, on `grid`; empty: unknown
  const Decimation* grid = nullptr;
};
/// On an emulator; the fit outlives it.
Predicting predicting(const PosteriorFit& fit, const std::vector<Parameter>& parameters);

/// Standard deviation on the record times, (condition, sensor, record time), of errors whose variances are given on the grid: linear between the middles of its
/// windows, constant beyond the first and the last; NaN where nothing is recorded.
std::vector<double> error_sd(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& variance);

/// The groups log_likelihood (every draw), posterior_predictive (histories at evenly spaced draws of every chain), observed_data (the recorded means as
/// `strain`, their bands as `strain_low` and `strain_high`, and `error_sd`) and prior_group.
std::vector<PosteriorGroup> predictive_groups(const Predicting& of, const Problem& problem, const SamplerResult& result, std::uint64_t seed);
/// Draws from the priors between the parameters' bounds, by `seed`.
PosteriorGroup prior_group(const std::vector<Parameter>& parameters, const std::vector<Prior>& priors, std::uint64_t seed);

}  // namespace calomel
