#pragma once
/// Every table of the report, from the artefacts; each may be empty.
#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// Unit in which the page shows the data.
DisplayUnit display_unit(const ReportInput& input);

/// Unit of a parameter of the case; empty for a pure number, and of what is none of its parameters.
std::string parameter_unit(const ReportInput& input, const std::string& parameter);
/// A parameter's name with its unit, "density [kg/m3]".
std::string parameter_label(const ReportInput& input, const std::string& parameter);
/// Names of the parameters: those of the case, else those of the first calibration.
std::vector<std::string> parameter_names(const Study& study, const ReportInput& input);

/// The two numbers whose product is the impedance of the liquid, where the case has them.
struct Impedance {
  std::string density, sound_speed;                        ///< names of the parameters; empty when not inferred
  std::optional<double> density_value, sound_speed_value;  ///< the case's own values
  [[nodiscard]] bool ridge() const { return !density.empty() && !sound_speed.empty(); }
  /// rho c [Pa s/m] at the parameters `theta` (NAME -> value).
  [[nodiscard]] std::optional<double> at(const Json& theta) const;
};
Impedance impedance(const ReportInput& input);

Table parameter_table(const Study& study, const ReportInput& input);
Table sensor_table(const ReportInput& input);
/// `key` is "accuracy" or "mae"; one column a method, and the nominal values. Bold where the calibrated simulation does
/// as well as the nominal one, or better.
Table score_table(const Study& study, const ReportInput& input, const std::string& key);
Table optimizer_table(const Study& study);
Table candidate_table(const Study& study, const ReportInput& input);
Table round_table(const Study& study, const ReportInput& input);
Table convergence_table(const Study& study);
Table surrogate_table(const Study& study, const ReportInput& input);
Table loss_table(const Study& study);
Table failure_table(const Study& study, std::size_t most);
Table design_table(const Study& study);
Table scatter_table(const Study& study, const ReportInput& input);
/// Each method's whole-record scores in one row, for the first screen.
Table headline_table(const Study& study, const ReportInput& input);
/// Scores with and without the mesh's error of the calibrations that took it into account.
Table mesh_table(const Study& study, const ReportInput& input);

}  // namespace calomel
