#include "apps/report/sections/histories.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/traces.hpp"

namespace calomel {

namespace {

/// The line beside each sensor's plot: its scores by method, and its nominal scores.
Json score_lines(const Study& study, const ReportInput& input) {
  Json lines = Json::object();
  const std::string unit = display_unit(input).name;
  const auto add = [&](const std::string& sensor, const std::string& who, const std::optional<double>& accuracy, const std::optional<double>& mae) {
    if (!mae) return;
    std::string text = lines.contains(sensor) ? lines[sensor].get<std::string>() + "; " : "";
    lines[sensor] = text + who + (accuracy ? fmt::format(" {:.1f}\u00a0%,", *accuracy) : "") + fmt::format(" {:.1f}\u00a0{}", *mae, unit);
  };
  for (const auto& c : study.calibrations)
    for (const auto& s : list_at(c.summary, "sensors")) add(text_at(s, "name"), c.label, number_at(s, "accuracy"), number_at(s, "mae"));
  if (!study.calibrations.empty())
    for (const auto& s : list_at(study.calibrations.front().summary, "sensors"))
      add(text_at(s, "name"), "nominal", number_at(s, "nominal_accuracy"), number_at(s, "nominal_mae"));
  return lines;
}

}  // namespace

Html histories_section(const Study& study, const ReportInput& input) {
  const bool traces =
      study.simulation || std::any_of(study.calibrations.begin(), study.calibrations.end(), [](const auto& c) { return c.histories.has_value(); });
  if (!traces)
    return missing("There are no time histories yet (enc.nc, spe.nc, map.nc or simulate.nc).",
                   fragment("Make them with ", command(input, "calibrate", "--method enc"), " or ", command(input, "simulate"), "."));
  Html s;
  for (const auto& c : study.calibrations)
    if (!c.histories)
      s += missing(c.method + ".nc is missing, so the histories of " + c.label + " are not drawn.",
                   fragment("Make it with ", command(input, "calibrate", "--method " + c.method + " --fresh"), "."));
  s += paragraph(
      "Strain is positive in tension; time 0 is the start of the pulse. Drag across a plot to zoom in time: all plots follow. Double-click, or the button, "
      "shows "
      "everything again. A trace is switched on and off in the legend. Beside each name are the share of samples inside the band and the mean absolute "
      "error.");
  return s + place("history-controls", "controls") + "\n" + place("histories-plots", "plots") + "\n";
}

Json scored_histories_json(const Study& study, const ReportInput& input, std::size_t most) {
  Json json = histories_json(study, input, most);
  if (!json.is_null()) json["scores"] = score_lines(study, input);
  return json;
}

}  // namespace calomel
