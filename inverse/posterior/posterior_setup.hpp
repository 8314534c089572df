#pragma once
/// From the true model, recordings and options to the complete inputs of a posterior's fit, in one step.
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "forward/simulation/meshed_runs.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// The options of a case that decide its posterior.
struct PosteriorSettings {
  EmulatorOptions emulator;
  ErrorOptions errors;
  bool physical = false;                 ///< handbook priors and a discrepancy (map.product = "physical")
  bool discrepancy_times_given = false;  ///< the case sets errors.discrepancy_times; else they may be lengthened to the records' scale
  bool amplitude_time_given = false;     ///< the case sets errors.amplitude_time; likewise
  int pulses = 1;                        ///< number of pulse energies whose mean a run is
  double energy_sd = 0;                  ///< relative standard deviation of the energy from pulse to pulse
};

/// The defaults of [errors] for a model.
ErrorOptions default_errors(const Simulator& simulator);

/// The parameters of the posterior: those of the case, with handbook priors for the physical product, and after them the uncertain numbers of the model that
/// have a prior and are none of them. Errors: those of with_handbook_priors.
std::vector<Parameter> posterior_parameters(const Simulator& simulator, const PosteriorSettings& settings);

/// Half width of the emulator's first box in a parameter of a posterior on meshes, in the coordinate of the parameter.
double first_half_width(const Parameter& parameter, const InferenceHints& hints);

/// What a posterior is set up from. What is referred to outlives the inputs.
struct PosteriorCase {
  Runs& runs;
  const Problem& problem;
  const Recordings& recordings;
  const RecordingOptions& recording_options;
  PosteriorSettings settings;
  std::uint64_t seed = 1;
  int threads = 1;
  const ForwardModel* surrogate = nullptr;  ///< the model on which the middle of the first box is searched; null: the nominal values
  bool first_box = true;                    ///< false: the inputs are used without an emulator
  Runs::Progress progress = {};             ///< of the runs
  Runs::Progress basin_progress = {};       ///< of that search
};

/// The runs of a posterior: its parameters on the emulator's meshes. `runs` outlives the result.
MeshedRuns meshed_runs(Runs& runs, const PosteriorSettings& settings);

/// Errors: InputError for recordings or meshes, where no parameter may vary, and for times of [errors] far below the records' scale; NumericsError where no
/// run succeeds; those of Runs.
std::unique_ptr<PosteriorInputs> set_up_posterior(const PosteriorCase& posterior_case);

}  // namespace calomel
