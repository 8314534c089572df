#include "apps/report/sections/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"
#include "apps/report/sections/diagnosis_tables.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

namespace {

/// A time in the page's unit, without the unit.
std::string time_number(double seconds, const DisplayUnit& unit) { return fmt::format("{:.{}f}", unit.factor * seconds, unit.factor < 1e6 ? 1 : 0); }
std::string frequency_number(double hertz, const DisplayUnit& unit) { return fmt::format("{:.3g}", unit.factor * hertz); }

/// A sentence of the artefact as a paragraph; empty without a sentence.
Html sentence_paragraph(const std::string& text) { return text.empty() ? Html() : paragraph(text); }

std::string first_letter_small(std::string text) {
  if (!text.empty()) text[0] = char(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

/// The meaning of a verdict.
std::string meaning(const std::string& verdict) {
  static const std::map<std::string, std::string> all{
      {"named",
       "One explanation passes every test: it accounts for most of the mismatch, leads all others, is as strong as is plausible, and leaves the material's "
       "properties no farther from the handbook."},
      {"none",
       "The base simulation passes: it differs from the records by no more than their known errors. Effects that are too small to be seen remain possible."},
      {"ambiguous", "Two explanations or more do equally well with these gauges. None of them should be taken for the cause before a further measurement."},
      {"unknown",
       "The base simulation does not explain the records, and no explanation that was tried passes every test. No cause is named, because a wrong name costs "
       "more than none."}};
  const auto found = all.find(verdict);
  return found == all.end() ? "" : found->second;
}

/// The gauge and time at which the mismatch is first seen, and the numbers of gauges, windows and bands that show it.
std::string where_and_when(const Study& study) {
  const Json& location = diagnosis_location(study);
  const Json& region = part_at(location, "region");
  std::string s = "No single interval of time at one gauge dominates.";
  if (const auto gauge = text_at(region, "first_sensor"); !gauge.empty()) {
    const double from = number_at(region, "first_time_s").value_or(0);
    s = from > 0 ? fmt::format("The mismatch is first seen at gauge {} from {} {} on.", gauge, time_number(from, study.time), study.time.name)
                 : fmt::format("Gauge {} shows the mismatch from the start of its record.", gauge);
  }
  const auto share = [&](const char* key) {  // parts that show it, of those that were recorded
    std::size_t recorded = 0;
    std::size_t shows = 0;
    for (const auto& p : list_at(location, key))
      if (const auto q = number_at(p, "q_value")) {
        ++recorded;
        shows += significant(q);
      }
    return fmt::format("{} of {}", shows, recorded);
  };
  return s + fmt::format(" Over the whole record it shows at {} gauges; over all gauges in {} intervals of time and in {} bands of frequency.",
                         share("sensors"), share("windows"), share("bands"));
}

/// "the fit of ...: message": the first fit that decides the verdict and has not settled.
std::string unsettled_fit(const Json& d) {
  const Json& names = list_at(d, "unsettled");
  const std::string name = !names.empty() && names[0].is_string() ? names[0].get<std::string>() : "base";
  for (const auto& r : list_at(d, "ranking"))
    if (text_at(r, "name") == name) return fmt::format("the fit of {}: {}", explanation_title(r), text_at(r, "message", "not settled"));
  return "the fit of the base model: " + text_at(part_at(d, "base_fit"), "message", "not settled");
}

/// When the verdict is unknown: the first explanation of the ranking, if its evidence alone would suffice for a name. Null otherwise.
const Json* nearest_refused(const Json& d) {
  if (text_at(d, "verdict") != "unknown") return nullptr;
  for (const auto& r : list_at(d, "ranking")) {
    if (text_at(r, "name") == "none" || text_at(r, "name") == "unknown") continue;
    return number_at(r, "log_bayes_factor").value_or(0) >= Gates{}.log_bayes_factor && !text_at(r, "why").empty() ? &r : nullptr;
  }
  return nullptr;
}

Html where_part(const Study& study, const ReportInput& input) {
  Html s = heading("Where");
  if (!input.sensors.empty()) {
    const Html view =
        element("div", {{"id", "mismatch-view"},
                        {"class", "target-view"},
                        {"role", "img"},
                        {"aria-label", "The target, its gauges and the walls about them coloured by mismatch; the table below gives the numbers"}});
    const Html note =
        element("p", {{"class", "note"}, {"id", "mismatch-note"}},
                "Gauges and the wall about them are coloured by how far simulation and record are apart there; walls far from any gauge stay grey, because "
                "nothing is known there. A label gives the mismatch in units of the errors. Drag to turn, scroll to zoom.");
    s += element("div", {{"class", "target"}}, view, place("mismatch-scale"), note) + "\n";
  }
  return s + sentence_paragraph(where_and_when(study)) + mismatch_table(study).html() + shown(condition_table(study));
}

Html when_part(const Study& study) {
  return heading("When, and at which frequencies") +
         plot("mismatch-map",
              "Mismatch in units of the errors, by gauge and interval of time. Framed and bold: significant (q below 0.05). What is not framed may be chance.",
              "Map of the mismatch by gauge and time") +
         plot("mismatch-bands", "The same by gauge and band of frequencies.", "Map of the mismatch by gauge and frequency") +
         folded("The map as a table", mismatch_map_table(study)) + folded("The bands as a table", band_table(study));
}

Html what_part(const Study& study) {
  constexpr std::size_t most_rows = 8;  // a longer table is folded
  Html s =
      heading("What") +
      plot(
          "probability-bars",
          "Probability of each explanation among all that are listed. Dark: the verdict, which needs more than the highest probability; the reasons are below.",
          "Bars of the probabilities") +
      explanation_table(study).html() + reason_table(study).html();
  const Table effects = effect_table(study);
  s += effects.rows.size() > most_rows ? folded(fmt::format("All {} numbers that were found", effects.rows.size()), effects) : shown(effects);
  if (const auto sentence = text_at(part_at(diagnosis_summary(study), "missing"), "sentence"); !sentence.empty())
    s += heading("Behaviour of the missing effect") + paragraph(sentence) + shown(missing_table(study));
  return s;
}

Html records_part(const Study& study, const ReportInput& input) {
  const Html title = heading("Every gauge\u2019s record");
  if (!study.diagnosis->histories)
    return title + missing("diagnosis.nc is missing or belongs to another diagnosis, so the histories are not drawn.",
                           fragment("Make it with ", command(input, "diagnose"), "; runs that were made are taken from the journal."));
  return title +
         paragraph(
             "\u201cFitted without this gauge\u201d is a prediction: this gauge and those on its face took no part in the fit. A correct explanation also "
             "brings it nearer to the "
             "record. Drag across a plot to zoom in time.") +
         place("diagnosis-controls", "controls") + "\n" + place("diagnosis-plots", "plots") + "\n";
}

Html handbook_part(const Study& study, const ReportInput& input) {
  const Html table = heading("The material against the handbook") + handbook_table(study, input).html();
  std::string names;
  for (const auto& a : list_at(diagnosis_summary(study), "absorbed"))
    names += (names.empty() ? "" : ", ") +
             fmt::format("{} by {:.1f} standard deviations", text_at(a, "parameter"), std::abs(number_at(a, "prior_sigmas").value_or(0)));
  if (names.empty()) return table;
  return table + paragraph("The fit of the base simulation moves these parameters away from the handbook: " + names +
                           ". Values that were calibrated with it should not be read as properties of the material.");
}

Html alike_part(const Study& study) {
  const Json& d = diagnosis_summary(study);
  Html s = heading("What could not be distinguished, and which measurement would");
  Html alike;
  for (const auto& r : list_at(d, "ranking"))
    for (const auto& other : list_at(r, "same_as"))
      if (other.is_string() && text_at(r, "name") < other.get<std::string>()) alike += list_item(text_at(r, "name") + " and " + other.get<std::string>());
  s += alike.empty() ? paragraph("No two fitted explanations have the same effect on these gauges.")
                     : paragraph("These explanations have the same effect on these gauges:") + element("ul", "\n", alike) + "\n";
  if (const auto separating = text_at(d, "separating_measurement"); !separating.empty())
    s += paragraph("The most informative measurement: " + separating + ".");
  const Json& skipped = list_at(d, "skipped");
  if (skipped.empty()) return s + paragraph("Every offered explanation was tried.");
  Html items;
  for (const auto& x : skipped) items += list_item(x.is_string() ? x.get<std::string>() : x.dump());
  return s + paragraph("Not tried:") + element("ul", "\n", items) + "\n";
}

}  // namespace

Html verdict_html(const Study& study) {
  if (!study.diagnosis) return {};
  const Json& d = diagnosis_summary(study);
  const std::string finding = text_at(d, "finding");
  if (finding.empty()) return paragraph_of("outcome", "Diagnosis: " + text_at(d, "verdict", "no verdict") + ". " + text_at(d, "reason"));
  return paragraph_of("outcome verdict", strong(finding), " ", text_at(d, "next_step"), " ", link_to("diagnosis", "The evidence"));
}

Html diagnosis_section(const Study& study, const ReportInput& input) {
  if (!study.diagnosis) return {};
  const Json& d = diagnosis_summary(study);
  const std::string verdict = text_at(d, "verdict");
  Html s = paragraph("Verdict: ", strong(verdict), ". ", meaning(verdict));
  if (text_at(d, "status", "done") != "done") s += missing(fragment(strong("Not to be trusted:"), " ", unsettled_fit(d), "."));
  if (const Json* nearest = nearest_refused(d))
    s += paragraph("The best of the explanations that were tried, ", explanation_title(*nearest),
                   ", is not named: ", first_letter_small(text_at(*nearest, "why")));
  s += where_part(study, input) + when_part(study) + what_part(study) + records_part(study, input) + handbook_part(study, input) + alike_part(study);
  if (const auto runs = number_at(d, "runs"))
    s += paragraph("The diagnosis took ", number_html(*runs, 6), " runs of the model (each is the mean over the pulse energies).");
  return s + paragraph_of("note", "When not to trust a verdict: docs/how-to/read_a_verdict.md.");
}

Json diagnosis_drawings(const Study& study) {
  if (!study.diagnosis) return nullptr;
  const DisplayUnit frequency = frequency_unit(study.time);
  const Json& d = diagnosis_summary(study);
  const Json& l = diagnosis_location(study);
  const auto part = [](const Json& p) {
    const auto m = mismatch(p);
    return Json{{"mismatch", m ? rounded(*m, 4) : Json()}, {"significant", significant(number_at(p, "q_value"))}};
  };
  Json gauges = Json::array();
  Json rows = Json::array();
  Json columns = Json::array();
  Json bands = Json::array();
  Json bars = Json::array();
  std::map<std::string, Json> by_sensor;  // the worst condition of each
  const Json& misfits = list_at(d, "gauges");
  for (const auto& s : list_at(l, "sensors")) {
    Json p = part(s);
    p["name"] = text_at(s, "name");
    rows.push_back(p);
    const auto of = std::find_if(misfits.begin(), misfits.end(), [&](const Json& g) { return text_at(g, "name") == text_at(s, "name"); });
    const std::string sensor = of == misfits.end() ? text_at(s, "name") : text_at(*of, "sensor");
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
    const Json& map = list_at(l, key);
    const Json& q = list_at(l, std::string(key) + "_q_values");
    for (std::size_t i = 0; i < map.size(); ++i) {
      Json row = Json::array();
      for (std::size_t w = 0; w < map[i].size(); ++w)
        row.push_back(part({{"score", map[i][w]}, {"q_value", i < q.size() && w < q[i].size() ? q[i][w] : Json()}}));
      all.push_back(std::move(row));
    }
    return all;
  };
  for (const auto& r : list_at(d, "ranking"))
    bars.push_back({{"label", explanation_title(r)},
                    {"probability", rounded(number_at(r, "probability").value_or(0), 4)},
                    {"strong", in_verdict(study, text_at(r, "name"))}});
  const Json times{{"axis", "time [" + study.time.name + "]"}, {"columns", columns}, {"cells", cells("map")}};
  const Json by_frequency{{"axis", "frequency [" + frequency.name + "]"}, {"columns", bands}, {"cells", cells("band_map")}};
  return {{"gauges", gauges}, {"rows", rows}, {"times", times}, {"bands", by_frequency}, {"bars", bars}};
}

}  // namespace calomel
