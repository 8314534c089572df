#include "apps/pipeline/sample_model_stage.hpp"

#include <fmt/format.h>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/predictive_groups.hpp"
#include "apps/pipeline/sample_artefacts.hpp"
#include "apps/pipeline/sample_parts.hpp"
#include "apps/presentation/convergence_words.hpp"
#include "apps/presentation/data_check_words.hpp"
#include "apps/presentation/fit_words.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "base/not_finite.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/design.hpp"
#include "inverse/posterior/multistart_least_squares.hpp"
#include "inverse/posterior/goodness_of_fit.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"
#include "uq/data_checks.hpp"
#include "uq/model_density.hpp"
#include "uq/sampler/modes.hpp"

namespace calomel {

namespace {

constexpr double long_wait = 600;                              ///< [s]; a longer wait is announced before the chains begin
constexpr double search_share = 0.01;                          ///< of the chains' evaluations, for the search of modes
constexpr std::size_t fewest_points = 64, most_points = 1024;  ///< of its design
constexpr double edge = 0.02;                                  ///< share of the bounds' distance at either end that the design leaves out

/// The density, which is zero everywhere once the user requested a stop: so that a search ends.
class UntilStopped final : public LogDensity {
 public:
  explicit UntilStopped(const LogDensity& density) : density_(density) {}
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return density_.coordinates(); }
  [[nodiscard]] double log_density(std::span<const double> x) const override { return stop_requested() ? never : density_.log_density(x); }
  [[nodiscard]] bool has_gradient() const override { return density_.has_gradient(); }
  double log_density_and_gradient(std::span<const double> x, std::span<double> gradient) const override {
    if (!stop_requested()) return density_.log_density_and_gradient(x, gradient);
    std::fill(gradient.begin(), gradient.end(), 0.0);
    return never;
  }

 private:
  const LogDensity& density_;
};

/// All modes from a design over the bounds, the nominal values, and, of records, the ends of least squares by the model itself.
std::vector<LaplaceMode> modes_of(StageCall& call, const ModelPosterior& posterior, const LogDensity& density) {
  const auto& command = call.inputs.command();
  const Eigen::Index d = posterior.dimension();
  const double wanted = search_share * usual_evaluations(call.inputs.study().sampler, std::size_t(d));
  const Eigen::ArrayXXd unit = space_filling_points(std::size_t(d), std::clamp(std::size_t(wanted), fewest_points, most_points), command.seed);
  const Eigen::ArrayXXd place = edge + (1 - 2 * edge) * unit;
  std::vector<std::vector<double>> starts;
  if (posterior.is_log_density()) {
    starts.push_back(nominal(call.inputs.simulator().shape()));
  } else {
    PosteriorCase posterior_case = call.inputs.posterior_case();
    posterior_case.first_box = false;
    starts = multistart_least_squares(*set_up_posterior(posterior_case)).ends;
  }
  Eigen::MatrixXd q(d, Eigen::Index(starts.size()));
  for (std::size_t i = 0; i < starts.size(); ++i) q.col(Eigen::Index(i)) = posterior.q(starts[i]);
  try {
    auto modes = density_modes(UntilStopped(density), (place / (1 - place)).log().matrix(), q, command.threads);
    if (stop_requested()) throw Interrupted();
    return modes;
  } catch (const NumericsError&) {
    if (stop_requested()) throw Interrupted();
    throw;
  }
}

std::optional<ErrorModel> errors_of(StudyInputs& inputs) {
  const auto& study = inputs.study();
  if (study.capabilities().log_density) return std::nullopt;
  if (study.physical())
    throw study.file.located(InputError({.problem = "an external model that is sampled by itself has no discrepancy to be marginalised",
                                         .key = "map.product",
                                         .value = "\"physical\"",
                                         .suggestion = "add a [surrogate] table, by which it is sampled on an emulator, or set product = \"tuned\""}));
  const Problem& problem = inputs.problem();
  return ErrorModel(problem, inputs.recordings(), *study.recordings, study.errors,
                    {.energy_slope = {}, .gauge_places = {}, .last_difference = {}, .mesh = study.errors.mesh.value_or(0)});
}

/// Information of the records on the model at a mode: for posterior.json, and as warnings.
struct Judged {
  Json fit;
  std::vector<std::string> warnings;
};

Judged judge(const Problem& problem, const ErrorOptions& options, const ModelPosterior& posterior, const Eigen::VectorXd& mode) {
  const ErrorModel& errors = *posterior.errors();
  const Eigen::VectorXd prediction = errors.grid().apply(posterior.prediction(mode));
  if (!prediction.allFinite())
    return {.fit = Json::object(), .warnings = {"the model returned no result at its mode, so whether it contradicts the records is unknown"}};
  const FitResidual left = residual_of(errors, prediction, std::size_t(posterior.dimension()));
  const GoodnessOfFit goodness = goodness_of_fit(left);
  Judged out{.fit = {{"mode",
                      {{"theta", named(posterior.parameters(), posterior.theta(mode))},
                       {"chi2", number(goodness.chi2)},
                       {"values", goodness.values},
                       {"covariance_shares", shares_json(errors)},
                       {"pulls", prior_deviations_json(left)}}},
                     {"adequate", goodness.adequate},
                     {"adequacy", goodness_sentence(goodness)}},
             .warnings = data_check_sentences(check_data(problem, errors, prediction, left), options)};
  if (!goodness.adequate) out.warnings.push_back(goodness_sentence(goodness));
  return out;
}

}  // namespace

