#include "inverse/data/recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "base/artefact.hpp"
#include "base/input_file.hpp"
#include "base/not_finite.hpp"
#include "base/netcdf_file.hpp"
#include "inverse/data/record_rows.hpp"

namespace calomel {

namespace {

constexpr double microstrain = 1e-6;

bool is_netcdf(const std::filesystem::path& path) {
  std::ifstream in = input_file("recordings.file", path);
  char head[4] = {};
  in.read(head, 4);
  const std::string_view magic(head, std::size_t(in.gcount()));
  return magic == "\x89HDF" || magic.substr(0, 3) == "CDF";
}

/// Strain in one of this unit; none of a unit of something else.
std::optional<double> strains_in(const std::string& unit) {
  const auto known = reading_unit(unit);
  return known && known->quantity == "strain" ? std::optional(known->size) : std::nullopt;
}

/// What the file's own unit and the case's word mean together: the factor to the inner unit, and its name.
std::pair<double, std::string> inner_unit(const std::string& own, const std::string& asked, const std::string& file) {
  if (const auto strains = strains_in(own)) {
    if (asked != "strain" && !(asked == "microstrain" && *strains == microstrain))
      throw InputError({.problem = fmt::format("the file {} states that its values are in \"{}\"", file, own),
                        .key = "recordings.unit",
                        .value = '"' + asked + '"',
                        .suggestion = fmt::format("write unit = \"{}\"", *strains == microstrain ? "microstrain" : "strain")});
    return {*strains, "strain"};
  }
  if (asked == "microstrain") return {microstrain, "strain"};
  return {1, own.empty() || asked != "strain" ? asked : own};
}

/// Of records that are in a model's own unit: the factor from the file's unit to it; 1 if the file states none. Errors: InputError where it is another that is
/// not known to be the same quantity.
double factor_to_model(const std::string& own, const std::string& unit, const std::string& file) {
  if (own.empty() || own == unit) return 1;
  const auto from = reading_unit(own), to = reading_unit(unit);
  if (from && to && from->quantity == to->quantity) return from->size / to->size;
  throw InputError({.problem = fmt::format("the file {} states that its values are in \"{}\", the model's are in \"{}\" (case.sensor_unit)", file, own, unit),
                    .key = "recordings.file",
                    .suggestion = fmt::format("bring both to one unit; calomel import --unit {} states the unit of a text file", unit)});
}

Recordings read_netcdf(const std::filesystem::path& path, const std::string& unit, bool as_it_is = false) {
  const NetcdfReader file(path);
  const auto dims = file.dimensions("strain");
  const auto shape = file.shape("strain");
  const auto size_of = [&](const std::string& name) -> std::size_t {
    const auto it = std::find(dims.begin(), dims.end(), name);
    return it == dims.end() ? 1 : shape[std::size_t(it - dims.begin())];
  };
  for (const auto& d : dims)
    if (d != "condition" && d != "sensor" && d != "pulse" && d != "time")
      throw InputError({.problem = "strain has the dimension \"" + d + '"', .range = "condition, sensor, pulse, time", .file = path.string()});
  for (const char* d : {"sensor", "time"})
    if (std::find(dims.begin(), dims.end(), d) == dims.end()) throw InputError({.problem = std::string("strain has no dimension ") + d, .file = path.string()});
  Recordings out;
  out.source = path.string();
  out.sensors = file.strings("sensor");
  out.sensor_lines.assign(out.sensors.size(), 0);
  out.time = file.doubles("time");
  const auto seconds = seconds_in(file.attribute("units", "time"));
  if (!seconds)
    throw InputError({.problem = "time is in the unit \"" + file.attribute("units", "time") + '"', .range = "s, ms, us, ns", .file = path.string()});
  for (auto& t : out.time) t *= *seconds;
  const bool has_conditions = std::find(dims.begin(), dims.end(), "condition") != dims.end();
  if (has_conditions && file.has("condition"))
    out.conditions = file.strings("condition");
  else
    for (std::size_t c = 0; c < size_of("condition"); ++c) out.conditions.push_back(has_conditions ? std::to_string(c) : "default");
  if (file.has("pulse") && size_of("pulse") == file.shape("pulse").at(0))
    out.pulses = file.integers("pulse");
  else
    for (std::size_t p = 0; p < size_of("pulse"); ++p) out.pulses.push_back(int(p));
  if (out.sensors.empty() || out.time.empty() || out.pulses.empty()) throw InputError({.problem = "the recordings are empty", .file = path.string()});
  if (!std::is_sorted(out.pulses.begin(), out.pulses.end(), std::less_equal<>{}))
    throw InputError({.problem = "the pulse numbers do not increase", .file = path.string()});
  for (std::size_t k = 1; k < out.time.size(); ++k) {
    const double step = (out.time.back() - out.time.front()) / double(out.time.size() - 1);
    if (!(out.time[k] > out.time[k - 1])) throw InputError({.problem = fmt::format("the time does not increase at index {}", k), .file = path.string()});
    if (std::abs(out.time[k] - out.time[0] - double(k) * step) > 0.01 * step)
      throw InputError({.problem = fmt::format("irregular time at index {}: the samples are not evenly spaced", k),
                        .suggestion = "resample the record on even steps",
                        .file = path.string()});
  }

  // Any order of the dimensions is put into (condition, sensor, pulse, time).
  std::size_t stride[4] = {0, 0, 0, 0}, step = 1;
  for (std::size_t d = dims.size(); d-- > 0; step *= shape[d]) stride[dims[d] == "condition" ? 0 : dims[d] == "sensor" ? 1 : dims[d] == "pulse" ? 2 : 3] = step;
  const auto raw = file.doubles("strain");
  const auto [factor, name] = as_it_is ? std::pair(factor_to_model(file.attribute("units", "strain"), unit, path.string()), unit)
                                       : inner_unit(file.attribute("units", "strain"), unit, path.string());
  out.unit = name;
  out.factor = factor;
  out.values.resize(raw.size());
  std::size_t dropouts = 0;
  for (std::size_t c = 0; c < out.conditions.size(); ++c)
    for (std::size_t s = 0; s < out.sensors.size(); ++s)
      for (std::size_t p = 0; p < out.pulses.size(); ++p) {
        std::size_t missing = 0;
        for (std::size_t t = 0; t < out.time.size(); ++t) {
          const double v = raw[c * stride[0] + s * stride[1] + p * stride[2] + t * stride[3]];
          const bool there = std::isfinite(v) && std::abs(v) < 1e36;  // netCDF's own fill values are 9.97e36
          out.values[out.at(c, s, p, t)] = there ? v * factor : nan;
          missing += !there;
        }
        if (missing < out.time.size()) dropouts += missing;  // a wholly absent pulse is no dropout
      }
  if (dropouts > 0) out.warnings.push_back(fmt::format("{} dropouts (NaN) in {}", dropouts, out.source));
  return out;
}

void multiply(RecordRows& table, double factor) {
  if (factor != 1)
    for (auto& r : table.rows) r.value *= factor;
}

/// From the values of a text file to the model's own unit: factor and name. A column called strain is the customary header, whatever the unit.
std::pair<double, std::string> unit_of_model(const RecordRows& table, const std::string& unit) {
  return {factor_to_model(table.value_column == "microstrain" ? table.value_column : table.unit, unit, table.files[0]), unit};
}

/// From the values of a text file to the inner unit: factor and name.
std::pair<double, std::string> unit_of_strain(const RecordRows& table, const std::string& unit) {
  std::string own = table.unit;
  const bool strain = unit == "strain" || unit == "microstrain";
  for (const char* other : {"stress", "pressure", "force", "voltage", "displacement", "velocity", "acceleration", "temperature"})
    if (strain && own.empty() && table.value_column == other)
      throw InputError({.problem = fmt::format("the column of values is called {} in {}", other, table.files[0]),
                        .key = "recordings.unit",
                        .value = '"' + unit + '"',
                        .suggestion = "name it strain if it is strain; for other readings state the unit (unit, and sensor_unit under [case])"});
  if (table.value_column == "microstrain") {  // strain is the customary header, whatever the unit
    own = table.value_column;
    if (unit != "microstrain")
      throw InputError({.problem = "the column is called microstrain in " + table.files[0],
                        .key = "recordings.unit",
                        .value = '"' + unit + '"',
                        .suggestion = "write unit = \"microstrain\""});
  }
  return inner_unit(own, unit, table.files[0]);
}

/// The rows of a record that is on a grid already, for a merge.
RecordRows rows_of(const Recordings& record) {
  RecordRows out;
  out.files = {record.source};
  out.conditions = record.conditions;
  out.sensors = record.sensors;
  out.sensor_lines = record.sensor_lines;
  out.warnings = record.warnings;
  for (std::size_t c = 0; c < record.conditions.size(); ++c)
    for (std::size_t s = 0; s < record.sensors.size(); ++s)
      for (std::size_t p = 0; p < record.pulses.size(); ++p)
        if (record.recorded(c, s, p))
          for (std::size_t t = 0; t < record.time.size(); ++t)
            out.rows.push_back({int(c), int(s), record.pulses[p], 0, 0, record.time[t], record.values[record.at(c, s, p, t)]});
  return out;
}

/// These sensors at these samples, by their indices.
Recordings selected(const Recordings& all, std::span<const std::size_t> sensors, std::span<const std::size_t> samples) {
  Recordings out = all;
  out.sensors.clear();
  out.sensor_lines.clear();
  out.time.clear();
  for (const auto s : sensors) out.sensors.push_back(all.sensors[s]), out.sensor_lines.push_back(all.sensor_lines[s]);
  for (const auto t : samples) out.time.push_back(all.time[t]);
  out.values.resize(all.conditions.size() * sensors.size() * all.pulses.size() * samples.size());
  for (std::size_t c = 0; c < all.conditions.size(); ++c)
    for (std::size_t s = 0; s < sensors.size(); ++s)
      for (std::size_t p = 0; p < all.pulses.size(); ++p)
        for (std::size_t t = 0; t < samples.size(); ++t) out.values[out.at(c, s, p, t)] = all.values[all.at(c, sensors[s], p, samples[t])];
  return out;
}

int index_in(std::vector<std::string>& names, const std::string& name) {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) return int(it - names.begin());
  names.push_back(name);
  return int(names.size()) - 1;
}

void append(RecordRows& into, RecordRows from) {
  std::vector<int> condition, sensor;
  for (const auto& c : from.conditions) condition.push_back(index_in(into.conditions, c));
  int pulse = 0;
  if (from.wide) {  // the first pulse number at which none of its sensors is recorded yet
    std::vector<int> taken;
    for (const auto& r : into.rows)
      if (std::find(from.sensors.begin(), from.sensors.end(), into.sensors[std::size_t(r.sensor)]) != from.sensors.end() &&
          (taken.empty() || taken.back() != r.pulse))
        taken.push_back(r.pulse);
    while (std::find(taken.begin(), taken.end(), pulse) != taken.end()) ++pulse;
  }
  for (std::size_t s = 0; s < from.sensors.size(); ++s) {
    sensor.push_back(index_in(into.sensors, from.sensors[s]));
    if (into.sensor_lines.size() < into.sensors.size()) into.sensor_lines.push_back(from.sensor_lines[s]);
  }
  const int file = int(into.files.size());
  into.files.push_back(from.files[0]);
  into.warnings.insert(into.warnings.end(), from.warnings.begin(), from.warnings.end());
  for (auto r : from.rows) {
    r.condition = condition[std::size_t(r.condition)];
    r.sensor = sensor[std::size_t(r.sensor)];
    r.file = file;
    if (from.wide) r.pulse = pulse;
    into.rows.push_back(r);
  }
}

}  // namespace

