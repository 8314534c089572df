#include "apps/report/comparison_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/tables.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {

/// Calls f(function's name, optimiser's entry) for each optimiser of optimizer_comparison.json.
template <class F>
void for_each_trial(const Study& study, const F& f) {
  if (!study.optimizer_comparison) return;
  for (const auto& target : list_at(*study.optimizer_comparison, "targets"))
    for (const auto& method : list_at(target, "methods")) f(text_at(target, "name"), method);
}

/// Entries (evaluations, mean, sd) that are all numbers.
template <class F>
void for_each_point(const Json& method, const F& f) {
  const Json &x = list_at(method, "evaluations"), &mean = list_at(method, "mean"), &sd = list_at(method, "sd");
  for (std::size_t i = 0; i < std::min({x.size(), mean.size(), sd.size()}); ++i)
    if (x[i].is_number() && mean[i].is_number() && sd[i].is_number()) f(x[i].get<double>(), mean[i].get<double>(), sd[i].get<double>());
}

}  // namespace

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
    const std::string key = p.second + "_less_" + p.first, title = method_label(p.second) + " \u2212 " + method_label(p.first);
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
  t.note = c.sentence;
  return t;
}

Table effort_table(const Study& study) {
  Table t{.id = "effort", .caption = "What each calibration took, beside the campaign and the training."};
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
  Table t{.id = "in_posterior", .caption = "Where the answers lie in the posterior, by MAP\u2019s mode and covariance."};
  t.columns = {
      {"method", "Method", 4, true}, {"distance", "Deviations from its mode", -2}, {"share_nearer", "Share of it that lies nearer [%]", -1, false, 100}};
  for (const auto& p : comparison_of(study).in_posterior)
    t.rows.push_back({method_label(p.method), Cell(p.distance, p.outside()), Cell(p.share_nearer, p.outside())});
  t.note = "Bold: outside the posterior, since more than 99 % of it lies nearer to its mode.";
  return t;
}

Table hypothesis_table(const Study& study) {
  Table t{.id = "hypotheses", .caption = "The model with the added parameters against the one without, on one emulator and under one covariance."};
  t.columns = {{"with", "Held against", 4, true},
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

Table optimizer_agreement_table(const Study& study) {
  Table t{.id = "optimizer_agreement", .caption = "The optimisers at the end of their rounds on the surrogate, each beside the best of all."};
  t.columns = {{"optimizer", "Optimiser", 4, true},
               {"rounds", "Rounds", 4},
               {"mean", "Mean", 5},
               {"sd", "Standard deviation", 3},
               {"best", "Best", 5},
               {"shortfall", "Best misses", 3},
               {"distance", "Distance [bounds]", 3},
               {"share_of_rounds", "Rounds that end there [%]", 3, false, 100}};
  const auto* enc = study.calibration("enc");
  if (!enc) return t;
  const Json& agreement = part_at(enc->summary, "agreement");
  for (const auto& o : list_at(agreement, "optimizers"))
    t.rows.push_back({text_at(o, "name"), number_at(o, "rounds"), number_at(o, "mean"), number_at(o, "sd"), number_at(o, "best"), number_at(o, "shortfall"),
                      number_at(o, "distance"), number_at(o, "share_of_rounds")});
  t.note = text_at(agreement, "sentence");
  return t;
}

Table formulation_table(const Study& study, const ReportInput& input) {
  Table t{.id = "objectives", .caption = "The answer by each formulation of the misfit on the surrogate, and what the true model says there."};
  t.columns = {{"objective", "Objective", 4, true}};
  const auto* enc = study.calibration("enc");
  if (!enc) return t;
  const auto names = parameter_names(study, input);
  const Json& list = list_at(part_at(enc->summary, "agreement"), "objectives");
  for (const auto& n : names) t.columns.push_back({n, n, 5});
  t.columns.push_back({"distance", "Distance [bounds]", 3});
  t.columns.push_back({"accuracy_percent", "Accuracy [%]", -1});
  t.columns.push_back({"mae", "MAE [" + display_unit(input).name + "]", -1});
  for (const auto& o : list) t.columns.push_back({"value_" + text_at(o, "name"), text_at(o, "name"), 5});
  for (const auto& o : list) {
    std::vector<Cell> row{text_at(o, "name")};
    for (const auto& n : names) row.emplace_back(number_at(part_at(o, "theta"), n));
    for (const char* key : {"distance", "accuracy", "mae"}) row.emplace_back(number_at(o, key));
    for (const auto& by : list) row.emplace_back(number_at(part_at(o, "objectives_model"), text_at(by, "name")));
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table trial_table(const Study& study) {
  Table t{.id = "optimizer_trials", .caption = "Optimisers on one surrogate each: the best values of all trials after the last evaluation."};
  t.columns = {{"function", "Surrogate", 4, true},
               {"optimizer", "Optimiser", 4, true},
               {"best", "Best", 6},
               {"mean", "Mean", 6},
               {"sd", "Standard deviation", 3},
               {"worst", "Worst", 6}};
  for_each_trial(study, [&](const std::string& name, const Json& method) {
    Cell mean, sd;
    for_each_point(method, [&](double, double m, double s) { mean = Cell(m), sd = Cell(s); });
    t.rows.push_back({name, text_at(method, "name"), number_at(method, "best"), mean, sd, number_at(method, "worst")});
  });
  return t;
}

Table decay_table(const Study& study) {
  Table t{.id = "optimizer_decay", .caption = "Best value so far against evaluations, mean and standard deviation over the trials."};
  t.columns = {{"function", "Surrogate", 4, true},
               {"optimizer", "Optimiser", 4, true},
               {"evaluations", "Evaluations", 6},
               {"mean", "Mean", 6},
               {"sd", "Standard deviation", 3}};
  for_each_trial(study, [&](const std::string& name, const Json& method) {
    for_each_point(method, [&](double x, double mean, double sd) { t.rows.push_back({name, text_at(method, "name"), x, mean, sd}); });
  });
  return t;
}

Json decay_json(const Study& study) {
  Json figures = Json::array();
  for_each_trial(study, [&](const std::string& name, const Json& method) {
    if (figures.empty() || figures.back()["title"] != name)
      figures.push_back({{"title", name},
                         {"lines", Json::array()},
                         {"x_label", "evaluations of " + name},
                         {"y_label", "best value so far"},
                         {"span", {std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()}}});
    Json& figure = figures.back();
    const auto i = figure["lines"].size();
    Json line{{"label", text_at(method, "name")},
              {"group", i},
              {"variant", i},
              {"x", Json::array()},
              {"y", Json::array()},
              {"low", Json::array()},
              {"high", Json::array()}};
    for_each_point(method, [&](double x, double mean, double sd) {
      line["x"].push_back(x), line["y"].push_back(mean), line["low"].push_back(mean - 3 * sd), line["high"].push_back(mean + 3 * sd);
    });
    // The frame spans the decay after the first, random, points; bands beyond it are cut.
    if (line["y"].size() > 1) {
      figure["span"][0] = std::min(figure["span"][0].get<double>(), number_at(method, "best").value_or(line["y"].back().get<double>()));
      figure["span"][1] = std::max(figure["span"][1].get<double>(), line["y"][1].get<double>());
      figure["lines"].push_back(std::move(line));
    }
  });
  figures.erase(std::remove_if(figures.begin(), figures.end(), [](const Json& f) { return f["lines"].empty() || !(f["span"][0] < f["span"][1]); }),
                figures.end());
  return figures.empty() ? Json() : figures;
}

}  // namespace calomel
