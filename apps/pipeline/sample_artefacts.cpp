#include "apps/pipeline/sample_artefacts.hpp"

#include "apps/presentation/convergence_words.hpp"
#include "apps/presentation/fit_words.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "base/json.hpp"

namespace calomel {

Json modes_json(const LogDensity& density, const std::vector<LaplaceMode>& modes) {
  const auto names = density.quantities();
  Json all = Json::array();
  for (const auto& m : modes) {
    const auto values = density.constrained({m.x.data(), std::size_t(m.x.size())});
    Json theta = Json::object();
    for (std::size_t k = 0; k < names.size(); ++k) theta[names[k]] = values[k];
    all.push_back({{"theta", std::move(theta)}, {"share", m.weight}});
  }
  return all;
}

Json hyperparameters_json(const std::string& why_none) { return {{"draws", 0}, {"reason", why_none}}; }

Json hyperparameters_json(const std::vector<DrawnNoise>& drawn, const NoiseInflation& inflation, const std::vector<std::string>& names) {
  Json ratios = Json::array(), scales = Json::array(), weights = Json::array(), sds = Json::object(), alike = Json::object(), shifts = Json::object();
  for (const auto& d : drawn) ratios.push_back(d.noise_ratio), scales.push_back(number(d.scale));
  for (const double w : inflation.weights) weights.push_back(number(w));
  for (std::size_t k = 0; k < names.size(); ++k) {
    sds[names[k]] = number(inflation.sd_ratio[k]);
    alike[names[k]] = number(inflation.sd_ratio_alike[k]);
    shifts[names[k]] = number(inflation.shift[k]);
  }
  return {{"draws", drawn.size()},
          {"noise_ratio", ratios},
          {"noise_scale", scales},
          {"weights", weights},
          {"effective_draws", number(inflation.effective_draws)},
          {"sd_ratio", sds},
          {"sd_ratio_alike", alike},
          {"mean_shift_sds", shifts},
          {"plug_in_draws", number(inflation.plug_in_draws)},
          {"sentence", inflation_sentence(inflation, names)}};
}

Json refinement_json(const RefinedFit& fit, int most) {
  Json checks = Json::array();
  for (const auto& r : fit.refinements)
    checks.push_back({{"p_value", number(r.check.p_value)},
                      {"score", number(r.check.score)},
                      {"sentence", check_sentence(r.check)},
                      {"runs", r.runs},
                      {"box_drawn_in", r.shrank_box}});
  return {{"made", fit.refinements.size()}, {"most", most}, {"ended", refinement_end(fit.ended)}, {"sentence", refinement_sentence(fit)}, {"checks", checks}};
}

Json regions_json(const Regions& regions) {
  Json shares = Json::array();
  for (const auto& s : regions.shares) shares.push_back({{"share", s.share}, {"low", s.low}, {"high", s.high}, {"square_radius", number(s.square_radius)}});
  return {{"parameters", regions.names},
          {"mean", std::vector<double>(regions.mean.begin(), regions.mean.end())},
          {"covariance", matrix_json(regions.covariance)},
          {"shares", shares}};
}

Json compared_json(const std::string& what, const Convergence& convergence, const Regions& regions) {
  Json json{{"what", what}};
  json.update(convergence_json(convergence, convergence_sentence(convergence)));
  json["regions"] = regions_json(regions);
  return json;
}

}  // namespace calomel
