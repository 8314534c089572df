#include "apps/report/sections/diagnosis_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/numbers.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

const Json& diagnosis_summary(const Study& study) {
  static const Json nothing;
  return study.diagnosis ? study.diagnosis->summary : nothing;
}

const Json& diagnosis_location(const Study& study) { return part_at(diagnosis_summary(study), "location"); }

std::optional<double> mismatch(const Json& part) {
  const auto score = number_at(part, "score");
  return score ? std::optional(std::sqrt(std::max(0.0, *score))) : std::nullopt;
}

bool significant(const std::optional<double>& q) {
  constexpr double greatest = 0.05;
  return q && *q < greatest;
}

DisplayUnit frequency_unit(const DisplayUnit& time) { return time.factor == 1e6 ? DisplayUnit{"kHz", 1e-3} : DisplayUnit{"Hz", 1}; }

std::string explanation_title(const Json& entry) {
  const std::string name = text_at(entry, "name");
  const std::string plain = text_at(entry, "plain_name");
  if (name == "none") return "nothing is left out";
  if (name == "unknown") return "something that was not tried";
  return plain.empty() || plain == name ? name : plain + " (" + name + ")";
}

bool in_verdict(const Study& study, const std::string& name) {
  const Json& list = list_at(diagnosis_summary(study), "mechanisms");
  return std::find(list.begin(), list.end(), name) != list.end() || (list.empty() && text_at(diagnosis_summary(study), "verdict") == name);
}

namespace {

constexpr double far = 1;  ///< handbook standard deviations above which a distance is set in bold

std::string significant_word(const std::optional<double>& q) { return !q ? "" : significant(q) ? "yes" : "no"; }

/// Adds a row for each gauge and part of its record, and a row for each part of all records. `range` has the keys of a part's ends.
void add_map_rows(Table& t, const Study& study, const char* parts_key, const char* map_key, const std::pair<const char*, const char*>& range) {
  const Json& l = diagnosis_location(study);
  const Json& parts = list_at(l, parts_key);
  const Json& sensors = list_at(l, "sensors");
  const Json& map = list_at(l, map_key);
  const Json& q = list_at(l, std::string(map_key) + "_q_values");
  const auto row = [&](const std::string& name, const Json& p, const Json& score, const std::optional<double>& q_value) {
    t.rows.push_back({name, number_at(p, range.first), number_at(p, range.second), Cell(mismatch({{"score", score}}), significant(q_value)), q_value,
                      significant_word(q_value)});
  };
  for (std::size_t i = 0; i < map.size() && i < sensors.size(); ++i)
    for (std::size_t w = 0; w < map[i].size() && w < parts.size(); ++w)
      row(text_at(sensors[i], "name"), parts[w], map[i][w],
          i < q.size() && w < q[i].size() && q[i][w].is_number() ? std::optional(q[i][w].get<double>()) : std::nullopt);
  for (const auto& p : parts) row("all", p, part_at(p, "score"), number_at(p, "q_value"));
}

}  // namespace

Table mismatch_table(const Study& study) {
  Table t{.id = "diagnosis_gauges", .caption = "Difference of simulation and record, by gauge."};
  t.columns = {{"gauge", "Gauge", 4, true},
               {"mismatch", "Mismatch [units of the errors]", -1},
               {"q_value", "q-value", 2},
               {"seen", "Significant", 4, true},
               {"before", "Misfit, base [%]", -1, false, percent},
               {"after", "Misfit, explained [%]", -1, false, percent},
               {"heldout_before", "Left out of the fit, base [%]", -1, false, percent},
               {"heldout_after", "Left out of the fit, explained [%]", -1, false, percent}};
  const Json& sensors = list_at(diagnosis_location(study), "sensors");
  const Json& gauges = list_at(diagnosis_summary(study), "gauges");
  const bool named = !list_at(diagnosis_summary(study), "mechanisms").empty();
  for (const auto& s : sensors) {
    const auto of = std::find_if(gauges.begin(), gauges.end(), [&](const Json& g) { return text_at(g, "name") == text_at(s, "name"); });
    const Json& g = of == gauges.end() ? part_at(Json(), "") : *of;
    const auto q = number_at(s, "q_value");
    t.rows.push_back({text_at(s, "name"), Cell(mismatch(s), significant(q)), q, significant_word(q), number_at(g, "before"),
                      named ? Cell(number_at(g, "after")) : Cell(), number_at(g, "heldout_before"), named ? Cell(number_at(g, "heldout_after")) : Cell()});
  }
  t.note =
      "A mismatch of 1 is the size of the errors alone, 3 is three times that. The q-value is the share of false alarms among parts with at least this "
      "mismatch; below 0.05 it is bold. Misfit is the distance from the record over the size of the record, at the compared frequencies. The columns of "
      "left-out gauges use the prediction of a fit to the gauges of the other faces.";
  return t;
}