void RecordingOptions::validate() const {
  if (begin && end && *end <= *begin)
    throw InputError({.problem = "the window ends before it begins", .key = "end", .value = number_text(*end), .range = "> " + number_text(*begin)});
}

std::optional<double> RecordingOptions::noise_of(const std::string& sensor) const {
  if (const auto it = noise_by_sensor.sd.find(sensor); it != noise_by_sensor.sd.end()) return it->second;
  return noise_by_sensor.sd.empty() ? noise : std::nullopt;
}

RecordingOptions read_recording_options(CaseFile& file) {
  RecordingOptions options;
  for (const auto& name : file.names("recordings.noise")) options.noise_by_sensor.sd[name] = 0;
  file.read("recordings", options);
  return options;
}

bool Recordings::recorded(std::size_t condition, std::size_t sensor, std::size_t pulse) const {
  const auto* first = values.data() + at(condition, sensor, pulse, 0);
  return std::any_of(first, first + time.size(), [](double v) { return std::isfinite(v); });
}

Recordings read_recordings_file(const std::filesystem::path& path, const std::string& unit, bool as_it_is) {
  if (is_netcdf(path)) return read_netcdf(path, unit, as_it_is);
  RecordRows table = parse_record_text(read_text(path), path.string());
  const auto [factor, name] = as_it_is ? unit_of_model(table, unit) : unit_of_strain(table, unit);
  multiply(table, factor);
  Recordings out = assemble(table);
  out.unit = name;
  out.factor = factor;
  return out;
}

