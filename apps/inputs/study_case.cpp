#include "apps/inputs/study_case.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/artefact.hpp"
#include "base/json.hpp"

namespace calomel {

const std::vector<std::string>& known_tables() {
  static const std::vector<std::string> tables{"case",      "geometry",    "material",  "load",      "time",     "solver",    "sensor", "sensors", "recordings",
                                               "parameter", "mechanism",   "model",     "condition", "campaign", "surrogate", "enc",    "spe",     "map",
                                               "sampler",   "sensitivity", "diagnosis", "power",     "report",   "study",     "fields", "output",  "floor",
                                               "emulator",  "errors",      "posterior", "line",      "drive",    "station"};
  return tables;
}

namespace {

/// Those of a target's strain gauges and of its beam.
void no_errors_of_gauges(ErrorOptions& e) { e.energy_scale_sd = 0, e.gain_sd = 0, e.baseline = 0, e.coherent_noise = 0; }

/// `[errors]` of a model outside, where the case says nothing: the noise of its records alone, on the model's own times; and, of the physical product, a
/// discrepancy on the scale of the records.
ErrorOptions errors_of_external(const ExternalCase& external) {
  constexpr double slack = 1.01;                                                                              // of rounding in the times
  constexpr double short_share = 1.0 / 40, long_share = 1.0 / 10, local_share = 1.0 / 16, least_steps = 1.5;  // of the record's length; of its steps
  ErrorOptions e;
  const double step = external.time.step, length = std::max(external.time.count - 1, 1) * step;
  e.band = slack * 0.5 / step;
  no_errors_of_gauges(e);
  e.young_sd = 0, e.wall_film_sd = 0, e.gauge_place_sd = 0;
  e.beyond = 0, e.beyond_sd = 0, e.beyond_rest = 0, e.record_noise = 0, e.mesh = 0, e.arrival_share = 0;
  e.discrepancy_times = {std::max(short_share * length, least_steps * step), std::max(long_share * length, least_steps * step)};
  e.amplitude_time = std::max(local_share * length, least_steps * step);
  return e;
}

/// Before the model is asked for anything. Errors: InputError for a sampler that cannot sample this case.
void expect_sampler_fits(const StudyCase& study) {
  const SamplerOptions& sampler = study.sampler;
  const SamplerEntry& entry = sampler.entry();
  if (!entry.first_stage.empty() && study.external && (study.is_log_density() || !study.file.has("surrogate")))
    throw InputError({.problem = "walks on an emulator first, and here chains walk on the model itself",
                      .key = "sampler.kind",
                      .value = '"' + sampler.kind + '"',
                      .suggestion = fmt::format("take \"{}\"{}", entry.first_stage,
                                                study.is_log_density() ? "" : ", or add a [surrogate] table so that there is an emulator")});
  if (entry.check) entry.check(sampler, study.parameters().size());
}

}  // namespace

StudyCase StudyCase::read(const std::filesystem::path& path, std::span<const std::string> overrides) {
  CaseFile file(path, overrides);
  file.expect_all_read(known_tables());  // a misspelt table is told before the keys that it leaves missing
  std::optional<LineCase> line;
  if (is_line_case(file)) line = file.locating([&] { return LineCase::read(file); });
  std::optional<ExternalCase> external;
  if (!line && file.text("model.kind") == "umbridge") external = file.locating([&] { return ExternalCase::read(file); });
  ForwardCase forward = line || external ? ForwardCase{} : file.locating([&] { return ForwardCase::read(file); });
  StudyCase study{.file = std::move(file), .forward = std::move(forward), .line = std::move(line), .external = std::move(external)};
  if (!study.external && study.file.has("output"))
    throw study.file.located(InputError({.problem = "this table belongs to a model outside of the program",
                                         .key = "output",
                                         .suggestion = "add [model] with kind = \"umbridge\", or take it out"}));
  for (const char* of_a_line : {"line", "drive", "station"})
    if (!study.line && !study.external && study.file.has(of_a_line))
      throw study.file.located(InputError({.problem = "this table belongs to a line, the model is one on a mesh",
                                           .key = of_a_line,
                                           .suggestion = "add [model] with kind = \"line\", or take it out"}));
  study.file.read("campaign", study.campaign);
  study.file.read("floor", study.floor);
  study.file.read("surrogate", study.surrogate);
  study.file.read("enc", study.enc);
  study.file.read("spe", study.spe);
  study.file.read("map", study.map);
  study.file.read("emulator", study.emulator);
  if (study.line) no_errors_of_gauges(study.errors);
  if (study.external) study.errors = errors_of_external(*study.external);
  study.file.read("errors", study.errors);
  study.file.read("posterior", study.posterior);
  const auto sampler = study.file.text("sampler.kind");
  study.sampler = default_sampler_options(sampler && samplers().contains(*sampler) ? *sampler : study.sampler.kind, study.external.has_value());
  study.file.read("sampler", study.sampler);
  study.file.locating([&] { expect_sampler_fits(study); });
  constexpr int quick_runs = 10000;  // of a model whose runs take milliseconds
  if (!study.on_mesh()) study.diagnosis.max_runs = quick_runs;
  study.file.read("diagnosis", study.diagnosis);
  study.file.read("power", study.power);
  study.file.read("sensitivity", study.sensitivity);
  if (study.sensitivity.run_totals && !study.on_mesh())
    throw study.file.located(InputError({.problem = "only runs on a mesh keep an energy balance, the model is another",
                                         .key = "sensitivity.run_totals",
                                         .value = "true",
                                         .suggestion = "leave it out"}));
  study.file.read("study", study.study);
  study.file.read("fields", study.fields);
  NoKeys none;
  study.file.read("report", none);
  if (study.file.has("recordings")) study.recordings = study.file.locating([&] { return read_recording_options(study.file); });
  if (study.recordings && !study.on_mesh()) {
    auto& records = *study.recordings;
    if (study.file.has("recordings.unit") && records.unit != study.unit())
      throw study.file.located(InputError({.problem = "the model's values are in " + study.unit() + " (case.sensor_unit), and records are in the same unit",
                                           .key = "recordings.unit",
                                           .value = '"' + records.unit + '"',
                                           .suggestion = "set case.sensor_unit to what both are in, or take recordings.unit out"}));
    records.unit = study.unit(), records.as_it_is = true;
  }
  return study;
}

std::vector<std::string> StudyCase::listed_mechanisms() const {
  std::vector<std::string> names = forward.listed_mechanisms;
  if (line)
    for (const auto& m : line->mechanisms)
      if (m.listed) names.push_back(m.name);
  std::sort(names.begin(), names.end());
  return names;
}

Json StudyCase::echo() const {
  Json all = line ? line->echo() : external ? external->echo() : forward.echo();
  if (recordings) all["recordings"] = calomel::echo(*recordings);
  all["campaign"] = calomel::echo(campaign);
  all["floor"] = calomel::echo(floor);
  all["surrogate"] = calomel::echo(surrogate);
  all["enc"] = calomel::echo(enc);
  all["spe"] = calomel::echo(spe);
  all["map"] = calomel::echo(map);
  all["emulator"] = calomel::echo(emulator);
  all["errors"] = calomel::echo(errors);
  all["posterior"] = calomel::echo(posterior);
  all["sampler"] = calomel::echo(sampler);
  all["diagnosis"] = calomel::echo(diagnosis);
  all["power"] = calomel::echo(power);
  all["sensitivity"] = calomel::echo(sensitivity);
  all["study"] = calomel::echo(study);
  all["fields"] = calomel::echo(fields);
  return all;
}

Json StudyCase::model_options() const {
  if (line) return line->echo();
  if (external) return external->model_options();
  Json options = forward.echo();
  for (const char* changes_nothing : {"checkpoint", "energy_balance"})
    options["solver"].erase(changes_nothing);                                     // how often a run is saved, whether its energies are told
  if (options["solver"]["subcycles"] == 1) options["solver"].erase("subcycles");  // off, as in all that was made before there were any
  Json parameters = Json::object();
  for (const auto& p : forward.parameters) {
    parameters[p.name] = {{"key", p.key}, {"min", p.min}, {"max", p.max}};
    if (p.nominal) parameters[p.name]["nominal"] = *p.nominal;
  }
  options["parameter"] = std::move(parameters);
  return options;
}

std::map<std::string, std::string> StudyCase::model_inputs() const {
  std::map<std::string, std::string> inputs;
  for (const char* key : {"geometry.file", "load.file", "sensors", "drive.file"})
    if (const auto name = file.text(key)) inputs[key] = hash_file(file.resolve(*name));
  return inputs;
}

std::filesystem::path StudyCase::recordings_file() const {
  if (!recordings)
    throw InputError({.problem = "the case has no [recordings] to compare with",
                      .suggestion = "add [recordings] with file = \"recordings.csv\" (or a .nc from calomel import)",
                      .file = file.path().string()});
  return file.resolve(recordings->file);
}

Recordings StudyCase::matched_recordings(std::span<const std::string> sensors, std::vector<std::string>& warnings) const {
  const auto path = recordings_file();
  auto read = file.locating([&] { return read_recordings(path, *recordings); });
  const auto unmatched = match_sensors(read, sensors, file.path(), path, recordings->exclude);
  warnings.insert(warnings.end(), unmatched.begin(), unmatched.end());
  return external && external->time.count > 1 ? at_times_of(read, external->time.start, external->time.step, warnings) : read;
}

}  // namespace calomel
