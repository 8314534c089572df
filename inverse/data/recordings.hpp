#pragma once
/// Measured histories: every pulse of every sensor on one common time grid, read from text or netCDF.
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/case_file.hpp"

namespace calomel {

/// `recordings.noise` given as a table: one sd for each sensor.
struct NoiseTable {
  std::map<std::string, double> sd;  ///< by sensor, in the data's unit
  template <class V>
  void visit(V& v) {
    for (auto& [name, value] : sd) v(name.c_str(), value, {.range = above(0), .doc = "sd of the noise of this sensor, in the data's unit"});
  }
};

/// `[recordings]` of a case file.
struct RecordingOptions {
  std::string file;
  std::string unit = "strain";
  double trigger_offset = 0;
  std::optional<double> begin, end;
  std::vector<std::string> exclude;
  std::string band = "prediction";
  std::optional<double> energy_sd;
  std::optional<double> noise;  ///< one sd for all sensors, in the data's unit
  double noise_time = 0;
  NoiseTable noise_by_sensor;  ///< used instead of `noise` when it has entries
  bool as_it_is = false;       ///< no key: `unit` is that of another model's values, and nothing is converted

  template <class V>
  void visit(V& v) {
    v("file", file,
      {.doc = "recordings.nc, a CSV of the form sensor,pulse,time,strain (condition optional), or time and one column a sensor", .required = true});
    v("unit", unit,
      {.doc = "strain or microstrain, which is converted. Records of a line or of an external model are in the model's own unit, case.sensor_unit"});
    v("trigger_offset", trigger_offset, {.unit = "s", .range = any(), .doc = "time on the record's clock at which the simulation starts (subtracted)"});
    v("begin", begin, {.unit = "s", .range = any(), .doc = "earlier samples are left out; on the simulation's clock"});
    v("end", end, {.unit = "s", .range = any(), .doc = "later samples are left out; on the simulation's clock"});
    v("exclude", exclude, {.doc = "recorded sensors that are not compared"});
    v("band", band, {.doc = "95 % band of the pulses (prediction) or of their mean (mean)", .choices = {"prediction", "mean"}});
    v("energy_sd", energy_sd, {.range = above(0), .doc = "relative sd of the pulse energy, where single pulses have their own energy"});
    if (noise_by_sensor.sd.empty())
      v("noise", noise,
        {.range = above(0), .doc = "sd of the noise in the data's unit, or a table by sensor; required where a sensor has fewer than two pulses"});
    else
      v.table("noise", noise_by_sensor, "sd of the noise by sensor");
    v("noise_time", noise_time,
      {.unit = "s",
       .range = at_least(0),
       .doc = "correlation time of that noise, exp(-time between samples / noise_time); 0 = independent from sample to sample"});
  }
  /// Errors: InputError when end <= begin.
  void validate() const;
  /// sd of the noise of a sensor, in the data's unit; Recordings::noise_of converts it. Empty when the case gives none.
  [[nodiscard]] std::optional<double> noise_of(const std::string& sensor) const;
};

/// Reads `[recordings]`; `noise` may be a number or a table. Errors: InputError with the place.
RecordingOptions read_recording_options(CaseFile& file);

/// Measured histories. Strain is dimensionless inside, whatever the file's unit.
struct Recordings {
  std::vector<std::string> conditions;  ///< {"default"} when the file names none
  std::vector<std::string> sensors;     ///< in the order of their first appearance
  std::vector<int> pulses;              ///< ascending; equal numbers are one beam pulse
  std::vector<double> time;             ///< [s], evenly spaced
  std::vector<double> values;           ///< (condition, sensor, pulse, time); NaN = absent
  std::string unit = "strain";          ///< "strain", or the name of another unit
  double factor = 1;                    ///< by which the file's values were multiplied to be in it
  std::string source;                   ///< the file (or files) they come from
  std::vector<int> sensor_lines;        ///< (n_sensors) line of the first row in a text file in long form; 0 otherwise
  std::vector<std::string> warnings;    ///< dropouts, rounded times, skipped lines

  [[nodiscard]] std::size_t at(std::size_t condition, std::size_t sensor, std::size_t pulse, std::size_t sample) const {
    return ((condition * sensors.size() + sensor) * pulses.size() + pulse) * time.size() + sample;
  }
  /// sd of the noise of a sensor that the case gives, in the unit of the values here; empty when it gives none.
  [[nodiscard]] std::optional<double> noise_of(const std::string& sensor, const RecordingOptions& options) const {
    const auto sd = options.noise_of(sensor);
    return sd ? std::optional(*sd * factor) : std::nullopt;
  }
  /// Whether the pulse of the sensor has any sample.
  [[nodiscard]] bool recorded(std::size_t condition, std::size_t sensor, std::size_t pulse) const;
};

/// Reads a file: long or wide text, a LabVIEW measurement, or recordings.nc. `unit` and `as_it_is` as in RecordingOptions.
/// Errors: InputError with file and line; without a file but with the key recordings.file when it cannot be opened.
Recordings read_recordings_file(const std::filesystem::path& path, const std::string& unit = "strain", bool as_it_is = false);

/// The recordings of a case: the file, then exclusion, trigger offset and window.
/// Errors: those of read_recordings_file; InputError when a name in `exclude` is not recorded or nothing is left.
Recordings read_recordings(const std::filesystem::path& path, const RecordingOptions& options);

/// The samples of a record at the times first + k step (k = 0, 1, ...) of a model that has no value between them, at two times and more, evenly spaced; the
/// rest is left out. Unchanged if fewer than two of its samples are there. A warning is added where anything is left out or has to be interpolated.
Recordings at_times_of(const Recordings& recordings, double first, double step, std::vector<std::string>& warnings);

/// Holds the recorded sensors against the declared ones; returns the warnings (declared but not recorded, or left out: `excluded`).
/// Errors: InputError for the first sensor that is recorded but not declared, naming it and both files.
std::vector<std::string> match_sensors(const Recordings& recordings, std::span<const std::string> declared, const std::filesystem::path& case_file,
                                       const std::filesystem::path& recordings_file, std::span<const std::string> excluded = {});

/// Writes strain(sensor, pulse, time) (a leading condition dimension when there are named conditions).
void write_recordings(const std::filesystem::path& path, const Recordings& recordings);

struct ImportSummary {
  std::filesystem::path path;  ///< the recordings.nc that was written
  Recordings recordings;
};
/// Merges `files` into `out_dir`/recordings.nc. Files in long form and netCDF keep their pulse numbers; a wide file is the
/// first pulse number at which none of its sensors is recorded yet. Offset and window are not applied: the case does that.
/// Errors: those of read_recordings_file; InputError when the grids differ or a sample is given twice.
ImportSummary import_recordings(std::span<const std::filesystem::path> files, const RecordingOptions& options, const std::filesystem::path& out_dir);

}  // namespace calomel
