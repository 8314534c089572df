#pragma once
/// Physics that may have been left out: named blocks of parameters whose `off` values give the base model exactly.
///
/// A mechanism is one pair of files that makes its MechanismEntry: the law in words, its keys, and the functions through which it
/// changes a run. Where physics can be missing there is one such place each: the mesh, the load, the numbers, the fields and the
/// liquid law of the run, the gauges. A mechanism at its off values is not called at all, so the base model's bytes are untouched.
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/case_file.hpp"
#include "base/registry.hpp"
#include "forward/sensor/gauge.hpp"
#include "forward/solver/explicit_solver.hpp"
#include "forward/solver/load.hpp"

namespace calomel {

/// One key of a mechanism: its off value and the range of its default prior.
struct MechanismKey {
  std::string name;
  std::string unit;
  double off;        ///< infinite if the law has "none"; the default of a key that does not decide
  double low, high;  ///< default prior range
  bool log_uniform = false;
  bool decides = true;   ///< the mechanism is off when every deciding key has its off value
  bool screened = true;  ///< whether a diagnosis fits it; false: another key of the mechanism has the same effect on the records
  std::optional<int> off_centre =
      std::nullopt;     ///< axis along which it breaks the symmetry: an error where the mesh is mirrored along it, and a diagnosis does not screen it there
  bool shapes = false;  ///< does not decide, but changes what the mechanism looks like so much that a diagnosis fits it, too
  double least = -std::numeric_limits<double>::infinity(), greatest = std::numeric_limits<double>::infinity();  ///< what the law allows
  std::string doc;
  std::string
      shows_below;     ///< number of the case below which alone its value shows ("material.mercury.tensile_cutoff"), and from which on it is off; empty: none
  std::string off_at;  ///< number of the case ("load.pulse_length") that is the off value, and the value until one is set; `off` is then what it is by default
  std::string law;  ///< of several laws of one mechanism, each with keys of its own, the word for the one that this key is of; empty: of all. A diagnosis asks
                    ///< for each law apart
  std::vector<std::string> choices;  ///< a word in the case file, one of these; its value is that one's index. Such a key does not decide and is no parameter
};

/// Whether the mesh is cut by a symmetry that this key breaks: what it does cannot show there.
inline bool hidden_by_mirror(const MechanismKey& key, const Mesh& mesh) { return key.off_centre && mirrored(mesh, *key.off_centre); }

/// The values of an enabled mechanism's keys; a gauge's own where it has any. Not a number where a key follows a number of the case and has none of its
/// own: ForwardCase::active_mechanisms fills it in.
class MechanismValues {
 public:
  MechanismValues() = default;
  explicit MechanismValues(const std::vector<MechanismKey>& keys) {
    for (const auto& k : keys) common_[k.name] = k.off_at.empty() ? k.off : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] double operator[](const std::string& key) const { return common_.at(key); }
  [[nodiscard]] double of(const std::string& sensor, const std::string& key) const {
    const auto own = by_sensor_.find(sensor + '.' + key);
    return own == by_sensor_.end() ? common_.at(key) : own->second;
  }
  /// The number at "key" or "SENSOR.key", to be set; null when there is no such key. A gauge's own is made when first named.
  [[nodiscard]] double* find(const std::string& path);
  /// The same to be read: nothing is made, the common one answers for a gauge that has none of its own.
  [[nodiscard]] const double* find(const std::string& path) const;
  /// Takes a gauge's own number back: the common one answers again.
  void forget(const std::string& path) { by_sensor_.erase(path); }
  [[nodiscard]] const std::map<std::string, double>& common() const { return common_; }
  [[nodiscard]] const std::map<std::string, double>& by_sensor() const { return by_sensor_; }

