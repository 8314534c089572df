#include "apps/report/sections/emulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "apps/presentation/data_check_words.hpp"
#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"

namespace calomel {

namespace {

constexpr double notable_deviation = 1;  ///< prior standard deviations above which a nuisance is set in bold

const Json& map_json_of(const Study& study) {
  static const Json nothing;
  const auto* map = study.calibration("map");
  return map ? map->summary : nothing;
}

/// The emulator of MAP, else that of the posterior. They are the same when both belong to one case.
const Json& emulator_of(const Study& study) {
  static const Json nothing;
  const Json& of_map = part_at(map_json_of(study), "emulator");
  return of_map.is_object() ? of_map : study.sample ? part_at(*study.sample, "mode") : nothing;
}

/// The check of the emulator against the true model, of MAP, else of the posterior.
const Json& check_of(const Study& study) {
  static const Json nothing;
  const Json& of_map = part_at(map_json_of(study), "true_model_check");
  return of_map.is_object() ? of_map : study.sample ? part_at(*study.sample, "true_model_check") : nothing;
}

std::string level_name(std::size_t level) { return level == 0 ? "finest" : level == 1 ? "next coarser" : fmt::format("{} coarser", level); }

/// A sentence as a paragraph. It begins with a capital and ends with a stop. Bad news is strong.
Html sentence_html(std::string text, bool bad = false) {
  if (text.empty()) return {};
  text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
  if (!text.ends_with('.')) text += '.';
  return bad ? paragraph(strong(text)) : paragraph(text);
}

}  // namespace

Table nuisance_table(const Study& study) {
  Table t{.id = "nuisances", .caption = "Nuisance coordinates of the posterior (not parameters of the case), with their priors."};
  t.columns = {{"name", "Coordinate", 4, true},
               {"value", "Value", 4},
               {"sd", "Sd", 2},
               {"prior_value", "Prior", 4},
               {"prior_sd", "Sd of the prior", 2},
               {"pull", "Deviation [sd of the prior]", -2}};
  for (const auto& n : list_at(map_json_of(study), "nuisances")) {
    const auto deviation = number_at(n, "pull");
    t.rows.push_back({text_at(n, "name"), number_at(n, "value"), number_at(n, "sd"), number_at(n, "prior_value"), number_at(n, "prior_sd"),
                      Cell(deviation, deviation && std::abs(*deviation) > notable_deviation)});
  }
  t.note =
      "\u201cbeyond\u201d is the multiple of the last difference between meshes that is added to the finest mesh. A deviation above one (bold) suggests "
      "that the coordinate compensates for an omitted effect.";
  return t;
}

Table emulator_table(const Study& study) {
  Table t{.id = "emulator", .caption = "Training runs of the emulator, by mesh, and its errors [% of a run]."};
  t.columns = {{"mesh", "Mesh", 4, true},
               {"runs", "Runs", 6},
               {"left_out", "Error at a run that is left out [%]", -2, false, percent},
               {"noise", "Numerical noise of a run [%]", -2, false, percent}};
  std::size_t level = 0;
  for (const auto& l : list_at(emulator_of(study), "levels"))
    t.rows.push_back({level_name(level++), number_at(l, "runs"), number_at(l, "left_out"), number_at(l, "noise")});
  t.note = "The error at a left-out run of a valid emulator is little above the numerical noise, which no emulator predicts.";
  return t;
}

Table share_table(const Study& study) {
  Table t{.id = "covariance_shares", .caption = "Terms of the covariance of the errors: shares of its trace."};
  t.columns = {{"term", "Term", 4, true}, {"share", "Share [%]", -1, false, percent}};
  if (const Json& shares = part_at(emulator_of(study), "covariance_shares"); shares.is_object())
    for (const auto& [name, share] : shares.items())
      if (share.is_number()) t.rows.push_back({name, share.get<double>()});
  std::stable_sort(t.rows.begin(), t.rows.end(), [](const auto& a, const auto& b) { return std::get<double>(a[1].value) > std::get<double>(b[1].value); });
  return t;
}

Table prior_deviation_table(const Study& study) {
  constexpr std::size_t most = 10;
  Table t{.id = "pulls", .caption = "Estimates of the marginalised nuisance parameters, the largest deviation first."};
  t.columns = {{"number", "Number", 4, true}, {"pull", "Deviation [sd of the prior]", -1}, {"sd", "Sd [sd of the prior]", -2}};
  for (const auto& p : list_at(emulator_of(study), "pulls"))
    if (t.rows.size() < most) t.rows.push_back({nuisance_name(text_at(p, "term"), text_at(p, "gauge")), number_at(p, "pull"), number_at(p, "sd")});
  t.note = "If a deviation exceeds three, the prior is wrong, or the parameter compensates for an effect that the model omits.";
  return t;
}

Html emulator_section(const Study& study) {
  const Json& map = map_json_of(study);
  const Json& emulator = emulator_of(study);
  const Json& check = check_of(study);
  const auto fails = [](const Json& json, const char* key) { return part_at(json, key) == Json(false); };
  Html s = sentence_html(text_at(map, "identified")) + sentence_html(text_at(map, "adequacy"), fails(map, "adequate")) +
           sentence_html(text_at(part_at(map, "score_tests"), "sentence"));
  if (const auto message = text_at(emulator, "message"); !message.empty()) s += sentence_html("the emulator: " + message, fails(emulator, "settled"));
  s += sentence_html(text_at(check, "sentence"), fails(check, "holds"));
  return s + shown(nuisance_table(study)) + shown(prior_deviation_table(study)) + shown(emulator_table(study)) + shown(share_table(study));
}

}  // namespace calomel