Recordings read_recordings(const std::filesystem::path& path, const RecordingOptions& options) {
  const Recordings all = read_recordings_file(path, options.unit, options.as_it_is);
  for (std::size_t i = 0; i < options.exclude.size(); ++i)
    if (const auto& name = options.exclude[i]; std::find(all.sensors.begin(), all.sensors.end(), name) == all.sensors.end())
      throw InputError({.problem = "a sensor to exclude is not recorded in " + path.string(),
                        .key = "recordings.exclude",
                        .value = '"' + name + '"',
                        .range = join(all.sensors),
                        .suggestion = name_suggestion(name, all.sensors)});
  std::vector<std::size_t> sensors, samples;
  for (std::size_t s = 0; s < all.sensors.size(); ++s)
    if (std::find(options.exclude.begin(), options.exclude.end(), all.sensors[s]) == options.exclude.end()) sensors.push_back(s);
  if (sensors.empty()) throw InputError({.problem = "every recorded sensor is excluded", .key = "recordings.exclude"});
  const double step = all.time.size() > 1 ? all.time[1] - all.time[0] : 0;
  for (std::size_t t = 0; t < all.time.size(); ++t) {
    const double clock = all.time[t] - options.trigger_offset;
    if (clock >= options.begin.value_or(-INFINITY) - 1e-6 * step && clock <= options.end.value_or(INFINITY) + 1e-6 * step) samples.push_back(t);
  }
  if (samples.empty())
    throw InputError({.problem = fmt::format("no sample lies in the window; the record goes from {:.6g} to {:.6g} s", all.time.front() - options.trigger_offset,
                                             all.time.back() - options.trigger_offset),
                      .key = options.begin ? "recordings.begin" : "recordings.end"});
  Recordings out = selected(all, sensors, samples);
  for (auto& t : out.time) t -= options.trigger_offset;
  return out;
}

