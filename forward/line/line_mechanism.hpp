#pragma once
/// Physics that a line leaves out: named blocks of keys whose off values give the base model exactly, as in forward/mechanism. A mechanism is one pair of files
/// that makes its LineMechanismEntry, and one line in register.cpp. At its off values it is not called at all.
#include <complex>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/registry.hpp"
#include "forward/line/line_options.hpp"
#include "forward/line/pipe_flow.hpp"
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

/// What the registry knows of a mechanism of the line. A function that is null changes nothing.
struct LineMechanismEntry {
  std::string law;  ///< one line
  std::vector<MechanismKey> keys;
  std::string needs;         ///< number of the case without which it is not offered ("line.radius"), or empty
  bool per_station = false;  ///< `[mechanism.NAME.STATION]` tables are allowed
  std::string plain, check;  ///< as in MechanismEntry

  /// Bar: multiplies the wavenumber at each angular frequency, (frequencies). `radius` [m] is NaN where the case has none.
  void (*wavenumber)(const MechanismValues&, const BarOptions&, std::span<const double> omega, std::span<std::complex<double>> wavenumber) = nullptr;
  /// Pipe: numbers of the run.
  void (*pipe)(const MechanismValues&, PipeSetup&) = nullptr;
  /// A station's history on the output times, in the unit of the readings.
  void (*channel)(const MechanismValues&, const std::string& station, double interval, std::span<double> history) = nullptr;
};

/// Those of a bar and those of a pipe.
const Registry<LineMechanismEntry>& bar_mechanisms();
const Registry<LineMechanismEntry>& pipe_mechanisms();
/// By `line.kind`, "bar" or "pipe".
const Registry<LineMechanismEntry>& line_mechanisms(const std::string& kind);

/// A mechanism of the case's kind of line with its values. One that is not enabled has its off values, so that it is not part of the model until a number
/// of it is set (LineModel::evaluate).
struct LineMechanism {
  std::string name;
  const LineMechanismEntry* entry;
  MechanismValues values;
  bool enabled = false;
  bool listed = false;  ///< has a table in the case
  /// Every deciding key has its off value.
  [[nodiscard]] bool off() const;
};

/// All mechanisms of the catalogue, with the values of `[mechanism.*]`. Errors: InputError for unknown names, keys and stations.
std::vector<LineMechanism> read_line_mechanisms(CaseFile& file, const Registry<LineMechanismEntry>& catalogue, std::span<const std::string> stations);

}  // namespace calomel
