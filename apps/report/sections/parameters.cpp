#include "apps/report/sections/parameters.hpp"

#include <algorithm>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/sections/comparison.hpp"

namespace calomel {

Table parameter_table(const Study& study, const ReportInput& input) {
  Table t{.id = "parameters", .caption = "Calibrated parameters beside the nominal ones."};
  t.columns = {{"parameter", "Parameter", 4, true}, {"unit", "Unit", 4, true}};
  t.columns.push_back({"nominal", "Nominal", 5});
  for (const auto& c : study.calibrations) t.columns.push_back({c.method, c.label, 5});
  const Comparison compared = comparison_of(study);
  const auto* map = study.calibration("map");
  if (map) t.columns.push_back({"map_sd", "sd by " + map->label, 3});
  for (const auto& c : study.calibrations) t.columns.push_back({c.method + "_change_percent", c.label + " against nominal [%]", -1});
  t.columns.push_back({"min", "Lower bound", 5});
  t.columns.push_back({"max", "Upper bound", 5});

  const auto nominal_of = [&](const std::string& name, const Parameter* p) -> std::optional<double> {
    if (p && p->nominal) return p->nominal;
    for (const auto& c : study.calibrations)
      if (const auto x = number_at(part_at(c.summary, "nominal"), name)) return x;
    return std::nullopt;
  };
  const auto add = [&](const std::string& name, const std::string& unit, const std::vector<std::optional<double>>& found, std::optional<double> nominal,
                       std::optional<double> low, std::optional<double> high) {
    std::vector<Cell> row{name, unit};
    row.emplace_back(nominal);
    for (const auto& x : found) row.emplace_back(x);
    const auto of =
        std::find_if(compared.parameters.begin(), compared.parameters.end(), [&](const auto& r) { return r.name == name || name.starts_with(r.name + ' '); });
    if (map) row.emplace_back(of == compared.parameters.end() ? std::nullopt : of->map_sd);
    for (const auto& x : found) row.emplace_back(x && nominal && *nominal != 0 ? std::optional(100 * (*x / *nominal - 1)) : std::nullopt);
    row.emplace_back(low);
    row.emplace_back(high);
    t.rows.push_back(std::move(row));
  };
  Json nominal_theta = Json::object();
  for (const auto& name : parameter_names(study, input)) {
    const auto at = std::find_if(input.parameters.begin(), input.parameters.end(), [&](const Parameter& p) { return p.name == name; });
    const Parameter* p = at == input.parameters.end() ? nullptr : &*at;
    std::vector<std::optional<double>> found;
    for (const auto& c : study.calibrations) found.push_back(number_at(part_at(c.summary, "theta"), name));
    const auto nominal = nominal_of(name, p);
    if (nominal) nominal_theta[name] = *nominal;
    add(name, parameter_unit(input, name), found, nominal, p ? std::optional(p->min) : std::nullopt, p ? std::optional(p->max) : std::nullopt);
  }
  const Impedance z = impedance(input);
  if (!t.rows.empty() && (!z.density.empty() || !z.sound_speed.empty())) {
    std::vector<std::optional<double>> found;
    for (const auto& c : study.calibrations) found.push_back(z.at(part_at(c.summary, "theta")));
    if (z.at(nominal_theta)) {
      add("impedance \u03c1c", "Pa\u00b7s/m", found, z.at(nominal_theta), std::nullopt, std::nullopt);
      t.note = "The impedance \u03c1c of the liquid is derived, not fitted: density and sound speed can trade against each other along \u03c1c = const.";
    }
  }
  return t;
}

Html parameters_section(const Study& study, const ReportInput& input) {
  const Table parameters = parameter_table(study, input);
  Html s = parameters.empty() ? missing("The case has no parameters to infer.",
                                        fragment("Add a table ", element("code", "[parameter.NAME]"), " with min and max to the case file."))
                              : parameters.html();
  if (study.calibrations.empty() && !parameters.empty()) s += no_calibration(input, "Only nominal values and bounds are known.");
  return s + shown(agreement_table(study)) + shown(place_table(study)) + shown(hypothesis_table(study)) + shown(effort_table(study));
}

}  // namespace calomel
