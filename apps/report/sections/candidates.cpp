#include "apps/report/sections/candidates.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/series.hpp"
#include "apps/report/parts/elements.hpp"

namespace calomel {

namespace {

void add_parameter_columns(Table& table, const std::vector<std::string>& names, const ReportInput& input) {
  for (const auto& n : names) table.columns.push_back({n, parameter_label(input, n), 5});
}

/// Adds the values of `theta`, which is {NAME: value} or a list in declared order.
void add_theta(std::vector<Cell>& row, const Json& theta, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (theta.is_array())
      row.push_back(i < theta.size() && theta[i].is_number() ? Cell(theta[i].get<double>()) : Cell());
    else
      row.emplace_back(number_at(theta, names[i]));
  }
}

}  // namespace

Table candidate_table(const Study& study, const ReportInput& input) {
  const auto names = parameter_names(study, input);
  const Impedance z = impedance(input);
  Table t{.id = "candidates",
          .caption =
              "Candidates, each run again in the true model. Bold: the answer, the best by the true model; of MAP the emulator\u2019s mode, which the run "
              "verifies."};
  t.columns = {{"method", "Method", 4, true}, {"candidate", "Candidate", 4}};
  add_parameter_columns(t, names, input);
  const bool impedance_known = !z.density.empty() || !z.sound_speed.empty();
  if (impedance_known) t.columns.push_back({"impedance", "\u03c1c [Pa\u00b7s/m]", 4});
  t.columns.push_back({"objective_surrogate", "Objective, surrogate", 5});
  t.columns.push_back({"objective_model", "Objective, true model", 5});
  for (const auto& c : study.calibrations) {
    const auto& list = list_at(c.summary, "candidates");
    const bool maximise = text_at(part_at(c.summary, "objective"), "sense", "maximise") != "minimise";
    std::optional<double> best;
    for (const auto& x : list)
      if (const auto v = number_at(x, "objective_model"); v && (!best || (maximise ? *v > *best : *v < *best))) best = v;
    double n = 0;
    for (const auto& x : list) {
      std::vector<Cell> row{c.label, ++n};
      add_theta(row, part_at(x, "theta"), names);
      if (impedance_known) row.emplace_back(z.at(part_at(x, "theta")));
      row.emplace_back(number_at(x, "objective_surrogate"));
      row.emplace_back(number_at(x, "objective_model"));
      if (c.method == "map" ? n == 1 : best && number_at(x, "objective_model") == best)
        for (auto& cell : row) cell.strong = true;
      t.rows.push_back(std::move(row));
    }
  }
  return t;
}

Table round_table(const Study& study, const ReportInput& input) {
  const auto names = parameter_names(study, input);
  Table t{.id = "rounds", .caption = "Every round's best point on the surrogate."};
  t.columns = {{"round", "Round", 4}, {"optimizer", "Optimiser", 4, true}};
  add_parameter_columns(t, names, input);
  t.columns.push_back({"objective", "Objective", 5});
  double n = 0;
  if (const auto* enc = study.calibration("enc"))
    for (const auto& r : list_at(enc->summary, "rounds")) {
      std::vector<Cell> row{++n, text_at(r, "optimizer")};
      add_theta(row, part_at(r, "theta"), names);
      row.emplace_back(number_at(r, "objective"));
      t.rows.push_back(std::move(row));
    }
  return t;
}

Html candidates_section(const Study& study, const ReportInput& input) {
  if (study.calibrations.empty()) return no_calibration(input, "Candidates come from a calibration.");
  const Table table = candidate_table(study, input);
  Html s = table.empty() ? missing("No candidates are listed in the calibration.") : table.html();
  if (!impedance(input).ridge()) {
    s += paragraph_of("note", "Density and sound speed of the liquid are not both calibrated here, so there is no \u03c1\u2013c ridge to show.");
  } else if (!study.calibration("enc")) {
    s += missing("The \u03c1\u2013c ridge is drawn from the rounds of enc.json, which is missing.",
                 fragment("Make it with ", command(input, "calibrate", "--method enc"), "."));
  } else {
    s += plot("ridge-plot",
              "Every round\u2019s best density and sound speed, coloured by the objective on the surrogate. The line is \u03c1c = const through the calibrated "
              "point: these records hardly distinguish rounds along it.",
              "Scatter of density and sound speed with the line of constant impedance");
  }
  const Table rounds = round_table(study, input);
  return s + folded("All " + std::to_string(rounds.rows.size()) + " rounds", rounds);
}

Json ridge_json(const Study& study, const ReportInput& input, std::size_t points) {
  const Impedance z = impedance(input);
  const auto* enc = study.calibration("enc");
  if (!z.ridge() || !enc) return nullptr;
  const auto names = parameter_names(study, input);
  const auto value = [&](const Json& theta, const std::string& name) -> std::optional<double> {
    if (!theta.is_array()) return number_at(theta, name);
    const auto i = std::size_t(std::find(names.begin(), names.end(), name) - names.begin());
    return i < theta.size() && theta[i].is_number() ? std::optional(theta[i].get<double>()) : std::nullopt;
  };
  Json list = Json::array();
  const auto& rounds = list_at(enc->summary, "rounds");
  const auto step = stride(rounds.size(), points);
  for (std::size_t i = 0; i < rounds.size(); i += step) {
    const auto rho = value(part_at(rounds[i], "theta"), z.density);
    const auto c = value(part_at(rounds[i], "theta"), z.sound_speed);
    const auto objective = number_at(rounds[i], "objective");
    if (rho && c && objective) list.push_back({rounded(*rho, 5), rounded(*c, 5), rounded(*objective, 5), text_at(rounds[i], "optimizer")});
  }
  Json marks = Json::array();
  const auto add_mark = [&](const std::string& label, const Json& theta) {
    const auto rho = number_at(theta, z.density);
    const auto speed = number_at(theta, z.sound_speed);
    if (rho && speed) marks.push_back({{"label", label}, {"x", rounded(*rho, 6)}, {"y", rounded(*speed, 6)}});
  };
  for (const auto& c : study.calibrations) add_mark(c.label, part_at(c.summary, "theta"));
  add_mark("nominal", part_at(enc->summary, "nominal"));
  const auto best = z.at(part_at(enc->summary, "theta"));
  return {{"points", std::move(list)},
          {"marks", std::move(marks)},
          {"product", best ? rounded(*best, 6) : Json()},
          {"x_label", parameter_label(input, z.density)},
          {"y_label", parameter_label(input, z.sound_speed)},
          {"value_label", text_at(part_at(enc->summary, "objective"), "name", "objective")},
          {"minimise", text_at(part_at(enc->summary, "objective"), "sense") == "minimise"}};
}

}  // namespace calomel
