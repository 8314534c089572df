#pragma once
/// What the stages of one call share.
#include "apps/inputs/study_inputs.hpp"
#include "apps/pipeline/case_correction.hpp"
#include "apps/pipeline/case_posterior.hpp"
#include "apps/pipeline/finished_stages.hpp"
#include "apps/presentation/data_check_words.hpp"

namespace calomel {

/// Each stage is a function of it, X_stage(call): it reuses what is finished and matches, makes first, saying so, what it needs and does not find, writes its
/// artefacts to --out and prints its result. Its status is done or not_to_be_trusted.
struct StageCall {
  /// `command` outlives the object. Errors: as StudyInputs.
  explicit StageCall(const CommandLine& command)
      : inputs(command, problem_warnings), finished(command.out, command.fresh), posterior(inputs), correction(inputs, posterior) {}

  StudyInputs inputs;
  FinishedStages finished;
  FittedPosterior posterior;
  FittedCorrection correction;
  bool trained = false;  ///< train_stage has seen to surrogate.nc
};

/// The worse of two ends.
inline ExitStatus worse(ExitStatus a, ExitStatus b) { return a == ExitStatus::done ? b : a; }

/// Refuses an option that has nothing to do here. Errors: InputError where it is requested.
inline void refuse(bool requested, const char* option, const char* why) {
  if (requested) throw InputError({.problem = why, .key = option, .suggestion = "leave it out"});
}

}  // namespace calomel