Recordings at_times_of(const Recordings& recordings, double first, double step, std::vector<std::string>& warnings) {
  constexpr double on_time = 1e-3;  // of a step
  std::vector<std::size_t> kept;
  for (std::size_t t = 0; t < recordings.time.size(); ++t)
    if (const double k = (recordings.time[t] - first) / step; std::abs(k - std::round(k)) < on_time) kept.push_back(t);
  if (kept.size() == recordings.time.size()) return recordings;
  bool even = kept.size() > 1;
  for (std::size_t i = 2; i < kept.size(); ++i) even = even && kept[i] - kept[i - 1] == kept[1] - kept[0];
  if (!even) {
    warnings.push_back(
        fmt::format("the records' times lie between those of the model, {:.4g} s apart: its values are interpolated there, which no error counts; give "
                    "output.time the times of the records",
                    step));
    return recordings;
  }
  warnings.push_back(fmt::format("{} of {} record times are not among those of the model, {:.4g} s apart, and are not compared",
                                 recordings.time.size() - kept.size(), recordings.time.size(), step));
  std::vector<std::size_t> sensors(recordings.sensors.size());
  std::iota(sensors.begin(), sensors.end(), std::size_t{0});
  return selected(recordings, sensors, kept);
}

std::vector<std::string> match_sensors(const Recordings& recordings, std::span<const std::string> declared, const std::filesystem::path& case_file,
                                       const std::filesystem::path& recordings_file, std::span<const std::string> excluded) {
  std::vector<std::string> without;  // declared ones that have no record: the likeliest meant
  for (const auto& name : declared)
    if (std::find(recordings.sensors.begin(), recordings.sensors.end(), name) == recordings.sensors.end()) without.push_back(name);
  for (std::size_t s = 0; s < recordings.sensors.size(); ++s)
    if (std::find(declared.begin(), declared.end(), recordings.sensors[s]) == declared.end())
      throw InputError(
          {.problem = fmt::format("the sensor is recorded but not declared in {}", case_file.string()),
           .value = "sensor \"" + recordings.sensors[s] + '"',
           .range = join(declared),
           .suggestion = fmt::format(
               "declare it ([[sensor]] of a target, output.sensors of an external model), or leave it out with recordings.exclude = [\"{}\"]; {} is \"{}\"",
               recordings.sensors[s], without.empty() ? "the nearest declared one" : "declared without a record",
               nearest_name(recordings.sensors[s], without.empty() ? declared : without)),
           .file = recordings_file.string(),
           .line = recordings.sensor_lines[s]});
  std::vector<std::string> warnings;
  for (const auto& name : without)
    warnings.push_back(std::ranges::count(excluded, name) > 0 ? fmt::format("sensor {} is left out by recordings.exclude: it is predicted, not compared", name)
                                                              : fmt::format("sensor {} is declared but not recorded in {}: it is predicted, not compared", name,
                                                                            recordings_file.filename().string()));
  return warnings;
}

