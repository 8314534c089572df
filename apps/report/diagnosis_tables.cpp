#include "apps/report/diagnosis_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "apps/report/html.hpp"
#include "apps/report/tables.hpp"
#include "apps/report/traces.hpp"
#include "base/json.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

namespace {

constexpr double significant = 0.05;  ///< q-value below which a part of the mismatch is no chance
constexpr double far = 1;             ///< deviations from the handbook that are set in bold

const Json& summary_of(const Study& study) {
  static const Json nothing;
  return study.diagnosis ? study.diagnosis->summary : nothing;
}

const Json& location_of(const Study& study) { return part_at(summary_of(study), "location"); }

/// Mean square in units of the errors' -> how many times as far apart as errors make it.
std::optional<double> mismatch(const Json& part) {
  const auto score = number_at(part, "score");
  return score ? std::optional(std::sqrt(std::max(0.0, *score))) : std::nullopt;
}

bool seen(const std::optional<double>& q) { return q && *q < significant; }
std::string seen_word(const std::optional<double>& q) { return !q ? "" : seen(q) ? "yes" : "no"; }

/// In the page's unit of time, without it.
std::string time_number(double seconds, const DisplayUnit& unit) { return fmt::format("{:.{}f}", unit.factor * seconds, unit.factor < 1e6 ? 1 : 0); }
/// Of frequencies beside such times.
DisplayUnit frequency_unit(const DisplayUnit& time) { return time.factor == 1e6 ? DisplayUnit{"kHz", 1e-3} : DisplayUnit{"Hz", 1}; }
std::string frequency_number(double hertz, const DisplayUnit& unit) { return fmt::format("{:.3g}", unit.factor * hertz); }

/// "none" and "unknown" in words; a mechanism by its plain name with its own in brackets.
std::string title_of(const Json& entry) {
  const std::string name = text_at(entry, "name"), plain = text_at(entry, "plain_name");
  if (name == "none") return "nothing is left out";
  if (name == "unknown") return "something that was not tried";
  return plain.empty() || plain == name ? name : plain + " (" + name + ")";
}

bool in_verdict(const Study& study, const std::string& name) {
  const Json& list = list_at(summary_of(study), "mechanisms");
  return std::find(list.begin(), list.end(), name) != list.end() || (list.empty() && text_at(summary_of(study), "verdict") == name);
}

std::string paragraph(const std::string& text, const char* kind = "") {
  return text.empty() ? "" : fmt::format("<p{}>{}</p>\n", *kind ? fmt::format(" class=\"{}\"", kind) : "", escape_html(text));
}

std::string lower_first(std::string text) {
  if (!text.empty()) text[0] = char(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string heading(const char* text) { return fmt::format("<h3>{}</h3>\n", text); }

/// What the four verdicts mean.
std::string meaning(const std::string& verdict) {
  static const std::map<std::string, std::string> all{
      {"named",
       "One explanation passes every test: it accounts for most of the mismatch, leads all others, is as strong as is plausible, and leaves the material's "
       "properties no farther from the handbook."},
      {"none",
       "The simulation as it is passes: it differs from the records by no more than is known of their errors. Effects too small to show may be there all the "
       "same."},
      {"ambiguous", "Two explanations or more do equally well with these gauges. None of them may be taken for the cause before a further measurement."},
      {"unknown",
       "The simulation as it is does not explain the records, and nothing that was tried passes every test. No cause is named, on purpose: a wrong name costs "
       "more than none."}};
  const auto found = all.find(verdict);
  return found == all.end() ? "" : found->second;
}

std::string where_and_when(const Study& study) {
  const Json &region = part_at(location_of(study), "region"), &windows = list_at(location_of(study), "windows"), &bands = list_at(location_of(study), "bands");
  std::string s;
  if (const auto gauge = text_at(region, "first_sensor"); !gauge.empty()) {
    const double from = number_at(region, "first_time_s").value_or(0);
    s = from > 0 ? fmt::format("The mismatch is first seen at gauge {} from {} {} on.", gauge, time_number(from, study.time), study.time.name)
                 : fmt::format("Gauge {} shows the mismatch from the start of its record.", gauge);
  } else {
    s = "No single stretch of time of one gauge stands out.";
  }
  const Json& sensors = list_at(location_of(study), "sensors");
  const auto share = [](const Json& parts) {  // of those that were recorded
    std::size_t all = 0, shows = 0;
    for (const auto& p : parts)
      if (const auto q = number_at(p, "q_value")) ++all, shows += seen(q);
    return fmt::format("{} of {}", shows, all);
  };
  return s + fmt::format(" Over the whole record it shows at {} gauges; over all gauges in {} stretches of time and in {} bands of frequency.", share(sensors),
                         share(windows), share(bands));
}

/// "the fit of ...: message", of the first that the verdict hangs on and that has not settled.
std::string unsettled_fit(const Json& d) {
  const Json& names = list_at(d, "unsettled");
  const std::string name = !names.empty() && names[0].is_string() ? names[0].get<std::string>() : "base";
  for (const auto& r : list_at(d, "ranking"))
    if (text_at(r, "name") == name) return fmt::format("the fit of {}: {}", title_of(r), text_at(r, "message", "not settled"));
  return "the fit of the base model: " + text_at(part_at(d, "base_fit"), "message", "not settled");
}

/// Of an unknown verdict: the first explanation of the ranking, where its evidence alone would do for a name; else null.
const Json* nearest_refused(const Json& d) {
  if (text_at(d, "verdict") != "unknown") return nullptr;
  for (const auto& r : list_at(d, "ranking")) {
    if (text_at(r, "name") == "none" || text_at(r, "name") == "unknown") continue;
    return number_at(r, "log_bayes_factor").value_or(0) >= Gates{}.log_bayes_factor && !text_at(r, "why").empty() ? &r : nullptr;
  }
  return nullptr;
}

}  // namespace

Table mismatch_table(const Study& study) {
  Table t{.id = "diagnosis_gauges", .caption = "How far simulation and record are apart, by gauge."};
  t.columns = {{"gauge", "Gauge", 4, true},
               {"mismatch", "Mismatch [times the errors]", -1},
               {"q_value", "q-value", 2},
               {"seen", "More than chance", 4, true},
               {"before", "Misfit as it is [%]", -1, false, percent},
               {"after", "Misfit with what is named [%]", -1, false, percent},
               {"heldout_before", "Left out of the fit, as it is [%]", -1, false, percent},
               {"heldout_after", "Left out of the fit, with what is named [%]", -1, false, percent}};
  const Json &sensors = list_at(location_of(study), "sensors"), &gauges = list_at(summary_of(study), "gauges");
  const bool named = !list_at(summary_of(study), "mechanisms").empty();
  for (const auto& s : sensors) {
    const auto of = std::find_if(gauges.begin(), gauges.end(), [&](const Json& g) { return text_at(g, "name") == text_at(s, "name"); });
    const Json& g = of == gauges.end() ? part_at(Json(), "") : *of;
    const auto q = number_at(s, "q_value");
    t.rows.push_back({text_at(s, "name"), Cell(mismatch(s), seen(q)), q, seen_word(q), number_at(g, "before"), named ? Cell(number_at(g, "after")) : Cell(),
                      number_at(g, "heldout_before"), named ? Cell(number_at(g, "heldout_after")) : Cell()});
  }
  t.note =
      "Mismatch 1 is what errors alone make; 3 is three times as far apart. The q-value is the share of false alarms among parts as striking as this one; "
      "below 0.05 it is bold. Misfit is the distance from the record "
      "over the record\u2019s own size, at the frequencies that are compared; left out of the fit: as the fit to the other faces\u2019 gauges predicts it.";
  return t;
}

/// Beam powers, where there are several: what the fit to the others predicts of each.
Table condition_table(const Study& study) {
  Table t{.id = "diagnosis_conditions", .caption = "Misfit of each condition by the fit to the other conditions."};
  const bool named = !list_at(summary_of(study), "mechanisms").empty();
  t.columns = {{"condition", "Condition", 4, true},
               {"heldout_before", "As it is [%]", -1, false, percent},
               {"heldout_after", "With what is named [%]", -1, false, percent}};
  for (const auto& c : list_at(summary_of(study), "conditions"))
    t.rows.push_back({text_at(c, "name"), number_at(c, "heldout_before"), named ? Cell(number_at(c, "heldout_after")) : Cell()});
  return t;
}

/// One row a gauge and part of its record, and one a part of all records.
void add_map_rows(Table& t, const Study& study, const char* parts_key, const char* map_key, const std::pair<const char*, const char*>& range) {
  const Json &l = location_of(study), &parts = list_at(l, parts_key), &sensors = list_at(l, "sensors"), &map = list_at(l, map_key),
             &q = list_at(l, std::string(map_key) + "_q_values");
  const auto row = [&](const std::string& name, const Json& p, const Json& score, const std::optional<double>& q_value) {
    t.rows.push_back(
        {name, number_at(p, range.first), number_at(p, range.second), Cell(mismatch({{"score", score}}), seen(q_value)), q_value, seen_word(q_value)});
  };
  for (std::size_t i = 0; i < map.size() && i < sensors.size(); ++i)
    for (std::size_t w = 0; w < map[i].size() && w < parts.size(); ++w)
      row(text_at(sensors[i], "name"), parts[w], map[i][w],
          i < q.size() && w < q[i].size() && q[i][w].is_number() ? std::optional(q[i][w].get<double>()) : std::nullopt);
  for (const auto& p : parts) row("all", p, part_at(p, "score"), number_at(p, "q_value"));
}

Table mismatch_map_table(const Study& study) {
  Table t{.id = "diagnosis_map", .caption = "Mismatch by gauge and stretch of time."};
  t.columns = {{"gauge", "Gauge", 4, true},
               {"begin_s", "From [" + study.time.name + "]", 4, false, study.time.factor},
               {"end_s", "To [" + study.time.name + "]", 4, false, study.time.factor},
               {"mismatch", "Mismatch [times the errors]", -1},
               {"q_value", "q-value", 2},
               {"seen", "More than chance", 4, true}};
  add_map_rows(t, study, "windows", "map", {"begin_s", "end_s"});
  return t;
}

Table band_table(const Study& study) {
  Table t{.id = "diagnosis_bands", .caption = "Mismatch by gauge and band of frequencies."};
  const DisplayUnit f = frequency_unit(study.time);
  t.columns = {{"gauge", "Gauge", 4, true},
               {"low_hz", "From [" + f.name + "]", 3, false, f.factor},
               {"high_hz", "To [" + f.name + "]", 3, false, f.factor},
               {"mismatch", "Mismatch [times the errors]", -1},
               {"q_value", "q-value", 2},
               {"seen", "More than chance", 4, true}};
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
  for (const auto& r : list_at(summary_of(study), "ranking")) {
    const std::string name = text_at(r, "name");
    const bool tried = part_at(r, "heldout_tried") == Json(true), strong = in_verdict(study, name);
    t.rows.push_back({Cell(title_of(r), strong), Cell(number_at(r, "probability"), strong), number_at(r, "log_evidence"), number_at(r, "log_bayes_factor"),
                      part_at(r, "fitted") == Json(true) ? Cell(number_at(r, "explained")) : Cell(), tried ? Cell(number_at(r, "heldout_gain")) : Cell(),
                      text_at(r, "size")});
  }
  t.note = fmt::format(
      "Bold is the verdict. Evidence is the logarithm of how many times likelier the records are with this alone than with the simulation as it is and "
      "anything else beside it; of what was not tried, with anything else "
      "beside what was. The log Bayes factor allows anything else beside both. An effect is given with one standard deviation; those of explanations that do "
      "not lead are estimates to first order. Probabilities are "
      "cautious: they stand for the evidences to the power of 1/{:.2g}. A name asks for more than to lead: for a log Bayes factor of {:.2g}, evidence {:.2g} "
      "above that of the next, and a probability above {:.0f} %. Where the verdict is unknown, what has the evidence but fails another of the rule's tests "
      "has no probability: it speaks for something else that acts alike.",
      Gates{}.temperature, Gates{}.log_bayes_factor, Gates{}.lead, 100 * Gates{}.believed);
  return t;
}

Table reason_table(const Study& study) {
  Table t{.id = "diagnosis_reasons", .caption = "Why each of them is named or not, and what would change that."};
  t.columns = {{"explanation", "Explanation", 4, true}, {"why", "Why, or why not", 4, true}, {"would_change", "What would change it", 4, true}};
  for (const auto& r : list_at(summary_of(study), "ranking"))
    if (const auto why = text_at(r, "why"); !why.empty())
      t.rows.push_back({Cell(title_of(r), in_verdict(study, text_at(r, "name"))), why, text_at(r, "would_change")});
  return t;
}

Table missing_table(const Study& study) {
  Table t{.id = "diagnosis_missing", .caption = "Terms that would do what is missing, the one that says most first."};
  t.columns = {
      {"what", "Change of", 4, true}, {"place", "Where", 4, true}, {"value", "By", 4, true}, {"log_bayes_factor", "Log Bayes factor beside those above", 3}};
  for (const auto& m : list_at(part_at(summary_of(study), "missing"), "terms"))
    t.rows.push_back({text_at(m, "what"), text_at(m, "place"), text_at(m, "value"), number_at(m, "log_bayes_factor")});
  t.note =
      "Estimates to first order about the base fit, with one standard deviation. A term stands for physics without a name: look for what could do the same "
      "there. Places are parts that were laid down beforehand; what is missing may be smaller, or reach beyond.";
  return t;
}

Table effect_table(const Study& study) {
  Table t{.id = "diagnosis_effects", .caption = "The numbers that were found, of every explanation that was fitted."};
  t.columns = {{"explanation", "Explanation", 4, true},        {"number", "Number", 4, true},    {"value", "Found", 4, true},
               {"off", "In the simulation as it is", 4, true}, {"deviations", "Apart [sd]", -1}, {"doc", "What it is", 4, true}};
  for (const auto& r : list_at(summary_of(study), "ranking")) {
    if (part_at(r, "fitted") != Json(true)) continue;
    for (const auto& p : list_at(r, "parameters"))
      t.rows.push_back(
          {text_at(r, "name"), text_at(p, "name"), text_at(p, "value"), text_at(p, "off"), number_at(p, "deviations_from_off"), text_at(p, "doc")});
  }
  return t;
}

Table handbook_table(const Study& study, const ReportInput& input) {
  const bool named = !list_at(summary_of(study), "mechanisms").empty();
  Table t{.id = "diagnosis_parameters", .caption = "The case\u2019s own parameters, before and after, against the handbook."};
  t.columns = {{"parameter", "Parameter", 4, true},  {"handbook", "Handbook", 4}, {"handbook_sd", "sd", 2},
               {"before", "Simulation as it is", 4}, {"before_sd", "sd", 2},      {"before_apart", "apart [sd of the handbook]", -1}};
  if (named)
    for (const auto& column : {Column{"after", "With what is named", 4}, Column{"after_sd", "sd", 2}, Column{"after_apart", "apart [sd of the handbook]", -1}})
      t.columns.push_back(column);
  const Json &all = part_at(summary_of(study), "base_parameters"), &before = part_at(all, "before"), &after = part_at(all, "after"),
             &handbook = part_at(all, "handbook");
  if (!before.is_object()) return t;
  for (const auto& [name, value] : before.items()) {
    const Json& known = part_at(handbook, name);
    std::vector<Cell> row{parameter_label(input, name), number_at(known, "mean"), number_at(known, "sd")};
    const auto add = [&](const Json& fit) {
      const auto mean = number_at(fit, "mean"), centre = number_at(known, "mean"), sd = number_at(known, "sd"), log_sd = number_at(known, "log_sd");
      const auto apart = !mean || !centre || !sd ? std::nullopt
                         : log_sd                ? std::optional(std::log(*mean / *centre) / *log_sd)
                                                 : std::optional((*mean - *centre) / *sd);
      row.emplace_back(mean), row.emplace_back(number_at(fit, "sd")), row.emplace_back(apart, apart && std::abs(*apart) > far);
    };
    add(value);
    if (named) add(part_at(after, name));
    t.rows.push_back(std::move(row));
  }
  t.note =
      "A parameter that a fit pushes away from the handbook (bold from one standard deviation on) often stands in for something that is left out. The sd of "
      "the handbook is what was known before the records.";
  return t;
}

std::string verdict_html(const Study& study) {
  if (!study.diagnosis) return "";
  const Json& d = summary_of(study);
  const std::string finding = text_at(d, "finding"), next = text_at(d, "next_step");
  if (finding.empty()) return paragraph("Diagnosis: " + text_at(d, "verdict", "no verdict") + ". " + text_at(d, "reason"), "outcome");
  return fmt::format("<p class=\"outcome verdict\"><strong>{}</strong> {} <a href=\"#diagnosis\">The evidence</a></p>\n", escape_html(finding),
                     escape_html(next));
}

std::string diagnosis_section(const Study& study, const ReportInput& input) {
  if (!study.diagnosis) return "";
  const Json& d = summary_of(study);
  const std::string verdict = text_at(d, "verdict");
  std::string s = fmt::format("<p>Verdict: <strong>{}</strong>. {}</p>\n", escape_html(verdict), escape_html(meaning(verdict)));
  if (text_at(d, "status", "done") != "done") s += missing("<strong>Not to be trusted:</strong> " + escape_html(unsettled_fit(d)) + ".");
  if (const Json* nearest = nearest_refused(d))
    s += fmt::format("<p>What comes nearest of what was tried, {}, is not named: {}</p>\n", escape_html(title_of(*nearest)),
                     escape_html(lower_first(text_at(*nearest, "why"))));

  s += heading("Where");
  if (!input.sensors.empty())
    s += "<div class=\"target\"><div id=\"mismatch-view\" class=\"target-view\" role=\"img\" aria-label=\"The target, its gauges and the walls about them "
         "coloured by mismatch; the table below gives the numbers\"></div>"
         "<div id=\"mismatch-scale\"></div>"
         "<p class=\"note\" id=\"mismatch-note\">Gauges and the wall about them are coloured by how far simulation and record are apart there; walls far from "
         "any gauge stay grey, for nothing is known of them. A label gives the mismatch in times the errors. Drag to turn, scroll to "
         "zoom.</p></div>\n";
  s += paragraph(where_and_when(study)) + mismatch_table(study).html();
  if (const Table t = condition_table(study); !t.empty()) s += t.html();

  s += heading("When, and at which frequencies");
  s += plot("mismatch-map",
            "Mismatch in times the errors, by gauge and stretch of time. Framed and bold: more than chance (q below 0.05). What is not framed may be chance.",
            "Map of the mismatch by gauge and time");
  s += plot("mismatch-bands", "The same by gauge and band of frequencies.", "Map of the mismatch by gauge and frequency");
  s += folded("The map as a table", mismatch_map_table(study)) + folded("The bands as a table", band_table(study));

  s += heading("What");
  s += plot("probability-bars",
            "Probability of each explanation among all that are listed. Dark: the verdict, which asks for more than to lead; the reasons are below.",
            "Bars of the probabilities");
  s += explanation_table(study).html() + reason_table(study).html();
  if (const Table t = effect_table(study); !t.empty())
    s += t.rows.size() > 8 ? folded(fmt::format("All {} numbers that were found", t.rows.size()), t) : t.html();
  if (const auto sentence = text_at(part_at(d, "missing"), "sentence"); !sentence.empty()) {
    s += heading("What is missing acts like this") + paragraph(sentence);
    if (const Table t = missing_table(study); !t.empty()) s += t.html();
  }

  s += heading("Every gauge\u2019s record");
  if (!study.diagnosis->histories)
    s += missing("diagnosis.nc is missing or belongs to another diagnosis, so the histories are not drawn.",
                 "Make it with " + command(input, "diagnose") + "; runs that were made are taken from the journal.");
  else
    s += "<p>\u201cFitted without this gauge\u201d is a prediction: this gauge and those on its face took no part in the fit. An explanation that is right "
         "brings it nearer to the record, too. Drag across a plot to zoom in time.</p>\n"
         "<div id=\"diagnosis-controls\" class=\"controls\"></div>\n<div id=\"diagnosis-plots\" class=\"plots\"></div>\n";

  s += heading("The material against the handbook");
  s += handbook_table(study, input).html();
  if (const Json& absorbed = list_at(d, "absorbed"); !absorbed.empty()) {
    std::string names;
    for (const auto& a : absorbed)
      names += (names.empty() ? "" : ", ") +
               fmt::format("{} by {:.1f} standard deviations", text_at(a, "parameter"), std::abs(number_at(a, "prior_sigmas").value_or(0)));
    s += paragraph("The simulation as it is pushes away from the handbook: " + names +
                   ". Values that were calibrated with it should not be read as properties of the material.");
  }

  s += heading("What could not be told apart, and what would tell");
  std::string alike;
  for (const auto& r : list_at(d, "ranking"))
    for (const auto& other : list_at(r, "same_as"))
      if (other.is_string() && text_at(r, "name") < other.get<std::string>())
        alike += "<li>" + escape_html(text_at(r, "name") + " and " + other.get<std::string>()) + "</li>\n";
  s += alike.empty() ? paragraph("No two explanations that were fitted do the same to these gauges.")
                     : "<p>These do the same to these gauges, whichever is the cause:</p>\n<ul>\n" + alike + "</ul>\n";
  if (const auto separating = text_at(d, "separating_measurement"); !separating.empty())
    s += paragraph("The measurement that would tell most: " + separating + ".");
  const Json& skipped = list_at(d, "skipped");
  s += paragraph(skipped.empty() ? "Nothing that was offered was left untried." : "Not tried:");
  if (!skipped.empty()) {
    s += "<ul>\n";
    for (const auto& x : skipped) s += "<li>" + escape_html(x.is_string() ? x.get<std::string>() : x.dump()) + "</li>\n";
    s += "</ul>\n";
  }
  if (const auto runs = number_at(d, "runs")) s += "<p>It cost " + number_html(*runs, 6) + " runs of the model (each the mean over the pulse energies).</p>\n";
  return s + "<p class=\"note\">When not to trust a verdict: docs/how-to/read_a_verdict.md.</p>\n";
}

Json diagnosis_drawings(const Study& study) {
  if (!study.diagnosis) return nullptr;
  const DisplayUnit frequency = frequency_unit(study.time);
  const Json &d = summary_of(study), &l = location_of(study);
  const auto part = [](const Json& p) {
    const auto m = mismatch(p);
    return Json{{"mismatch", m ? rounded(*m, 4) : Json()}, {"significant", seen(number_at(p, "q_value"))}};
  };
  Json gauges = Json::array(), rows = Json::array(), columns = Json::array(), bands = Json::array(), bars = Json::array();
  std::map<std::string, Json> by_sensor;  // the worst condition of each
  const Json& told = list_at(d, "gauges");
  for (const auto& s : list_at(l, "sensors")) {
    Json p = part(s);
    p["name"] = text_at(s, "name");
    rows.push_back(p);
    const auto of = std::find_if(told.begin(), told.end(), [&](const Json& g) { return text_at(g, "name") == text_at(s, "name"); });
    const std::string sensor = of == told.end() ? text_at(s, "name") : text_at(*of, "sensor");
    Json& worst = by_sensor[sensor];
    if (worst.is_null() || number_at(p, "mismatch") > number_at(worst, "mismatch")) worst = p;
    worst["name"] = sensor;
  }
  for (const auto& [name, g] : by_sensor) gauges.push_back(g);
  for (const auto& w : list_at(l, "windows")) {
    Json p = part(w);
    p["label"] = time_number(number_at(w, "begin_s").value_or(0), study.time) + "\u2013" + time_number(number_at(w, "end_s").value_or(0), study.time);
    columns.push_back(std::move(p));
  }
  for (const auto& b : list_at(l, "bands")) {
    Json p = part(b);
    p["label"] = frequency_number(number_at(b, "low_hz").value_or(0), frequency) + "\u2013" + frequency_number(number_at(b, "high_hz").value_or(0), frequency);
    bands.push_back(std::move(p));
  }
  const auto cells = [&](const char* key) {
    Json all = Json::array();
    const Json &map = list_at(l, key), &q = list_at(l, std::string(key) + "_q_values");
    for (std::size_t i = 0; i < map.size(); ++i) {
      Json row = Json::array();
      for (std::size_t w = 0; w < map[i].size(); ++w)
        row.push_back(part({{"score", map[i][w]}, {"q_value", i < q.size() && w < q[i].size() ? q[i][w] : Json()}}));
      all.push_back(std::move(row));
    }
    return all;
  };
  for (const auto& r : list_at(d, "ranking"))
    bars.push_back(
        {{"label", title_of(r)}, {"probability", rounded(number_at(r, "probability").value_or(0), 4)}, {"strong", in_verdict(study, text_at(r, "name"))}});
  const Json times{{"axis", "time [" + study.time.name + "]"}, {"columns", columns}, {"cells", cells("map")}},
      by_frequency{{"axis", "frequency [" + frequency.name + "]"}, {"columns", bands}, {"cells", cells("band_map")}};
  return {{"gauges", gauges}, {"rows", rows}, {"times", times}, {"bands", by_frequency}, {"bars", bars}};
}

}  // namespace calomel
