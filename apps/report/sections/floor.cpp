#include "apps/report/sections/floor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"

namespace calomel {

namespace {

/// The title of a comparison.
std::string comparison_title(const Json& comparison) {
  const std::string name = text_at(comparison, "name");
  return name == "single_runs"  ? "Single runs"
         : name == "finer_mesh" ? "Half the element size"
         : name == "precision"  ? "Single against double precision"
                                : name;
}

/// Name of a record: the name of its gauge, after its condition when there are several conditions.
std::string record_name(const Json& record, const Json& all) {
  const bool several = std::any_of(all.begin(), all.end(), [&](const Json& r) { return text_at(r, "condition") != text_at(all.front(), "condition"); });
  return several ? text_at(record, "condition") + ", " + text_at(record, "name") : text_at(record, "name");
}

std::string key_of(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == ' '; }, '_');
  return text;
}

const Json& comparisons_of(const Study& study) { return list_at(study.floor, "comparisons"); }

constexpr int any_share = 2;      ///< Column::digits of shares in percent: two significant digits, since single precision may move far less than the mesh
constexpr int alike_shares = -1;  ///< the same of a column of one kind of shares: one decimal

}  // namespace

Table floor_table(const Study& study) {
  Table t{.id = "floor", .caption = "How far the simulated strain moves, in percent of its root mean square over the whole record."};
  if (study.floor.is_null()) return t;
  t.columns = {{"what", "What is changed", 4, true},
               {"mean", "Mean over gauges [%]", any_share, false, percent},
               {"worst", "Worst gauge [%]", any_share, false, percent},
               {"compared", "Measured as", 4, true}};
  t.rows.push_back(
      {Cell("Repeatability floor", true), Cell(number_at(study.floor, "mean"), true), Cell(number_at(study.floor, "worst"), true),
       fmt::format("standard deviation of the ensemble mean over {} jitters of mesh, viscosity and energies", list_at(study.floor, "members").size())});
  for (const auto& c : comparisons_of(study)) {
    const std::string message = text_at(c, "message");
    t.rows.push_back({comparison_title(c), number_at(c, "mean"), number_at(c, "worst"), message.empty() ? text_at(c, "what") : message});
  }
  return t;
}

Table floor_sensor_table(const Study& study) {
  Table t{.id = "floor_by_gauge", .caption = "The same by gauge [% of its signal]."};
  const Json& records = list_at(study.floor, "sensors");
  if (records.empty()) return t;
  t.columns = {{"gauge", "Gauge", 4, true}, {"floor", "Repeatability floor", alike_shares, false, percent}};
  std::vector<const Json*> shown;
  for (const auto& c : comparisons_of(study))
    if (list_at(c, "sensors").size() == records.size()) {
      t.columns.push_back({text_at(c, "name"), comparison_title(c), text_at(c, "name") == "precision" ? any_share : alike_shares, false, percent});
      shown.push_back(&list_at(c, "sensors"));
    }
  for (std::size_t row = 0; row < records.size(); ++row) {
    std::vector<Cell> cells{record_name(records[row], records), Cell(number_at(records[row], "relative"), true)};
    for (const Json* list : shown) cells.emplace_back(number_at((*list)[row], "relative"));
    t.rows.push_back(std::move(cells));
  }
  return t;
}

Table floor_window_table(const Study& study, const ReportInput& input) {
  const auto unit = display_unit(input);
  Table t{.id = "floor_by_window", .caption = "Repeatability floor by stretch of the record: standard deviation of the ensemble mean [" + unit.name + "]."};
  const Json& records = list_at(study.floor, "sensors");
  const Json& begin = list_at(study.floor, "window_begin_s");
  const Json& end = list_at(study.floor, "window_end_s");
  t.columns = {{"begin_s", "From [" + study.time.name + "]", 4, false, study.time.factor},
               {"end_s", "To [" + study.time.name + "]", 4, false, study.time.factor}};
  for (const auto& r : records) t.columns.push_back({key_of(record_name(r, records)), record_name(r, records), -1, false, unit.factor});
  for (std::size_t w = 0; w < std::min(begin.size(), end.size()); ++w) {
    std::vector<Cell> cells{begin[w].get<double>(), end[w].get<double>()};
    for (const auto& r : records) {
      const Json& sd = list_at(r, "sd");
      cells.push_back(w < sd.size() && sd[w].is_number() ? Cell(sd[w].get<double>()) : Cell());
    }
    t.rows.push_back(std::move(cells));
  }
  return t;
}

Html floor_section(const Study& study, const ReportInput& input) {
  if (study.floor.is_null())
    return missing("No repeatability floor has been measured (campaign.json, floor.json).",
                   fragment("Measure it with ", command(input, "check", "--floor"), "."));
  const Json& records = list_at(study.floor, "sensors");
  const auto worst =
      std::max_element(records.begin(), records.end(), [](const Json& a, const Json& b) { return number_at(a, "relative") < number_at(b, "relative"); });
  const auto share = [&](const char* key) { return number_html(percent * number_at(study.floor, key).value_or(0), 2); };
  const Html introduction = paragraph(
      "Cavitating mercury is chaotic. Choices that physics does not fix (places of the mesh nodes, regularising viscosity, pulse energies) change the result. "
      "The size of this change is the repeatability floor, here ",
      strong(share("mean"), "\u00a0%"), " of the signal on average over the gauges, ", share("worst"), "\u00a0% at the worst",
      worst == records.end() ? "" : " (" + record_name(*worst, records) + ")",
      ". A smaller difference between simulation and record contains no information on the target. Do not select parameters or mechanisms by it.");
  const Html note = paragraph_of("note",
                                 "Single runs: the effect of chaos on a single run after an irrelevant change; the ensemble mean, with which a mean record is "
                                 "compared, reduces it. Half the element size: the remaining error of the mesh; if it is well above the floor, a finer mesh "
                                 "improves the result more than further runs. Single precision is sufficient while its row is below the floor.");
  return introduction + floor_table(study).html() + note + floor_sensor_table(study).html() +
         folded("The floor by stretch of the record", floor_window_table(study, input));
}

}  // namespace calomel