Table condition_table(const Study& study) {
  Table t{.id = "diagnosis_conditions", .caption = "Misfit of each condition by the fit to the other conditions."};
  const bool named = !list_at(diagnosis_summary(study), "mechanisms").empty();
  t.columns = {{"condition", "Condition", 4, true}, {"heldout_before", "Base [%]", -1, false, percent}, {"heldout_after", "Explained [%]", -1, false, percent}};
  for (const auto& c : list_at(diagnosis_summary(study), "conditions"))
    t.rows.push_back({text_at(c, "name"), number_at(c, "heldout_before"), named ? Cell(number_at(c, "heldout_after")) : Cell()});
  return t;
}

Table mismatch_map_table(const Study& study) {
  Table t{.id = "diagnosis_map", .caption = "Mismatch by gauge and interval of time."};
  t.columns = {{"gauge", "Gauge", 4, true},
               {"begin_s", "From [" + study.time.name + "]", 4, false, study.time.factor},
               {"end_s", "To [" + study.time.name + "]", 4, false, study.time.factor},
               {"mismatch", "Mismatch [units of the errors]", -1},
               {"q_value", "q-value", 2},
               {"seen", "Significant", 4, true}};
  add_map_rows(t, study, "windows", "map", {"begin_s", "end_s"});
  return t;
}

Table band_table(const Study& study) {
  Table t{.id = "diagnosis_bands", .caption = "Mismatch by gauge and band of frequencies."};
  const DisplayUnit f = frequency_unit(study.time);
  t.columns = {{"gauge", "Gauge", 4, true},
               {"low_hz", "From [" + f.name + "]", 3, false, f.factor},
               {"high_hz", "To [" + f.name + "]", 3, false, f.factor},
               {"mismatch", "Mismatch [units of the errors]", -1},
               {"q_value", "q-value", 2},
               {"seen", "Significant", 4, true}};
  add_map_rows(t, study, "bands", "band_map", {"low_hz", "high_hz"});
  return t;
}

Table explanation_table(const Study& study) {
  Table t{.id = "diagnosis_explanations", .caption = "What was tried, the most probable first."};
  t.columns = {{"explanation", "Explanation", 4, true},
               {"probability", "Probability [%]", -1, false, percent},
               {"evidence", "Evidence", 3},
               {"log_bayes_factor", "Log Bayes factor", 3},
               {"explained", "Accounts for [% of the mismatch]", -1, false, percent},
               {"heldout_gain", "Misfit of gauges left out falls by [%]", -1, false, percent},
               {"size", "Size of the effect", 4, true}};
  for (const auto& r : list_at(diagnosis_summary(study), "ranking")) {
    const std::string name = text_at(r, "name");
    const bool tried = part_at(r, "heldout_tried") == Json(true);
    const bool strong = in_verdict(study, name);
    t.rows.push_back({Cell(explanation_title(r), strong), Cell(number_at(r, "probability"), strong), number_at(r, "log_evidence"),
                      number_at(r, "log_bayes_factor"), part_at(r, "fitted") == Json(true) ? Cell(number_at(r, "explained")) : Cell(),
                      tried ? Cell(number_at(r, "heldout_gain")) : Cell(), text_at(r, "size")});
  }
  t.note = fmt::format(
      "Bold is the verdict. Evidence is the log Bayes factor of this explanation alone over the base model with any discrepancy. For untried causes it is that "
      "of the tried explanations with any discrepancy. The column log Bayes factor allows any discrepancy in both models. An effect is given with one standard "
      "deviation; those of explanations that do "
      "not lead are estimates to first order. Probabilities are cautious: they use the evidences to the power of 1/{:.2g}. A name needs more than the highest "
      "probability: a log Bayes factor of {:.2g}, "
      "evidence {:.2g} "
      "above that of the next, and a probability above {:.0f} %. If the verdict is unknown, an explanation that has the evidence but fails another test of the "
      "rule has no probability, because it points to an untried effect with a similar action.",
      Gates{}.temperature, Gates{}.log_bayes_factor, Gates{}.lead, 100 * Gates{}.believed);
  return t;
}