 private:
  std::map<std::string, double> common_, by_sensor_;
};

/// What the registry knows of a mechanism. A function that is null changes nothing; all null: not built in this version.
struct MechanismEntry {
  std::string law;    ///< one line
  std::string plain;  ///< what is left out without it, for a reader who knows no law: "the proton beam's profile"
  std::string check;  ///< what to do where it is named: "compare ..."
  std::vector<MechanismKey> keys;
  bool per_sensor = false;     ///< `[mechanism.NAME.SENSOR]` tables are allowed
  bool like_the_mesh = false;  ///< a coarse mesh damps and delays waves as it does, so that a score test cannot distinguish the two
  bool needs_rear = false;     ///< it acts on a non-reflecting rear face alone, and is offered where there is one
  double cost = 1;             ///< of an ensemble mean with it, over one of the base model; docs/theory/mechanisms.md

  /// Node places, before anything is built on the mesh (displace_nodes, thin_wall); elements, faces and slip pairs remain. Gauges are placed on what comes out.
  /// Errors: InputError on a key of its own ("fraction"), NumericsError where an element would be inverted.
  void (*mesh)(const MechanismValues&, Mesh&) = nullptr;
  /// The source. Errors: InputError when the modelled part cannot show it.
  void (*load)(const MechanismValues&, const Mesh&, LoadOptions&) = nullptr;
  /// Numbers of the run: viscosity, damping, boundary.
  void (*setup)(const MechanismValues&, RunSetup&) = nullptr;
  /// Fields of the run, by element, node or slip pair, once its numbers and its heat are known: thermal_strain, initial_displacement, initial_velocity,
  /// initial_stress, slip_strength. What is there already it adds to. The load is that of the run; its factor counts in how strong the run's condition is
  /// beside [load].
  void (*fields)(const MechanismValues&, const Mesh&, const LoadOptions&, RunSetup&) = nullptr;
  /// A liquid law of its own, after all of these.
  std::shared_ptr<const LiquidLaw> (*liquid)(const MechanismValues&, const RunSetup&) = nullptr;
  /// What a gauge reads of the displacements.
  void (*gauge)(const MechanismValues&, const LocatedGauge&, ObservationRow&) = nullptr;
  /// Shares of the states of LeftStates from whose sum the run starts; its gauges are set to zero there.
  std::vector<double> (*left)(const MechanismValues&) = nullptr;
  /// A gauge's history on the output times, in strain, before its gain and delay.
  void (*channel)(const MechanismValues&, const std::string& sensor, double interval, std::span<double> history) = nullptr;

  [[nodiscard]] bool built() const { return mesh || load || setup || fields || liquid || gauge || left || channel; }
};

/// All thirteen names of physics.md section 3.
const Registry<MechanismEntry>& mechanisms();

/// A mechanism that is part of the case's model.
struct EnabledMechanism {
  std::string name;
  const MechanismEntry* entry;
  MechanismValues values;
  /// Every deciding key has its off value, `off_value(key)`.
  [[nodiscard]] bool off(const std::function<double(const MechanismKey&)>& off_value) const;
};

/// The values of `[mechanism.*]`.
struct MechanismTables {
  std::vector<EnabledMechanism> enabled;
  std::vector<std::string> listed;  ///< all that have a table
  std::vector<std::string> notes;   ///< e.g. that a listed one is not built
};

/// The values of one `[mechanism.NAME]`.
struct MechanismTable {
  MechanismValues values;
  bool enabled = false;
};

/// Reads it: the keys, with `per_sensor` tables of single sensors; `extra` keys are left to others. Errors: InputError with the place.
MechanismTable read_mechanism_table(CaseFile& file, const std::string& name, const std::vector<MechanismKey>& keys, bool per_sensor,
                                    std::span<const std::string> sensors, std::vector<std::string> extra = {});

/// Reads `[mechanism.*]`: unknown names, keys and gauges are errors, so is enabling one that is not built.
MechanismTables read_mechanisms(CaseFile& file, std::span<const std::string> sensors);

}  // namespace calomel
