#pragma once
/// The case file of a line, `[model] kind = "line"`, and its binding to uncertain parameters.
#include <string>
#include <vector>

#include "base/case_file.hpp"
#include "forward/line/line_mechanism.hpp"
#include "forward/line/line_options.hpp"
#include "forward/line/signal.hpp"
#include "forward/parameter.hpp"
#include "forward/simulation/case_tables.hpp"

namespace calomel {

struct LineCase {
  std::string name;
  std::string kind = "bar";     ///< or "pipe"
  std::string unit;             ///< of the readings: a bar's is the drive's; a pipe's Pa, kPa, MPa or bar
  double pascals_per_unit = 1;  ///< of a pipe's readings
  BarOptions bar;
  PipeOptions pipe;
  DriveOptions drive;  ///< of a bar
  Signal record;       ///< read from drive.file
  TimeOptions time;
  std::vector<StationOptions> stations;
  std::vector<Parameter> parameters;      ///< declared order, nominal filled
  std::vector<LineMechanism> mechanisms;  ///< all of the kind's catalogue; those that are not enabled at their off values

  /// Reads every table of a line. Errors: InputError with the place.
  static LineCase read(CaseFile& file);

  /// The number at a dotted path ("line.wave_speed", "station.B.delay", "mechanism.lateral_inertia.poisson"). Errors: InputError naming the nearest.
  [[nodiscard]] double number(const std::string& key) const;
  /// Sets it; the value is not checked against the key's range.
  void set_number(const std::string& key, double value);
  /// The case with the parameters set to `theta` (declared order).
  [[nodiscard]] LineCase at(std::span<const double> theta) const;
  /// Whether the number that a mechanism needs of the case is there.
  [[nodiscard]] bool has_what_it_needs(const LineMechanism& mechanism) const;
  /// Darcy's friction factor of the pipe's turbulent flow [-]: the given one, or Haaland's of the steady flow.
  [[nodiscard]] double friction_factor() const;
  /// Resolved options by table, for provenance.
  [[nodiscard]] Json echo() const;

  /// Visits every Options of the line with its table's path: f(path, options).
  template <class Self, class F>
  static void visit_tables(Self& self, F&& f) {
    if (self.kind == "bar")
      f("line", self.bar), f("drive", self.drive);
    else
      f("line", self.pipe);
    f("time", self.time);
  }
};

}  // namespace calomel
