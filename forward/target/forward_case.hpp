#pragma once
/// The part of a case file that the forward layer reads, and its binding to uncertain parameters.
#include <string>
#include <vector>

#include "base/case_file.hpp"
#include "forward/material/linear_elastic.hpp"
#include "forward/material/riemer.hpp"
#include "forward/mechanism/mechanism.hpp"
#include "forward/mesh/geometry_options.hpp"
#include "forward/parameter.hpp"
#include "forward/sensor/sensor_options.hpp"
#include "forward/simulation/case_tables.hpp"
#include "forward/solver/explicit_solver.hpp"
#include "forward/solver/load.hpp"

namespace calomel {

/// `[[condition]]`: an operating point, e.g. a beam power.
struct ConditionOptions {
  std::string name;
  std::optional<double> peak_pressure, energy;
  template <class V>
  void visit(V& v) {
    v("name", name, {.doc = "name, as in the recordings", .required = true});
    v("peak_pressure", peak_pressure, {.unit = "Pa", .range = above(0), .doc = "greatest heating pressure of this condition"});
    v("energy", energy, {.unit = "J", .range = above(0), .doc = "deposited energy of this condition"});
  }
  void validate() const;
};

struct ForwardCase {
  std::string name;
  std::string sensor_unit = "strain";  ///< of the readings, gain times strain
  GeometryOptions geometry;
  SteelOptions steel;
  MercuryOptions mercury;
  LoadOptions load;
  History end_stress;  ///< read from load.file
  TimeOptions time;
  SolverOptions solver;
  std::vector<SensorOptions> sensors;
  std::vector<ConditionOptions> conditions;    ///< empty: one, that of the load
  std::vector<Parameter> parameters;           ///< declared order, nominal filled
  std::vector<EnabledMechanism> mechanisms;    ///< part of the model
  std::vector<std::string> listed_mechanisms;  ///< that have a table, enabled or not
  std::vector<std::string> notes;              ///< e.g. mechanisms that are listed but not built yet

  /// Reads every forward table. Errors: InputError with the place.
  static ForwardCase read(CaseFile& file);

  /// The number at a dotted path ("material.mercury.density", "sensor.B.gain"). Errors: InputError naming the nearest.
  [[nodiscard]] double number(const std::string& key) const;
  /// Its unit and the range that its key allows. Errors: InputError when there is no such number.
  [[nodiscard]] FieldInfo about(const std::string& key) const;
  /// Sets it; the value is not checked against the key's range (a campaign explores extremes on purpose).
  void set_number(const std::string& key, double value);
  /// The case with the parameters set to `theta` (declared order).
  [[nodiscard]] ForwardCase at(std::span<const double> theta) const;

  /// What switches this key of a mechanism off in this case: its off value, or the number of the case that it follows.
  [[nodiscard]] double off_value(const MechanismKey& key) const { return key.off_at.empty() ? key.off : number(key.off_at); }
  /// Whether a mechanism is part of the model, on or off.
  [[nodiscard]] bool enables(const std::string& mechanism) const;
  /// The mechanisms that are not off, with every value filled in.
  [[nodiscard]] std::vector<EnabledMechanism> active_mechanisms() const;

  /// Resolved options by table, for provenance.
  [[nodiscard]] Json echo() const;
  /// Visits every Options of the forward layer with its table's path: f(path, options).
  template <class Self, class F>
  static void visit_tables(Self& self, F&& f) {
    f("geometry", self.geometry);
    f("material.steel", self.steel);
    f("material.mercury", self.mercury);
    f("load", self.load);
    f("time", self.time);
    f("solver", self.solver);
  }
};

}  // namespace calomel
