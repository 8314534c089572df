#include "base/provenance.hpp"
#include "inverse/comparison/comparison.hpp"

namespace calomel {

namespace {

Json json_of(const std::optional<double>& x) { return x ? Json(*x) : Json(); }

Json rows_json(const Comparison& c, const std::vector<ComparedRow>& rows, bool with_sd) {
  Json all = Json::array();
  for (const auto& r : rows) {
    Json j{{"name", r.name}, {"nominal", json_of(r.nominal)}};
    for (std::size_t m = 0; m < c.methods.size(); ++m) j[c.methods[m]] = json_of(r.values[m]);
    if (with_sd) j["map_sd"] = json_of(r.map_sd);
    all.push_back(std::move(j));
  }
  return all;
}

}  // namespace

Json comparison_json(const Comparison& c, const std::string& sentence, const Provenance& provenance) {
  Json j;
  j["methods"] = c.methods;
  j["parameters"] = rows_json(c, c.parameters, true);
  j["accuracy"] = rows_json(c, c.accuracy, false);
  j["mae"] = rows_json(c, c.mae, false);
  j["mae_unit"] = c.mae_unit;
  j["scores_on"] = c.scores_on;
  j["agreement"] = Json::array();
  for (const auto& p : c.pairs) {
    Json differences = Json::array();
    for (const auto& d : p.differences)
      differences.push_back({{"name", d.name}, {"absolute", json_of(d.absolute)}, {"percent", json_of(d.percent)}, {"in_map_sd", json_of(d.in_map_sd)}});
    j["agreement"].push_back({{"first", p.first}, {"second", p.second}, {"differences", differences}, {"largest_in_map_sd", json_of(p.largest_in_map_sd)}});
  }
  j["in_posterior"] = Json::array();
  for (const auto& p : c.in_posterior)
    j["in_posterior"].push_back({{"method", p.method}, {"distance", json_of(p.distance)}, {"share_nearer", json_of(p.share_nearer)}});
  j["agree"] = c.agree;
  j["sentence"] = sentence;
  j["effort"] = Json::array();
  for (const auto& e : c.effort)
    j["effort"].push_back({{"method", e.method},
                           {"evaluations", json_of(e.evaluations)},
                           {"evaluations_per_second", json_of(e.evaluations_per_second())},
                           {"model_runs", json_of(e.model_runs)},
                           {"search_s", json_of(e.search_s)},
                           {"model_s", json_of(e.model_s)}});
  j["provenance"] = provenance.json();
  return j;
}

}  // namespace calomel
