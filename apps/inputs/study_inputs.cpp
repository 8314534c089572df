#include "apps/inputs/study_inputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "apps/inputs/posterior_case.hpp"
#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"

namespace calomel {

namespace {

constexpr double no_strain = 0.01;  ///< root mean square, more than a gauge lives through
constexpr double long_after = 2;    ///< times the records' end, from which on a run's end is told

/// Errors: InputError for records of a target that are no strain, or cannot be.
void expect_strain(const StudyCase& study, const Recordings& recordings) {
  if (recordings.unit != "strain")
    throw study.file.located(InputError({.problem = "the gauges of a target tell strain",
                                         .key = "recordings.unit",
                                         .value = '"' + recordings.unit + '"',
                                         .range = "strain, microstrain",
                                         .suggestion = name_suggestion(recordings.unit, std::vector<std::string>{"strain", "microstrain"})}));
  double squares = 0, samples = 0, most = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < recordings.values.size(); ++i)
    if (const double v = recordings.values[i]; std::isfinite(v)) {
      squares += v * v, ++samples;
      if (std::abs(v) > most) most = std::abs(v), at = i;
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

/// Holds what the case says of times and units against its records. Errors: those of expect_strain.
void expect_alike(const StudyCase& study, const ModelShape& shape, const Recordings& recordings, std::vector<std::string>& warnings) {
  if (study.on_mesh()) expect_strain(study, recordings);
  if (recordings.time.size() < 2) return;
  const double end = recordings.time.back(), length = end - recordings.time.front();
  if (!shape.times.empty() && shape.times.back() > long_after * end)
    warnings.push_back(fmt::format("the simulation ends at {:.4g} s and the records at {:.4g} s: what is simulated after that is compared with nothing",
                                   shape.times.back(), end));
  if (study.errors.band * length < 0.5)
    warnings.push_back(
        fmt::format("errors.band = {} Hz: the records are {:.4g} s long and hold no half period of this frequency, so that little of them is compared; from "
                    "{:.4g} Hz on they do",
                    number_text(study.errors.band), length, 0.5 / length));
}

}  // namespace

StudyInputs::StudyInputs(const CommandLine& command)
    : command_(command), study_(StudyCase::read(command.case_file, command.overrides)), notes_(std::cerr, command.quiet) {
  if (study_.line && command.verb != "check" && command.verb != "simulate" && command.verb != "diagnose" && command.verb != "report")
    throw study_.file.located(InputError({.problem = "a line is checked, simulated, diagnosed and reported in this version, not: " + command.verb,
                                          .key = "model.kind",
                                          .suggestion = "use check, simulate, diagnose or report"}));
  if (!study_.on_mesh() && command.power)
    throw study_.file.located(InputError({.problem = "what an experiment could tell is asked of a target only in this version, not of another model",
                                          .key = "model.kind",
                                          .suggestion = "leave out --power"}));
  if (study_.external) study_.external->server.stop = &stop_requested();
  if ((command.verb == "check" && !command.floor) || command.verb == "report") return;
  make_directory(command.out);
  if (command.verb != "serve") lock_.emplace(command.out);
}

const BuiltInModel& StudyInputs::model() {
  if (!model_)
    model_ = study_.file.locating([&] {
      const bool alone = command_.verb == "simulate" || command_.verb == "check";  // the other stages run evaluations side by side
      return std::make_unique<BuiltInModel>(study_.forward, ensemble(), alone ? command_.threads : 1);
    });
  return *model_;
}

const LineModel& StudyInputs::line() {
  expect(study_.line.has_value(), "only a line has a line model");
  if (!line_) line_ = std::make_unique<LineModel>(*study_.line);
  return *line_;
}

const ExternalModel& StudyInputs::external() {
  expect(study_.external.has_value(), "only a case with a model outside has one");
  if (!external_) external_ = study_.file.locating([&] { return std::make_unique<ExternalModel>(*study_.external); });
  return *external_;
}

const ForwardModel& StudyInputs::any_model() {
  if (study_.line) return line();
  if (study_.external) return external();
  return model();
}

NumberedRuns& StudyInputs::numbered_runs() {
  if (!numbered_runs_) {
    const NumberedModel& quick = study_.line ? static_cast<const NumberedModel&>(line()) : external();
    numbered_runs_ = std::make_unique<NumberedRuns>(quick, runs());
  }
  return *numbered_runs_;
}

const Problem& StudyInputs::problem() {
  if (!problem_) {
    std::vector<std::string> warnings;
    const ModelShape& shape = any_model().shape();
    recordings_ = study_.matched_recordings(shape.sensors, warnings);
    expect_alike(study_, shape, *recordings_, warnings);
    problem_ = study_.file.locating([&] { return make_problem(shape, *recordings_, *study_.recordings); });
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

RunStore& StudyInputs::runs() {
  if (!runs_) {
    const auto provenance = runs_provenance(study_);
    runs_ = std::make_unique<RunStore>(provenance, journal("runs.journal", provenance));
  }
  return *runs_;
}

LevelRuns& StudyInputs::levels() {
  if (!levels_)
    levels_ = study_.file.locating([&] {
      return std::make_unique<LevelRuns>(study_.forward, ensemble(), posterior_parameters(study_), element_sizes(study_), study_.emulator.viscosity, runs());
    });
  return *levels_;
}

}  // namespace calomel
