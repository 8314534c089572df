#include "apps/inputs/study_inputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"

namespace calomel {

namespace {

constexpr double no_strain = 0.01;  ///< root mean square, more than a gauge lives through
constexpr double long_after = 2;    ///< times the records' end, beyond which the end of the run is reported

/// Errors: InputError for records of strain gauges that are no strain, or cannot be.
void expect_strain(const StudyCase& study, const Recordings& recordings) {
  if (recordings.unit != "strain")
    throw study.file.located(InputError({.problem = "the gauges of a target measure strain",
                                         .key = "recordings.unit",
                                         .value = '"' + recordings.unit + '"',
                                         .range = "strain, microstrain",
                                         .suggestion = name_suggestion(recordings.unit, std::vector<std::string>{"strain", "microstrain"})}));
  double squares = 0, samples = 0, most = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < recordings.values.size(); ++i)
    if (const double v = recordings.values[i]; std::isfinite(v)) {
      squares += v * v;
      ++samples;
      if (std::abs(v) > most) {
        most = std::abs(v);
        at = i;
      }
    }
  if (squares <= no_strain * no_strain * samples) return;
  const std::size_t n = recordings.time.size(), sensor = at / n / recordings.pulses.size() % recordings.sensors.size();
  const std::string& unit = study.recordings->unit;
  throw study.file.located(InputError(
      {.problem = fmt::format("the records have a root mean square strain of {:.3g}, which no gauge lives through; the largest is {:.3g} of {} at {:.6g} s",
                              std::sqrt(squares / samples), most, recordings.sensors[sensor], recordings.time[at % n]),
       .key = "recordings.unit",
       .value = '"' + unit + '"',
       .range = "strain, microstrain",
       .suggestion =
           unit == "strain" ? "if they are in microstrain, write unit = \"microstrain\"" : "see whether that sample is a dropout, and write nan for it"}));
}

/// Compares the times and units of the case with its records. Errors: those of expect_strain.
void expect_alike(const StudyCase& study, const ModelShape& shape, const Recordings& recordings, std::vector<std::string>& warnings) {
  if (study.capabilities().strain_gauges) expect_strain(study, recordings);
  if (recordings.time.size() < 2) return;
  const double end = recordings.time.back(), length = end - recordings.time.front();
  if (!shape.times.empty() && shape.times.back() > long_after * end)
    warnings.push_back(
        fmt::format("the simulation ends at {:.4g} s and the records at {:.4g} s: the simulation after that is not compared", shape.times.back(), end));
  if (study.errors.band * length < 0.5)
    warnings.push_back(
        fmt::format("errors.band = {} Hz: the records are {:.4g} s long and hold no half period of this frequency, so that little of them is compared; from "
                    "{:.4g} Hz on they do",
                    number_text(study.errors.band), length, 0.5 / length));
}

}  // namespace

StudyInputs::StudyInputs(const CommandLine& command, std::function<std::vector<std::string>(const Problem&)> warnings_of)
    : command_(command),
      study_(StudyCase::read(command.case_file, command.overrides, &stop_requested())),
      notes_(std::cerr, command.quiet),
      warnings_of_(std::move(warnings_of)),
      executor_(command.threads) {
  if (command.power && !study_.capabilities().planning)
    throw study_.file.located(InputError({.problem = "the power of an experiment is computed for a target only in this version, not for another model",
                                          .key = "model.kind",
                                          .suggestion = "leave out --power"}));
  if ((command.verb == "check" && !command.floor) || command.verb == "report") return;
  make_directory(command.out);
  if (command.verb != "serve") lock_.emplace(command.out);
}

const Problem& StudyInputs::problem() {
  if (!problem_) {
    std::vector<std::string> warnings;
    const ModelShape& shape = simulator().shape();
    recordings_ = study_.matched_recordings(warnings);
    expect_alike(study_, shape, *recordings_, warnings);
    problem_ = study_.file.locating([&] { return make_problem(shape, *recordings_, *study_.recordings); });
    if (warnings_of_) problem_->warnings = warnings_of_(*problem_);
    notes_.warn(warnings);
    notes_.warn(problem_->warnings);
  }
  return *problem_;
}

const Recordings& StudyInputs::recordings() {
  (void)problem();
  return *recordings_;
}

std::filesystem::path StudyInputs::journal(const std::string& name, const Provenance& provenance) const {
  auto path = artefact(name);
  if (command_.fresh && std::filesystem::exists(path) && RunStore::identity(path) != provenance.identity()) set_aside(path);
  return path;
}

StudyInputs::OtherRuns StudyInputs::runs_of(const Simulator& simulator, const std::string& name) const {
  const auto provenance = runs_provenance(study_, simulator);
  OtherRuns out;
  if (command_.verb == "serve")  // without the folder's lock, it keeps no journal
    out.store = std::make_unique<RunStore>();
  else
    out.store = std::make_unique<RunStore>(provenance, journal(name, provenance));
  out.runs = std::make_unique<Runs>(simulator, *out.store, executor_, &stop_requested());
  return out;
}

Runs& StudyInputs::runs() {
  if (!runs_) {
    OtherRuns made = runs_of(simulator(), "runs.journal");
    store_ = std::move(made.store);
    runs_ = std::move(made.runs);
  }
  return *runs_;
}

PosteriorCase StudyInputs::posterior_case(const Runs::Progress& progress) {
  return {.runs = runs(),
          .problem = problem(),
          .recordings = recordings(),
          .recording_options = *study_.recordings,
          .settings = study_.posterior_settings(),
          .seed = command_.seed,
          .threads = command_.threads,
          .progress = progress};
}

}  // namespace calomel
