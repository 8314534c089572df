#include "apps/report/data/quantities.hpp"

#include <algorithm>

#include "apps/report/data/json_values.hpp"

namespace calomel {

DisplayUnit time_unit(double end) {
  constexpr double most = 20e3;  // the greatest number that is shown in a unit
  for (const auto& unit : {DisplayUnit{"\u00b5s", 1e6}, DisplayUnit{"ms", 1e3}})
    if (unit.factor * end <= most) return unit;
  return {"s", 1};
}

DisplayUnit display_unit(const ReportInput& input) { return input.unit == "strain" ? DisplayUnit{"\u00b5\u03b5", 1e6} : DisplayUnit{input.unit, 1.0}; }

std::string parameter_unit(const ReportInput& input, const std::string& parameter) {
  const auto found = std::find_if(input.parameters.begin(), input.parameters.end(), [&](const Parameter& p) { return p.name == parameter; });
  return found == input.parameters.end() || found->unit == "1" ? "" : found->unit;
}

std::string parameter_label(const ReportInput& input, const std::string& parameter) {
  const std::string unit = parameter_unit(input, parameter);
  return unit.empty() ? parameter : parameter + " [" + unit + "]";
}

std::optional<double> Impedance::at(const Json& theta) const {
  const auto value = [&](const std::string& name, const std::optional<double>& own) { return name.empty() ? own : number_at(theta, name); };
  const auto rho = value(density, density_value);
  const auto c = value(sound_speed, sound_speed_value);
  return rho && c ? std::optional(*rho * *c) : std::nullopt;
}

Impedance impedance(const ReportInput& input) {
  Impedance z;
  for (const auto& p : input.parameters) {
    const std::string key = p.key.empty() ? "material.mercury." + p.name : p.key;
    if (key == "material.mercury.density") z.density = p.name;
    if (key == "material.mercury.sound_speed") z.sound_speed = p.name;
  }
  const Json& mercury = part_at(part_at(input.options, "material"), "mercury");
  z.density_value = number_at(mercury, "density");
  z.sound_speed_value = number_at(mercury, "sound_speed");
  return z;
}

}  // namespace calomel
