#include "apps/inputs/study_case.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "forward/simulation/simulator_kinds.hpp"

namespace calomel {

const std::vector<std::string>& known_tables() {
  static const std::vector<std::string> tables = [] {
    std::vector<std::string> all{"case",      "model",  "parameter", "mechanism", "recordings", "campaign",    "floor",
                                 "surrogate", "enc",    "spe",       "map",       "sampler",    "sensitivity", "diagnosis",
                                 "power",     "report", "study",     "fields",    "emulator",   "errors",      "posterior"};
    for (const auto& kind : simulator_kinds().rows())
      for (const auto& table : kind.entry.tables)
        if (std::find(all.begin(), all.end(), table) == all.end()) all.push_back(table);
    return all;
  }();
  return tables;
}

namespace {

/// Errors: InputError for a sampler that cannot sample this case.
void expect_sampler_fits(const StudyCase& study) {
  const SamplerOptions& sampler = study.sampler;
  const SamplerEntry& entry = sampler.entry();
  if (!entry.first_stage.empty() && study.runs_the_model_itself())
    throw InputError({.problem = "walks on an emulator first, and here chains walk on the model itself",
                      .key = "sampler.kind",
                      .value = '"' + sampler.kind + '"',
                      .suggestion = fmt::format("take \"{}\"{}", entry.first_stage,
                                                study.capabilities().log_density ? "" : ", or add a [surrogate] table so that there is an emulator")});
  if (entry.check) entry.check(sampler, study.parameters().size());
}

}  // namespace

StudyCase StudyCase::read(const std::filesystem::path& path, std::span<const std::string> overrides, const std::atomic<bool>* stop) {
  StudyCase study{.file = CaseFile(path, overrides), .simulator = nullptr};
  study.file.expect_all_read(known_tables());  // a misspelt table is reported before the keys that it leaves missing
  study.file.read("campaign", study.campaign);
  study.simulator = make_simulator(study.file, {.pulses = study.campaign.pulses, .energy_sd = study.campaign.pulse_energy_sd, .stop = stop});
  const Capabilities& can = study.capabilities();
  study.file.read("floor", study.floor);
  study.file.read("surrogate", study.surrogate);
  study.file.read("enc", study.enc);
  study.file.read("spe", study.spe);
  study.file.read("map", study.map);
  study.file.read("emulator", study.emulator);
  study.errors = default_errors(*study.simulator);
  study.file.read("errors", study.errors);
  study.file.read("posterior", study.posterior);
  const auto sampler = study.file.text("sampler.kind");
  study.sampler = default_sampler_options(sampler && samplers().contains(*sampler) ? *sampler : study.sampler.kind, can.cheap_runs);
  study.file.read("sampler", study.sampler);
  study.file.locating([&] { expect_sampler_fits(study); });
  constexpr int quick_runs = 10000;  // of a model whose runs take milliseconds
  if (can.cheap_runs) study.diagnosis.max_runs = quick_runs;
  study.file.read("diagnosis", study.diagnosis);
  study.file.read("power", study.power);
  study.file.read("sensitivity", study.sensitivity);
  if (study.sensitivity.run_totals && !can.energy_balance)
    throw study.file.located(InputError({.problem = "only runs on a mesh keep an energy balance, and the model of this case has no mesh",
                                         .key = "sensitivity.run_totals",
                                         .value = "true",
                                         .suggestion = "leave it out"}));
  study.file.read("study", study.study);
  study.file.read("fields", study.fields);
  NoKeys none;
  study.file.read("report", none);
  if (study.file.has("recordings")) study.recordings = study.file.locating([&] { return read_recording_options(study.file); });
  if (study.recordings && !can.strain_gauges) {
    auto& records = *study.recordings;
    const std::string& unit = study.simulator->shape().unit;
    if (study.file.has("recordings.unit") && records.unit != unit)
      throw study.file.located(InputError({.problem = "the model's values are in " + unit + " (case.sensor_unit), and records are in the same unit",
                                           .key = "recordings.unit",
                                           .value = '"' + records.unit + '"',
                                           .suggestion = "set case.sensor_unit to what both are in, or take recordings.unit out"}));
    records.unit = unit;
    records.as_it_is = true;
  }
  return study;
}

PosteriorSettings StudyCase::posterior_settings() const {
  return {.emulator = emulator,
          .errors = errors,
          .physical = physical(),
          .discrepancy_times_given = file.has("errors.discrepancy_times"),
          .amplitude_time_given = file.has("errors.amplitude_time"),
          .pulses = campaign.pulses,
          .energy_sd = campaign.pulse_energy_sd};
}

Json StudyCase::echo() const {
  Json all = simulator->echo();
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

std::filesystem::path StudyCase::recordings_file() const {
  if (!recordings)
    throw InputError({.problem = "the case has no [recordings] to compare with",
                      .suggestion = "add [recordings] with file = \"recordings.csv\" (or a .nc from calomel import)",
                      .file = file.path().string()});
  return file.resolve(recordings->file);
}

Recordings StudyCase::matched_recordings(std::vector<std::string>& warnings) const {
  const auto path = recordings_file();
  const ModelShape& shape = simulator->shape();
  auto read = file.locating([&] { return read_recordings(path, *recordings); });
  const auto unmatched = match_sensors(read, shape.sensors, file.path(), path, recordings->exclude);
  warnings.insert(warnings.end(), unmatched.begin(), unmatched.end());
  const auto& times = shape.times;
  const double step = simulator->hints().time_step;
  return step > 0 && times.size() > 1 ? at_times_of(read, times[0], step, warnings) : read;
}

}  // namespace calomel
