#include "apps/report/sections/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "apps/presentation/comparison_words.hpp"
#include "apps/report/data/json_values.hpp"

namespace calomel {

Comparison comparison_of(const Study& study) {
  std::vector<MethodSummary> summaries;
  for (const auto& c : study.calibrations) summaries.push_back({c.method, c.summary});
  return compare_calibrations(summaries);
}

Table agreement_table(const Study& study) {
  Table t{.id = "agreement", .caption = "How far the calibrations lie apart."};
  if (study.calibrations.size() < 2) return t;
  const Comparison c = comparison_of(study);
  t.columns = {{"parameter", "Parameter", 4, true}};
  const bool sds = std::any_of(c.parameters.begin(), c.parameters.end(), [](const auto& r) { return r.map_sd.has_value(); });
  for (const auto& p : c.pairs) {
    const std::string key = p.second + "_less_" + p.first;
    const std::string title = method_label(p.second) + " \u2212 " + method_label(p.first);
    t.columns.push_back({key + "_percent", title + " [%]", -1});
    if (sds) t.columns.push_back({key + "_in_map_sd", title + " [sd of MAP]", -1});
  }
  for (std::size_t r = 0; r < c.parameters.size(); ++r) {
    std::vector<Cell> row{c.parameters[r].name == "impedance" ? "impedance \u03c1c" : c.parameters[r].name};
    for (const auto& p : c.pairs) {
      const auto& d = p.differences[r];
      row.emplace_back(d.percent);
      if (sds) row.emplace_back(d.in_map_sd, d.in_map_sd && std::abs(*d.in_map_sd) > Comparison::notable_sds);
    }
    t.rows.push_back(std::move(row));
  }
  t.note = comparison_sentence(c);
  return t;
}

Table effort_table(const Study& study) {
  Table t{.id = "effort", .caption = "Cost of each calibration, without the campaign and the training."};
  if (study.calibrations.size() < 2) return t;
  t.columns = {{"method", "Method", 4, true},
               {"evaluations", "Evaluations of surrogates", 6},
               {"evaluations_per_second", "A second", 3},
               {"model_runs", "True-model runs", 4},
               {"search_s", "Search [s]", -1},
               {"model_s", "True model [s]", -1}};
  for (const auto& e : comparison_of(study).effort)
    t.rows.push_back({method_label(e.method), e.evaluations, e.evaluations_per_second(), e.model_runs, e.search_s, e.model_s});
  return t;
}

Table place_table(const Study& study) {
  Table t{.id = "in_posterior", .caption = "The calibrations in the posterior, by MAP\u2019s mode and covariance."};
  t.columns = {
      {"method", "Method", 4, true}, {"distance", "Deviations from its mode", -2}, {"share_nearer", "Share of it that lies nearer [%]", -1, false, 100}};
  for (const auto& p : comparison_of(study).in_posterior)
    t.rows.push_back({method_label(p.method), Cell(p.distance, p.outside()), Cell(p.share_nearer, p.outside())});
  t.note = "Bold: outside the posterior, since more than 99 % of it lies nearer to its mode.";
  return t;
}

Table hypothesis_table(const Study& study) {
  Table t{.id = "hypotheses", .caption = "The model with the added parameters against the one without, on one emulator and under one covariance."};
  t.columns = {{"with", "Compared with", 4, true},
               {"added", "Added parameters", 4, true},
               {"log_bayes_factor", "Log Bayes factor", -1},
               {"low", "Least by the prior\u2019s width", -1},
               {"high", "Greatest", -1},
               {"chi2_with", "Chi-squared with", 4},
               {"chi2_without", "Chi-squared without", 4},
               {"variance_with", "Emulator\u2019s variance with [of a run\u2019s noise]", 2},
               {"variance_without", "Without", 2}};
  const auto* map = study.calibration("map");
  if (!map) return t;
  const Json& nested = part_at(map->summary, "nested_model");
  if (!nested.is_object()) return t;
  std::string added;
  for (const auto& name : list_at(nested, "added"))
    if (name.is_string()) added += (added.empty() ? "" : ", ") + name.get<std::string>();
  t.rows.push_back({text_at(nested, "with"), added, number_at(nested, "log_bayes_factor"), number_at(nested, "low"), number_at(nested, "high"),
                    number_at(nested, "chi2"), number_at(nested, "nested_chi2"), number_at(nested, "emulator_variance"),
                    number_at(nested, "nested_emulator_variance")});
  t.note = text_at(nested, "sentence");
  return t;
}

}  // namespace calomel