ExitStatus sample_model_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& study = inputs.study();
  const auto& notes = inputs.notes();
  auto errors = errors_of(inputs);  // before any long work, so that wrong recordings are reported at once
  const auto provenance = posterior_provenance(inputs);
  if (const auto status = finished_sample(call, provenance)) return *status;
  const SimulatedModel model(inputs.runs(), false);
  const auto& parameters = model.shape().parameters;
  const ModelPosterior posterior(model, std::move(errors));
  const ModelDensity density(posterior);
  const Clock clock;
  (void)posterior.log_density(posterior.q(nominal(model.shape())));
  const auto& s = study.sampler;
  const double calls = usual_evaluations(s, std::size_t(posterior.dimension()));
  const double wait = clock.seconds() * calls / std::min(s.chains, command.threads);
  if (wait > long_wait)
    notes.warn(
        {fmt::format("the chains will take about {:.0f} minutes by the model itself, {:.2g} calls of it; add a [surrogate] table to sample on an emulator, or "
                     "reduce sampler.draws",
                     wait / 60, calls)});
  const auto modes = modes_of(call, posterior, density);
  const SamplerStart start = start_at_modes(modes);

  if (modes.size() > 1) notes.say(stage_line("sample", modes_sentence(density, modes)));
  const auto progress = stage_progress("sample", command.quiet);
  const auto result = run_sampler(density, start, s, saved_run(call, provenance, progress));
  const Convergence convergence = assessed(result, s.thin);
  const auto alarms = absorption(parameters, convergence);

  auto groups = posterior_groups(parameters, result);
  if (posterior.is_log_density())
    groups.push_back(prior_group(parameters, posterior.priors(), command.seed));
  else
    for (auto& g : predictive_groups({.parameters = parameters,
                   .priors = posterior.priors(),
                   .log_prior = [&](const Eigen::VectorXd& q) { return posterior.log_prior(q); },
                   .history = [&](const Eigen::VectorXd& q) { return posterior.prediction(q); },
                   .error_variance = posterior.errors()->covariance().diagonal(),
                   .grid = &posterior.errors()->grid()},
                                     inputs.problem(), result, command.seed))
      groups.push_back(std::move(g));
  Json json = posterior_json(convergence, convergence_sentence(convergence), result, provenance);
  json["status"] = convergence.converged ? "done" : "not_to_be_trusted";
  std::vector<std::string> warnings;
  if (!posterior.is_log_density()) {
    const Judged judged = judge(inputs.problem(), study.errors, posterior, modes[0].x);
    json.update(judged.fit);
    warnings = judged.warnings;
  }
  json["final"] = convergence.converged && warnings.empty() && alarms.empty();
  json["chains_converged"] = convergence.converged;
  json["true_model_check"] = {{"needed", false}, {"holds", true}, {"sentence", "every draw is by the model itself"}};
  json["absorption"] = alarms;
  json["warnings"] = warnings;
  json["modes"] = modes_json(density, modes);
  json["model"] = {{"evaluations", result.summary.evaluations}, {"without_an_answer", posterior.failed()}};
  write_sample(call, groups, json, provenance);
  notes.say(draws_lines(convergence));
  if (posterior.failed() > 0) notes.warn({fmt::format("the model returned no result {} times; the density counts as zero there", posterior.failed())});
  notes.warn(alarms);
  notes.warn(warnings);
  notes.say(stage_line("sample", convergence_sentence(convergence)));
  return convergence.converged ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

}  // namespace calomel
