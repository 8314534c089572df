#pragma once
/// Units, labels and the impedance of a case's parameters and data.
#include <optional>
#include <string>

#include "apps/report/data/report_input.hpp"

namespace calomel {

/// A unit in which the page shows numbers, and the factor from the unit of the artefacts to it.
struct DisplayUnit {
  std::string name;
  double factor;
};

/// The unit of times up to `end` [s]: microseconds up to 20 ms, milliseconds up to 20 s, else seconds.
DisplayUnit time_unit(double end);
/// The unit in which the page shows the data.
DisplayUnit display_unit(const ReportInput& input);

/// The unit of a parameter of the case; empty for a pure number and for a name that is no parameter.
std::string parameter_unit(const ReportInput& input, const std::string& parameter);
/// A parameter's name with its unit, "density [kg/m3]".
std::string parameter_label(const ReportInput& input, const std::string& parameter);

/// The two numbers of the liquid whose product is its impedance, as far as the case has them.
struct Impedance {
  std::string density;      ///< name of the parameter; empty when it is not inferred
  std::string sound_speed;  ///< the same
  std::optional<double> density_value;
  std::optional<double> sound_speed_value;  ///< the case's own values [kg/m3], [m/s]
  [[nodiscard]] bool ridge() const { return !density.empty() && !sound_speed.empty(); }
  /// rho c [Pa s/m] at the parameters `theta` (NAME -> value).
  [[nodiscard]] std::optional<double> at(const Json& theta) const;
};
Impedance impedance(const ReportInput& input);

}  // namespace calomel
