#include "apps/report/sections/polynomials.hpp"

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"

namespace calomel {

namespace {

const Json& spe_of(const Study& study) {
  static const Json nothing;
  const auto* spe = study.calibration("spe");
  return spe ? spe->summary : nothing;
}

}  // namespace

Table polynomial_table(const Study& study) {
  Table t{.id = "spe_surrogates", .caption = "The polynomial surrogates of the misfit, scored on the training and on the held-out runs."};
  t.columns = {{"space", "Space", 4, true},
               {"terms", "Terms", 6},
               {"nonzero", "Not zero", 6},
               {"lambda", "\u03bb", 4},
               {"lambda_fraction", "\u03bb / \u03bb_max", 3},
               {"train_rrmse", "Training error [%]", -1, false, 100},
               {"validation_rrmse", "Held-out error [%]", -1, false, 100},
               {"validation_r2", "R\u00b2, held out", 4},
               {"optima", "Optima", 4},
               {"best", "Best", 5},
               {"failure", "Left out", 4, true}};
  for (const auto& s : list_at(spe_of(study), "surrogates")) {
    const auto lambda = number_at(s, "lambda");
    const auto most = number_at(s, "lambda_max");
    t.rows.push_back({text_at(s, "name"), number_at(s, "terms"), number_at(s, "nonzero"), lambda,
                      lambda && most && *most > 0 ? std::optional(*lambda / *most) : std::nullopt, number_at(part_at(s, "train"), "rrmse"),
                      number_at(part_at(s, "validation"), "rrmse"), number_at(part_at(s, "validation"), "r2"), number_at(s, "optima"), number_at(s, "best"),
                      text_at(s, "failure")});
  }
  return t;
}

Table lambda_table(const Study& study) {
  Table t{.id = "spe_lambdas",
          .caption = "The weight \u03bb of the \u2113\u2081 norm that the held-out runs prefer, and that cross-validation of the training runs prefers."};
  t.columns = {{"space", "Space", 4, true}, {"terms", "Terms", 6}, {"lambda_max", "\u03bb_max", 4}};
  const std::pair<const char*, const char*> ways[] = {{"validation", "held-out runs"}, {"cross_validation", "cross-validation"}};
  for (const auto& [key, title] : ways) {
    const std::string k = key;
    const std::string by = title;
    t.columns.push_back({k + "_lambda", "\u03bb, " + by, 4});
    t.columns.push_back({k + "_fraction", "\u03bb / \u03bb_max, " + by, 3});
    t.columns.push_back({k + "_mean_squared_error", "Mean squared error, " + by, 4});
  }
  for (const auto& c : list_at(spe_of(study), "lambda_choices")) {
    std::vector<Cell> row{text_at(c, "name"), number_at(c, "terms"), number_at(c, "lambda_max")};
    for (const auto& [key, title] : ways)
      for (const char* part : {"lambda", "fraction", "mean_squared_error"}) row.emplace_back(number_at(part_at(c, key), part));
    t.rows.push_back(std::move(row));
  }
  if (!t.rows.empty()) t.note = "At \u03bb_max and above every coefficient vanishes. The option lambda_scale of SPE chooses between the two.";
  return t;
}

Table mode_table(const Study& study, const ReportInput& input) {
  Table t{.id = "spe_modes", .caption = "Modes of the pooled optima of all polynomial surrogates, densest first."};
  const auto names = parameter_names(study, input);
  for (const auto& n : names) t.columns.push_back({n, n, 5});
  t.columns.push_back({"density", "Share of the density", 3});
  t.columns.push_back({"optima", "Optima", 4});
  t.columns.push_back({"objective_surrogate", "Objective, surrogates", 5});
  for (const auto& m : list_at(spe_of(study), "modes")) {
    std::vector<Cell> row;
    for (const auto& n : names) row.emplace_back(number_at(part_at(m, "theta"), n));
    for (const char* key : {"density", "optima", "objective_surrogate"}) row.emplace_back(number_at(m, key));
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table polynomial_error_table(const Study& study) {
  Table t{.id = "spe_errors", .caption = "Errors of the polynomial surrogates relative to the misfit, over all of them."};
  t.columns = {{"error", "", 4, true}, {"min", "Smallest", 3}, {"mean", "Mean", 3}, {"max", "Largest", 3}};
  for (const auto& [key, title, factor] : {std::tuple{"train_rrmse", "training [%]", 100.0}, std::tuple{"validation_rrmse", "held out [%]", 100.0},
                                           std::tuple{"train_r2", "R\u00b2, training", 1.0}, std::tuple{"validation_r2", "R\u00b2, held out", 1.0}}) {
    const Json& range = part_at(spe_of(study), key);
    if (!range.is_object()) continue;
    std::vector<Cell> row{title};
    for (const char* end : {"min", "mean", "max"}) {
      const auto x = number_at(range, end);
      row.emplace_back(x ? std::optional(factor * *x) : std::nullopt);
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

Html polynomials_part(const Study& study, const ReportInput& input) {
  const Table polynomials = polynomial_table(study);
  return shown(polynomial_error_table(study)) + shown(lambda_table(study)) + shown(mode_table(study, input)) +
         folded("All " + std::to_string(polynomials.rows.size()) + " polynomial surrogates", polynomials);
}

}  // namespace calomel