void write_recordings(const std::filesystem::path& path, const Recordings& recordings) {
  const bool conditions = recordings.conditions != std::vector<std::string>{"default"};
  NetcdfWriter file(path);
  std::vector<std::string> dims{"sensor", "pulse", "time"};
  if (conditions) dims.insert(dims.begin(), "condition"), file.dimension("condition", recordings.conditions.size());
  file.dimension("sensor", recordings.sensors.size());
  file.dimension("pulse", recordings.pulses.size());
  file.dimension("time", recordings.time.size());
  if (conditions) file.variable("condition", {"condition"}, recordings.conditions);
  file.variable("sensor", {"sensor"}, recordings.sensors);
  file.variable("pulse", {"pulse"}, recordings.pulses, {{"long_name", "number of the beam pulse"}});
  file.variable("time", {"time"}, recordings.time, {{"units", "s"}});
  file.variable("strain", dims, recordings.values,
                {{"units", recordings.unit == "strain" ? "1" : recordings.unit}, {"long_name", "recorded " + recordings.unit}});
  file.attribute("source", recordings.source);
  file.attribute("program", std::string("calomel ") + version);
  file.commit();
}

ImportSummary import_recordings(std::span<const std::filesystem::path> files, const RecordingOptions& options, const std::filesystem::path& out_dir) {
  expect(!files.empty(), "there is a file to import");
  RecordRows all;
  std::string unit;
  for (const auto& path : files) {
    RecordRows table;
    std::string name;
    if (!std::filesystem::is_regular_file(path))
      throw InputError({.problem = "the file does not exist", .suggestion = "check the name", .file = path.string()});
    if (is_netcdf(path)) {
      const Recordings record = read_netcdf(path, options.unit);
      table = rows_of(record);
      name = record.unit;
    } else {
      table = parse_record_text(read_text(path), path.string());
      const auto [factor, unit_of_file] = unit_of_strain(table, options.unit);
      multiply(table, factor);
      name = unit_of_file;
    }
    if (!unit.empty() && name != unit)
      throw InputError({.problem = fmt::format("the values are in {}, those of {} in {}", name, files[0].string(), unit), .file = path.string()});
    unit = name;
    append(all, std::move(table));
  }
  ImportSummary summary{out_dir / "recordings.nc", assemble(all)};
  summary.recordings.unit = unit;
  write_recordings(summary.path, summary.recordings);
  return summary;
}

}  // namespace calomel
