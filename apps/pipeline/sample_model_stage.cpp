#include "apps/pipeline/sample_model_stage.hpp"

#include <fmt/format.h>

#include "apps/inputs/posterior_inputs.hpp"
#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/predictive_groups.hpp"
#include "apps/pipeline/sample_parts.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "inverse/posterior/direct_start.hpp"
#include "inverse/posterior/model_mode.hpp"
#include "uq/model_density.hpp"

namespace calomel {

namespace {

constexpr double long_wait = 600;  ///< [s] that is told before the chains begin

/// Chains begin about the mode of a log density, or where the records are fitted best.
SamplerStart start_of(StageCall& call, const ModelPosterior& posterior) {
  if (posterior.is_log_density()) {
    const ModelMode mode = find_mode(posterior, call.inputs.command().seed);
    return {.mean = mode.q, .covariance = mode.covariance, .points = {}};
  }
  const auto in = posterior_inputs_without_start(call.inputs);
  const DirectStart start = find_direct_start(*in);
  const Eigen::VectorXd q = posterior.q(start.theta);
  Eigen::VectorXd by_coordinate(q.size());  // dq over the change of a parameter's coordinate
  const Eigen::VectorXd scale = posterior.scale(q);
  for (Eigen::Index k = 0; k < q.size(); ++k) by_coordinate[k] = (in->parameters[std::size_t(k)].logarithmic() ? start.theta[std::size_t(k)] : 1.0) / scale[k];
  return {.mean = q, .covariance = by_coordinate.asDiagonal() * start.covariance * by_coordinate.asDiagonal(), .points = {}};
}

std::optional<ErrorModel> errors_of(StudyInputs& inputs) {
  const auto& study = inputs.study();
  if (study.external->is_log_density()) return std::nullopt;
  const Problem& problem = inputs.problem();
  return ErrorModel(problem, inputs.recordings(), *study.recordings, study.errors, {.energy_slope = {}, .gauge_places = {}, .last_difference = {}, .mesh = study.errors.mesh.value_or(0)}, {});
}

}  // namespace

ExitStatus sample_model_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& study = inputs.study();
  const auto& notes = inputs.notes();
  auto errors = errors_of(inputs);
  const auto provenance = posterior_provenance(inputs);
  if (!call.finished.due(provenance, {"posterior.json", "posterior.nc"}, Asked::by_user)) {
    notes.say(reused_line("sample"));
    return read_json(inputs.artefact("posterior.json")).value("status", "") == "done" ? ExitStatus::done : ExitStatus::not_to_be_trusted;
  }
  const auto& model = inputs.external();
  const auto& parameters = model.shape().parameters;
  const auto grid = errors ? std::optional(errors->grid()) : std::nullopt;
  const Eigen::VectorXd error_variance = errors ? Eigen::VectorXd(errors->covariance().diagonal()) : Eigen::VectorXd();
  const ModelPosterior posterior(model, std::move(errors));
  const auto start = start_of(call, posterior);
  const Clock clock;
  (void)posterior.log_density(start.mean);
  const auto& s = study.sampler;
  const double wait = clock.seconds() * double(s.chains) * (double(s.warmup) + double(s.draws) * s.thin) / std::min(s.chains, command.threads);
  if (wait > long_wait)
    notes.warn({fmt::format("the chains will take about {:.0f} minutes by the model itself; add a [surrogate] table to sample on an emulator, or ask for fewer sampler.draws", wait / 60)});

  const ModelDensity density(posterior);
  const auto progress = stage_progress("sample", command.quiet);
  const auto journal = inputs.artefact("posterior.journal");
  const SamplerRun run{.seed = command.seed, .threads = command.threads, .journal = journal, .provenance = provenance,
                       .progress = [&](std::size_t done, std::size_t all) { progress("transitions", done, all); }, .stop = &stop_requested()};
  const auto result = run_sampler(density, start, s, run);
  const Convergence convergence = assessed(result, s.thin);
  const auto alarms = absorption(parameters, convergence);

  auto groups = posterior_groups(density, result);
  if (posterior.is_log_density())
    groups.push_back(prior_group(parameters, posterior.priors(), command.seed));
  else
    for (auto& g : predictive_groups({.parameters = parameters, .priors = posterior.priors(), .log_likelihood = {},
                                      .history = [&](const Eigen::VectorXd& q) {
                                        auto y = posterior.history(posterior.theta(q));
                                        y.resize(model.shape().values(), std::numeric_limits<double>::quiet_NaN());
                                        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(y.data(), Eigen::Index(y.size())));
                                      },
                                      .error_variance = error_variance,
                                      .grid = grid ? &*grid : nullptr},
                                     inputs.problem(), result, command.seed))
      groups.push_back(std::move(g));
  Json json = posterior_json(convergence, s.kind, result, provenance);
  json["status"] = convergence.converged ? "done" : "not_to_be_trusted";
  json["final"] = convergence.converged, json["chains_converged"] = convergence.converged;
  json["true_model_check"] = {{"needed", false}, {"holds", true}, {"sentence", "every draw is by the model itself"}};
  json["absorption"] = alarms, json["warnings"] = Json::array();
  json["model"] = {{"evaluations", result.summary.evaluations}, {"without_an_answer", posterior.failed()}};
  write_posterior(inputs.artefact("posterior.nc"), groups, provenance);
  write_json(inputs.artefact("posterior.json"), json);
  remove_journal(journal);
  notes.say(draws_lines(convergence));
  if (posterior.failed() > 0) notes.warn({fmt::format("the model gave no answer {} times; its density counts as zero there", posterior.failed())});
  notes.warn(alarms);
  notes.say(stage_line("sample", convergence.message));
  return convergence.converged ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

}  // namespace calomel
