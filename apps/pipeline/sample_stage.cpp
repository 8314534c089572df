#include "apps/pipeline/sample_stage.hpp"

#include <fmt/format.h>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/predictive_groups.hpp"
#include "apps/pipeline/sample_artefacts.hpp"
#include "apps/pipeline/sample_emulator.hpp"
#include "apps/pipeline/sample_model_stage.hpp"
#include "apps/pipeline/sample_parts.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/pipeline/train_stage.hpp"
#include "apps/presentation/convergence_words.hpp"
#include "apps/presentation/data_check_words.hpp"
#include "apps/presentation/fit_words.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "base/provenance.hpp"
#include "inverse/posterior/emulator_meshes.hpp"
#include "inverse/posterior/goodness_of_fit.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"
#include "uq/data_checks.hpp"
#include "uq/posterior_moments.hpp"
#include "uq/posterior_file.hpp"
#include "uq/refinement.hpp"
#include "uq/regions.hpp"
#include "uq/sampler/sampler.hpp"
#include "uq/true_model_density.hpp"

namespace calomel {

ExitStatus sample_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& study = inputs.study();
  const auto& notes = inputs.notes();
  if (study.runs_the_model_itself()) return sample_model_stage(call);
  (void)inputs.problem();  // before any long work, so that wrong recordings are reported at once
  need_basin(call);
  const auto provenance = posterior_provenance(inputs);
  if (const auto status = finished_sample(call, provenance)) return *status;
  const auto progress = stage_progress("sample", command.quiet);
  const CasePosterior& made = call.posterior.get(progress);
  const auto& parameters = made.inputs->parameters;
  notes.say(stage_line("sample", emulator_sentence(made.fit)));
  // The check comes before the chains: what they walk on is the last emulator.
  const RefinedFit refined = check_and_refine(
      *made.inputs, made.fit, study.posterior.refinements, [&](const TrueModelCheck& c) { notes.say(stage_line("sample", check_sentence(c))); },
      [&](const PosteriorRound& r) { notes.say(round_line(r, parameters)); });
  const PosteriorFit& fit = refined.fit;
  const TrueModelCheck& check = refined.check;
  if (!refined.refinements.empty()) notes.say(stage_line("sample", refinement_sentence(refined)));

  const bool second_stage = !study.sampler.entry().first_stage.empty();
  const SampledEmulator sampled(*made.inputs, fit, second_stage ? 0 : study.posterior.hyperparameter_draws, command.seed, command.threads);
  const LogDensity& density = sampled.density();
  const SamplerRun run = saved_run(call, provenance, progress);
  const TrueModelDensity exact(*made.inputs, fit);
  const auto modes = modes_in_box(*fit.posterior, fit.modes, command.seed, command.threads);
  if (modes.size() > 1) notes.say(stage_line("sample", modes_sentence(density, modes)));
  const SamplerStart begin = start_at_modes(*fit.posterior, fit.modes, modes);
  const auto result = second_stage ? run_sampler(density, exact, begin, study.sampler, run) : run_sampler(density, begin, study.sampler, run);
  const Convergence convergence = assessed(result, study.sampler.thin);
  const auto alarms = absorption(parameters, convergence);
  const GoodnessOfFit goodness = goodness_of_fit(residual_of(fit));
  auto warnings = data_check_sentences(check_data(*made.inputs, fit), made.inputs->errors);
  warnings.insert(warnings.end(), made.inputs->warnings.begin(), made.inputs->warnings.end());
  if (!goodness.adequate) warnings.push_back(goodness_sentence(goodness));

  auto groups = posterior_groups(parameters, result);
  for (auto& g : predictive_groups(predicting(fit, parameters), inputs.problem(), result, command.seed)) groups.push_back(std::move(g));
  const bool trusted = convergence.converged && fit.settled && check.holds;
  Json json = posterior_json(convergence, convergence_sentence(convergence), result, provenance);
  json["status"] = trusted ? "done" : "not_to_be_trusted";
  json["product"] = study.physical() ? "physical" : "tuned";
  json["final"] = trusted && warnings.empty() && alarms.empty();  // a warning names a change that would move the result, for example finer meshes
  // What was drawn is the posterior when the chains have converged, on an emulator that has settled, where the true model agrees with the emulator.
  json["chains_converged"] = convergence.converged;
  json["converged"] = trusted;
  json["message"] = verdict_sentence(convergence, fit, check);
  json["mode"] = fit_json(fit, parameters, settling_text(fit.settling()));
  json["modes"] = modes_json(density, modes);
  json["true_model_check"] = check_json(check, parameters, check_sentence(check));
  json["refinement"] = refinement_json(refined, study.posterior.refinements);
  json["hyperparameters"] = sampled.hyperparameters(result, estimate_only_reason(study.sampler));
  std::vector<std::string> own;
  for (const auto& p : study.parameters()) own.push_back(p.name);
  json["regions"] = regions_json(regions(result.quantities, own));
  for (const auto& form : study.posterior.compare)
    json["compared"][form] = sample_compared(form, *made.inputs, fit, own, study.sampler,
                                             {.seed = command.seed, .threads = command.threads, .journal = {}, .provenance = {}, .stop = &stop_requested()});
  json["adequate"] = goodness.adequate;
  json["adequacy"] = goodness_sentence(goodness);
  json["absorption"] = alarms;
  json["warnings"] = warnings;
  json["runs"] = {{"made", inputs.runs().made()},
                  {"reused", inputs.runs().reused()},
                  {"held", inputs.runs().store().size()},
                  {"element_sizes", element_sizes(inputs.simulator(), study.emulator)}};
  write_sample(call, groups, json, provenance);
  notes.say(draws_lines(convergence));
  if (json["hyperparameters"].contains("sentence")) notes.say(stage_line("sample", json["hyperparameters"]["sentence"].get<std::string>()));
  notes.warn(alarms);
  notes.warn(warnings);
  notes.say(stage_line("sample", convergence_sentence(convergence)));
  if (exact.failed() > 0)
    notes.warn({fmt::format("{} runs of the true model failed at the sampler's proposals; the density counts as zero there", exact.failed())});
  if (!fit.settled) notes.warn(emulator_sentence(fit));
  return trusted ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

}  // namespace calomel
