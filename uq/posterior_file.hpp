#pragma once
/// posterior.nc, the draws and what belongs to them in the groups of ArviZ's schema (Kumar, Carroll, Hartikainen and Martin 2019, JOSS 4(33), 1143), readable
/// by arviz.from_netcdf, by xarray group by group and by ncdump; and posterior.json, their summary.
#include <filesystem>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "forward/parameter.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/draws.hpp"

namespace calomel {

struct Provenance;
struct SamplerResult;
struct SamplerSummary;

/// One variable of a group. values: (chain, draw, dims...), or (dims...) in a group without chains.
struct PosteriorVariable {
  std::string name;               ///< no '/' in it
  std::string unit;               ///< empty for a pure number
  std::vector<std::string> dims;  ///< beyond chain and draw
  std::vector<double> values;
  enum class Kind {
    real,
    whole,
    truth
  } kind = Kind::real;  ///< as what they are stored; a truth is a byte with the attribute dtype = "bool", as xarray does it
};

/// Values along a dimension: numbers or words, as many as it is long.
struct PosteriorCoordinate {
  std::string name;
  std::string unit;
  std::vector<double> numbers;
  std::vector<std::string> words;
};

/// One of posterior, unconstrained_posterior, sample_stats, log_likelihood, posterior_predictive, prior, prior_predictive, observed_data.
/// chain and draw are the first two dimensions of its variables, and coordinates; observed_data has neither (chains = 0).
struct PosteriorGroup {
  std::string name;
  std::size_t chains = 0, draws = 0;
  std::vector<PosteriorCoordinate> coordinates;  ///< of every dimension beside chain and draw
  std::vector<PosteriorVariable> variables;
  std::vector<int> draw_numbers = {};  ///< (draws) of the posterior's, where the group has not all of them; empty: 0, 1, ...

  [[nodiscard]] const PosteriorVariable* variable(const std::string& name) const;
};

/// The group called `name` of these draws.
PosteriorGroup group_of(const std::string& name, const Draws& draws);
/// Back to draws: the variables of a group that have no other dimension than chain and draw.
Draws draws_of(const PosteriorGroup& group);

/// posterior (quantities, with the units of the parameters of their names), unconstrained_posterior (coordinates) and sample_stats (lp, acceptance_rate;
/// energy, diverging, tree_depth of a sampler along trajectories) of a sampler's result.
std::vector<PosteriorGroup> posterior_groups(const std::vector<Parameter>& parameters, const SamplerResult& result);

/// Writes the groups in this order, each with inference_library = "calomel" and its version; the provenance stands at the root. The file depends on its content
/// alone (no time of creation). Errors: InputError when it cannot be written; ContractFailure for a group of another name, a size that does not fit or a
/// dimension without a coordinate.
void write_posterior(const std::filesystem::path& path, const std::vector<PosteriorGroup>& groups, const Provenance& provenance);
/// All groups, or those named. Errors: InputError when the file is absent or not of this form.
std::vector<PosteriorGroup> read_posterior(const std::filesystem::path& path, const std::vector<std::string>& names = {});

/// posterior.json: convergence_json and {sampler: {kind, chains, draws, acceptance, evaluations, transitions, wall_s; walkers of ensembles; log_evidence and
/// log_evidence_standard_error where there is one}, provenance}.
Json posterior_json(const Convergence& convergence, const std::string& kind, const SamplerResult& result, const Provenance& provenance);

}  // namespace calomel
