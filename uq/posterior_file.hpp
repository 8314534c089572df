#pragma once
/// posterior.nc holds the draws and their predictions in the groups of ArviZ's schema (Kumar, Carroll, Hartikainen and Martin 2019, JOSS 4(33), 1143).
/// arviz.from_netcdf, xarray (group by group) and ncdump read it. posterior.json is the summary.
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
  std::vector<std::string> dims;  ///< dimensions after chain and draw
  std::vector<double> values;
  enum class Kind { real, whole, truth } kind = Kind::real;  ///< the stored type; a truth is a byte with the attribute dtype = "bool", as xarray writes it
};

/// The values along a dimension, numbers or words, as many as the dimension is long.
struct PosteriorCoordinate {
  std::string name;
  std::string unit;
  std::vector<double> numbers;
  std::vector<std::string> words;
};

/// One group: posterior, unconstrained_posterior, sample_stats, log_likelihood, posterior_predictive, prior, prior_predictive or observed_data. chain and draw
/// are coordinates and the first two dimensions of its variables; observed_data has neither (chains = 0).
struct PosteriorGroup {
  std::string name;
  std::size_t chains = 0;
  std::size_t draws = 0;
  std::vector<PosteriorCoordinate> coordinates;  ///< one for each dimension other than chain and draw
  std::vector<PosteriorVariable> variables;
  std::vector<int> draw_numbers = {};  ///< (draws) numbers of the posterior's draws that the group holds; empty means 0, 1, ...

  [[nodiscard]] const PosteriorVariable* variable(const std::string& name) const;
};

/// These draws as the group `name`.
PosteriorGroup group_of(const std::string& name, const Draws& draws);
/// The draws of a group: its variables that have the dimensions chain and draw only.
Draws draws_of(const PosteriorGroup& group);

/// The groups of a sampler's result: posterior (quantities, with the units of the parameters of their names), unconstrained_posterior (coordinates) and
/// sample_stats (lp, acceptance_rate; also energy, diverging, tree_depth of a sampler along trajectories).
std::vector<PosteriorGroup> posterior_groups(const std::vector<Parameter>& parameters, const SamplerResult& result);

/// Writes the groups in this order, each with inference_library = "calomel" and its version, and the provenance at the root. The file depends on its content
/// alone; it holds no time of creation. Errors: InputError when it cannot be written; ContractFailure for a group of another name, a size that does not fit or
/// a dimension without a coordinate.
void write_posterior(const std::filesystem::path& path, const std::vector<PosteriorGroup>& groups, const Provenance& provenance);
/// Reads all groups, or those named. Errors: InputError when the file is absent or not of this form.
std::vector<PosteriorGroup> read_posterior(const std::filesystem::path& path, const std::vector<std::string>& names = {});

/// posterior.json: convergence_json and {sampler: {kind, chains, draws, acceptance, evaluations, transitions, wall_s; walkers that move together; log_evidence
/// and log_evidence_standard_error if estimated}, provenance}. message: the sentence about the chains.
Json posterior_json(const Convergence& convergence, const std::string& message, const SamplerResult& result, const Provenance& provenance);

}  // namespace calomel
