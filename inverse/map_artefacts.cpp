#include <cmath>

#include "base/provenance.hpp"
#include "inverse/map.hpp"

namespace calomel {

namespace {

Json pairs_json(const std::vector<std::pair<double, double>>& pairs) {
  Json all = Json::array();
  for (const auto& [scale, weight] : pairs) all.push_back({{"scale", scale}, {"weight", number(weight)}});
  return all;
}

Json directions_json(const Identification& id, const ModelShape& shape) {
  Json all = Json::array();
  for (const auto& d : id.directions) {
    Json exponents = Json::object();
    for (std::size_t k = 0; k < id.parameters.size(); ++k) exponents[shape.parameters[id.parameters[k]].name] = d.exponents[Eigen::Index(k)];
    all.push_back({{"product", d.text},
                   {"exponents", exponents},
                   {"value", number(d.value)},
                   {"low", number(d.value * std::exp(-1.959964 * d.sd))},
                   {"high", number(d.value * std::exp(1.959964 * d.sd))},
                   {"log_sd", number(d.sd)},
                   {"log_sd_of_data", number(d.data_sd)},
                   {"log_sd_of_prior", number(d.prior_sd)}});
  }
  return all;
}

/// A value of each parameter by its name; an empty object for no values. What is not finite is null.
Json by_parameter(const ModelShape& shape, const Eigen::VectorXd& values) {
  Json j = Json::object();
  for (Eigen::Index k = 0; k < values.size(); ++k) j[shape.parameters[std::size_t(k)].name] = number(values[k]);
  return j;
}

Json validation_json(const PairValidation& v, const ModelShape& shape) {
  Json pairs = Json::array();
  for (const auto& p : v.pairs) pairs.push_back({{"theta", named(shape, p.theta)}, {"found", named(shape, p.found)}, {"squared_distance", number(p.squares)}});
  return {{"inflation", v.inflation}, {"sentence", v.sentence}, {"pairs", pairs}};
}

Json refinement_json(const MapRefinement& r, const ModelShape& shape) {
  Json rounds = Json::array();
  for (const auto& round : r.rounds)
    rounds.push_back({{"runs", round.runs}, {"pairs", round.pairs}, {"failed", round.failed}, {"theta", named(shape, round.theta)}, {"moved_sds", number(round.moved)}, {"roughness_sds", number(round.roughness)}});
  return {{"rounds", rounds}, {"stable", r.stable}, {"left_out_pairs", validation_json(r.validation, shape)}, {"share_of_variance", by_parameter(shape, r.moves_share)}, {"theta_before", named(shape, r.before)}, {"surrogate_error_ratio", number(r.base_ratio)}};
}

Json mesh_json(const MapRefinement& r, const ModelShape& shape) {
  return {{"next_halving_sds", by_parameter(shape, r.next_halving)}, {"sentence", r.sentence}};
}

}  // namespace

Json map_json(const MapSummary& s, const Problem& problem, const Provenance& provenance) {
  const auto& shape = problem.shape;
  Json own;
  if (s.product == "physical")
    own["meaning"] =
        "physical: handbook priors, and a discrepancy that takes up what the model leaves out; a material property only as far as that discrepancy is a fair "
        "picture of it.";
  own["parameters"] = Json::array();
  for (const auto& p : shape.parameters) own["parameters"].push_back(p.name);
  own["covariance"] = matrix_json(s.covariance);
  own["sd"] = by_parameter(shape, s.covariance.diagonal().cwiseSqrt());
  own["widening"] = s.widening, own["curvature_seen"] = number(s.curvature_seen), own["roughness"] = number(s.roughness);
  own["log_likelihood"] = number(s.log_likelihood), own["log_prior"] = number(s.log_prior);
  own["log_evidence_laplace"] = number(s.log_evidence_laplace);
  own["chi2"] = number(s.chi2), own["values"] = s.values;
  own["effective_data"] = number(s.effective_data), own["effective_chi2"] = number(s.effective_chi2);
  own["p_value"] = number(s.p_value), own["effective_p_value"] = number(s.effective_p_value);
  own["chi2_critical"] = s.chi2_critical > 0 ? number(s.chi2_critical) : Json();
  own["adequate"] = s.adequate, own["adequacy"] = s.adequacy;
  if (s.screening) own["screening"] = screening_json(*s.screening);
  own["identified"] = s.identification.sentence;
  own["directions"] = directions_json(s.identification, shape);
  own["combinations"] = combinations_json(s.identification.combinations);
  if (s.product == "physical") own["discrepancy"] = {{"scale", s.discrepancy_scale}, {"weights", pairs_json(s.discrepancy_weights)}};
  own["covariance_shares"] = Json::object();
  for (const auto& [source, share] : s.shares) own["covariance_shares"][source] = number(share);
  own["replicates"] = {{"energy_sd", number(s.energy_sd)}, {"split_half", number(s.split_half)}, {"noise_time_s", numbers(s.noise_time)}};
  if (!s.refinement.rounds.empty()) own["added_runs"] = refinement_json(s.refinement, shape);
  if (s.rival) own["rival"] = rival_json(*s.rival, shape);
  own["surrogate_slope"] = number(s.gradient), own["polish_steps"] = s.polish_steps;
  Json json = calibration_json(s, problem, own, provenance);
  if (s.refinement.next_halving.size()) {
    json["mesh"]["scores"] = s.mesh.sentence;
    json["mesh"].update(mesh_json(s.refinement, shape));
  }
  return json;
}

void write_map(const MapSummary& s, const Problem& problem, const Provenance& provenance, const std::filesystem::path& out_dir) {
  write_calibration("map", s, problem, map_json(s, problem, provenance), provenance, out_dir);
}

}  // namespace calomel
