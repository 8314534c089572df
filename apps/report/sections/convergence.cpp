#include "apps/report/sections/convergence.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/lines.hpp"

namespace calomel {

namespace {

/// The name of the objective of the first calibration that has one.
std::string objective_name(const Study& study) {
  for (const auto& c : study.calibrations)
    if (auto name = text_at(part_at(c.summary, "objective"), "name"); !name.empty()) return name;
  return "objective";
}

/// Calls f(function's name, optimiser's entry) for each optimiser of optimizer_comparison.json.
template <class F>
void for_each_trial(const Study& study, const F& f) {
  if (!study.optimizer_comparison) return;
  for (const auto& target : list_at(*study.optimizer_comparison, "targets"))
    for (const auto& method : list_at(target, "methods")) f(text_at(target, "name"), method);
}

/// Calls f(evaluations, mean, sd) for each entry of an optimiser whose three values are numbers.
template <class F>
void for_each_point(const Json& method, const F& f) {
  const Json& x = list_at(method, "evaluations");
  const Json& mean = list_at(method, "mean");
  const Json& sd = list_at(method, "sd");
  for (std::size_t i = 0; i < std::min({x.size(), mean.size(), sd.size()}); ++i)
    if (x[i].is_number() && mean[i].is_number() && sd[i].is_number()) f(x[i].get<double>(), mean[i].get<double>(), sd[i].get<double>());
}

}  // namespace

Table optimizer_table(const Study& study) {
  const auto* enc = study.calibration("enc");
  Table t{.id = "optimizers", .caption = "Best " + objective_name(study) + " of each round, by optimiser (on the surrogate)."};
  t.columns = {{"optimizer", "Optimiser", 4, true}, {"rounds", "Rounds", 4}, {"mean", "Mean", 5}, {"sd", "Standard deviation", 3}, {"best", "Best", 5}};
  if (enc)
    for (const auto& o : list_at(enc->summary, "optimizers"))
      t.rows.push_back({text_at(o, "name"), number_at(o, "rounds"), number_at(o, "mean"), number_at(o, "sd"), number_at(o, "best")});
  return t;
}

Table convergence_table(const Study& study) {
  Table t{.id = "convergence", .caption = "Best objective so far, by generation, in the best round of each optimiser."};
  t.columns = {{"optimizer", "Optimiser", 4, true}, {"generation", "Generation", 6}, {"objective", "Best objective so far", 6}};
  if (const auto* enc = study.calibration("enc"))
    for (const auto& o : list_at(enc->summary, "optimizers")) {
      double generation = 0;
      for (const auto& x : list_at(o, "trace")) t.rows.push_back({text_at(o, "name"), generation++, x.is_number() ? Cell(x.get<double>()) : Cell()});
    }
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
  Table t{.id = "objectives", .caption = "The optimum of each formulation of the misfit on the surrogate, and its score in the true model."};
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
    Cell mean;
    Cell sd;
    for_each_point(method, [&](double, double m, double s) {
      mean = Cell(m);
      sd = Cell(s);
    });
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
      line["x"].push_back(x);
      line["y"].push_back(mean);
      line["low"].push_back(mean - 3 * sd);
      line["high"].push_back(mean + 3 * sd);
    });
    // The frame spans the decay after the first points, which are random. Bands beyond the frame are cut.
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

namespace {

Html optimizer_comparison(const Study& study) {
  const Json figures = decay_json(study);
  Html s;
  for (std::size_t i = 0; i < figures.size(); ++i)
    s += plot("decay-plot-" + std::to_string(i),
              "Best value so far against evaluations on " + figures[i]["title"].get<std::string>() +
                  ": mean of the trials, shaded three standard deviations to either side, cut at the frame.",
              "Decay of the optimisers");
  return s + shown(trial_table(study));
}

}  // namespace

Html convergence_section(const Study& study, const ReportInput& input) {
  const Html compared = optimizer_comparison(study);
  if (!study.calibration("enc"))
    return compared + missing("Optimiser rounds belong to the evolutionary neural calibration, which has not been run (enc.json).",
                              fragment("Run it with ", command(input, "calibrate", "--method enc"), "."));
  Html s = convergence_table(study).empty()
               ? missing("enc.json holds no traces of the optimisers.")
               : plot("convergence-plot", "Best objective so far by generation, in the best round of each optimiser.", "Convergence of each optimiser");
  const Table agreement = optimizer_agreement_table(study);
  s += shown(agreement.empty() ? optimizer_table(study) : agreement);
  return s + shown(formulation_table(study, input)) + compared;
}

Json convergence_json(const Study& study) {
  const Table t = convergence_table(study);
  if (t.empty()) return nullptr;
  const Json& objective = part_at(study.calibration("enc")->summary, "objective");  // the table is empty without ENC
  return {{"lines", lines_json(t, {2})}, {"x_label", "generation"}, {"y_label", "best " + text_at(objective, "name", "objective") + " so far"}};
}

}  // namespace calomel
