#include <cmath>

#include "base/json.hpp"
#include "base/provenance.hpp"
#include "inverse/map/map.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"

namespace calomel {

namespace {

constexpr double quantile95 = 1.959964;

Json directions_json(const Identification& id, const ModelShape& shape) {
  Json all = Json::array();
  for (const auto& d : id.directions) {
    Json exponents = Json::object();
    for (std::size_t k = 0; k < id.parameters.size(); ++k) exponents[shape.parameters[id.parameters[k]].name] = d.exponents[Eigen::Index(k)];
    all.push_back({{"product", d.product},
                   {"exponents", exponents},
                   {"value", number(d.value)},
                   {"low", number(d.value * std::exp(-quantile95 * d.sd))},
                   {"high", number(d.value * std::exp(quantile95 * d.sd))},
                   {"log_sd", number(d.sd)},
                   {"log_sd_of_data", number(d.data_sd)},
                   {"log_sd_of_prior", number(d.prior_sd)}});
  }
  return all;
}

Json combinations_json(std::span<const Combination> combinations) {
  Json all = Json::array();
  for (const auto& c : combinations)
    all.push_back({{"name", c.name}, {"value", number(c.value)}, {"low", number(c.low)}, {"high", number(c.high)}, {"relative_sd", number(c.relative_sd)}});
  return all;
}

}  // namespace

Json map_json(const MapSummary& s, const PosteriorInputs& in, const PosteriorFit& fit, const MapWords& words, const Provenance& provenance) {
  const auto& shape = in.problem.shape;
  Json own;
  own["parameters"] = Json::array();
  own["sd"] = Json::object();
  for (std::size_t k = 0; k < shape.parameters.size(); ++k) {
    own["parameters"].push_back(shape.parameters[k].name);
    own["sd"][shape.parameters[k].name] = number(std::sqrt(s.covariance(Eigen::Index(k), Eigen::Index(k))));
  }
  own["covariance"] = matrix_json(s.covariance);
  own["nuisances"] = Json::array();
  for (const auto& x : s.nuisances)
    own["nuisances"].push_back({{"name", x.name},
                                {"value", number(x.value)},
                                {"sd", number(x.sd)},
                                {"prior_value", number(x.prior_value)},
                                {"prior_sd", number(x.prior_sd)},
                                {"pull", number(x.deviation)}});
  own["log_likelihood"] = number(s.log_likelihood);
  own["log_prior"] = number(s.log_prior);
  own["log_evidence_laplace"] = number(s.log_evidence_laplace);
  own["chi2"] = number(s.fit.chi2);
  own["values"] = s.fit.values;
  own["effective_data"] = number(s.fit.effective_data);
  own["effective_chi2"] = number(s.fit.effective_chi2);
  own["p_value"] = number(s.fit.p_value);
  own["effective_p_value"] = number(s.fit.effective_p_value);
  own["chi2_critical"] = number(s.fit.chi2_critical);
  own["adequate"] = s.adequate;
  own["adequacy"] = words.adequacy;
  if (s.score_tests) own["score_tests"] = score_tests_json(*s.score_tests, words.score_tests);
  own["identified"] = words.identified;
  own["directions"] = directions_json(s.identification, shape);
  own["combinations"] = combinations_json(s.identification.combinations);
  const auto& noise = fit.errors->noise();
  std::vector<double> noise_time;
  for (const auto& n : noise.series) noise_time.push_back(n.time);
  own["replicates"] = {{"energy_sd", number(noise.energy_sd)}, {"split_half", number(noise.split_half)}, {"noise_time_s", numbers(noise_time)}};
  own["emulator"] = fit_json(fit, in.parameters, words.emulator);
  own["true_model_check"] = check_json(s.check, in.parameters, words.check);
  if (s.nested) own["nested_model"] = nested_json(*s.nested, in.parameters, words.nested);
  return calibration_json(s, in.problem, own, words.calibration, provenance);
}

void write_map(const MapSummary& s, const PosteriorInputs& in, const PosteriorFit& fit, const MapWords& words, const Provenance& provenance,
               const std::filesystem::path& out_dir) {
  write_calibration("map", s, in.problem, map_json(s, in, fit, words, provenance), provenance, out_dir);
}

}  // namespace calomel