Table reason_table(const Study& study) {
  Table t{.id = "diagnosis_reasons", .caption = "Why each explanation is named or not, and what would change that."};
  t.columns = {{"explanation", "Explanation", 4, true}, {"why", "Why, or why not", 4, true}, {"would_change", "What would change it", 4, true}};
  for (const auto& r : list_at(diagnosis_summary(study), "ranking"))
    if (const auto why = text_at(r, "why"); !why.empty())
      t.rows.push_back({Cell(explanation_title(r), in_verdict(study, text_at(r, "name"))), why, text_at(r, "would_change")});
  return t;
}

Table missing_table(const Study& study) {
  Table t{.id = "diagnosis_missing", .caption = "Terms that would reproduce the missing effect, by decreasing evidence."};
  t.columns = {
      {"what", "Change of", 4, true}, {"place", "Where", 4, true}, {"value", "By", 4, true}, {"log_bayes_factor", "Log Bayes factor beside those above", 3}};
  for (const auto& m : list_at(part_at(diagnosis_summary(study), "missing"), "terms"))
    t.rows.push_back({text_at(m, "what"), text_at(m, "place"), text_at(m, "value"), number_at(m, "log_bayes_factor")});
  t.note =
      "Estimates to first order about the base fit, with one standard deviation. A term represents physics without a name: look for a cause with the same "
      "effect "
      "there. The places were chosen in advance; the missing effect may act on a smaller or larger part.";
  return t;
}

Table effect_table(const Study& study) {
  Table t{.id = "diagnosis_effects", .caption = "The numbers that were found, of every explanation that was fitted."};
  t.columns = {{"explanation", "Explanation", 4, true},        {"number", "Number", 4, true},    {"value", "Found", 4, true},
               {"off", "In the simulation as it is", 4, true}, {"deviations", "Apart [sd]", -1}, {"doc", "What it is", 4, true}};
  for (const auto& r : list_at(diagnosis_summary(study), "ranking")) {
    if (part_at(r, "fitted") != Json(true)) continue;
    for (const auto& p : list_at(r, "parameters"))
      t.rows.push_back(
          {text_at(r, "name"), text_at(p, "name"), text_at(p, "value"), text_at(p, "off"), number_at(p, "deviations_from_off"), text_at(p, "doc")});
  }
  return t;
}

Table handbook_table(const Study& study, const ReportInput& input) {
  const bool named = !list_at(diagnosis_summary(study), "mechanisms").empty();
  Table t{.id = "diagnosis_parameters", .caption = "The case\u2019s own parameters, before and after, against the handbook."};
  t.columns = {{"parameter", "Parameter", 4, true},  {"handbook", "Handbook", 4}, {"handbook_sd", "sd", 2},
               {"before", "Simulation as it is", 4}, {"before_sd", "sd", 2},      {"before_apart", "apart [sd of the handbook]", -1}};
  if (named)
    for (const auto& column :
         {Column{"after", "With the named mechanism", 4}, Column{"after_sd", "sd", 2}, Column{"after_apart", "apart [sd of the handbook]", -1}})
      t.columns.push_back(column);
  const Json& all = part_at(diagnosis_summary(study), "base_parameters");
  const Json& before = part_at(all, "before");
  const Json& after = part_at(all, "after");
  const Json& handbook = part_at(all, "handbook");
  if (!before.is_object()) return t;
  for (const auto& [name, value] : before.items()) {
    const Json& known = part_at(handbook, name);
    std::vector<Cell> row{parameter_label(input, name), number_at(known, "mean"), number_at(known, "sd")};
    const auto add = [&](const Json& fit) {
      const auto mean = number_at(fit, "mean");
      const auto centre = number_at(known, "mean");
      const auto sd = number_at(known, "sd");
      const auto log_sd = number_at(known, "log_sd");
      const auto apart = !mean || !centre || !sd ? std::nullopt
                         : log_sd                ? std::optional(std::log(*mean / *centre) / *log_sd)
                                                 : std::optional((*mean - *centre) / *sd);
      row.emplace_back(mean);
      row.emplace_back(number_at(fit, "sd"));
      row.emplace_back(apart, apart && std::abs(*apart) > far);
    };
    add(value);
    if (named) add(part_at(after, name));
    t.rows.push_back(std::move(row));
  }
  t.note =
      "A parameter that a fit pushes away from the handbook (bold from one standard deviation on) often compensates for an omitted effect. The sd of "
      "the handbook is that of the prior.";
  return t;
}

}  // namespace calomel
