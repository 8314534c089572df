#include "apps/pipeline/sensitivity_stage.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/train_stage.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/presentation/sensitivity_words.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "base/artefact.hpp"
#include "base/not_finite.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/surrogate.hpp"
#include "forward/campaign/total_runs.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

/// Points of the unit cube as parameters: evenly between the bounds, or by the priors there.
std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> parameters_at(const std::vector<Parameter>& parameters, bool by_prior) {
  const auto priors = priors_of(parameters);
  std::vector<std::pair<double, double>> range;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    range.emplace_back(by_prior ? priors[k].probability_below(parameters[k].min) : parameters[k].min,
                       by_prior ? priors[k].probability_below(parameters[k].max) : parameters[k].max);
  return [=](const Eigen::MatrixXd& unit) {
    Eigen::MatrixXd out = unit;
    for (Eigen::Index k = 0; k < unit.rows(); ++k) {
      const auto& p = parameters[std::size_t(k)];
      const auto [low, high] = range[std::size_t(k)];
      for (Eigen::Index i = 0; i < unit.cols(); ++i) {
        const double x = low + (high - low) * unit(k, i);
        out(k, i) = std::clamp(by_prior ? priors[std::size_t(k)].quantile(std::clamp(x, 1e-12, 1 - 1e-12)) : x, p.min, p.max);
      }
    }
    return out;
  };
}

/// Dissipated energy and time at cutoff at the campaign's points.
TotalsOfRuns totals_of(StudyInputs& inputs, const Eigen::MatrixXd& thetas) {
  const auto& command = inputs.command();
  const ModelShape& shape = inputs.simulator().shape();
  const auto progress = stage_progress("runs with an energy balance", command.quiet);
  TotalsOfRuns out{.which = {}, .thetas = thetas, .values = {}};
  for (const auto& c : shape.conditions)
    for (const auto& t : run_totals) out.which.push_back({t.name, shape.conditions.size() > 1 ? c : "", t.unit});
  out.values = totals_at(inputs.runs(), thetas, [&](std::size_t done, std::size_t all) { progress("runs", done, all); });
  return out;
}

}  // namespace

ExitStatus sensitivity_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& study = inputs.study();
  const auto& command = inputs.command();
  const bool by_surrogate = !study.runs_the_model_itself();
  const ExitStatus upstream = by_surrogate ? train_stage(call, Requested::upstream) : ExitStatus::done;
  const auto provenance = sensitivity_provenance(inputs, by_surrogate);
  if (!call.finished.due(provenance, {"sensitivity.json", "sensitivity.nc", "sensitivity.csv"}, Requested::by_user)) {
    inputs.notes().say(reused_line("sensitivity"));
    return read_json(inputs.artefact("sensitivity.json")).value("status", "done") == "done" ? upstream : ExitStatus::not_to_be_trusted;
  }
  std::unique_ptr<Surrogate> surrogate;
  std::optional<KnownRuns> runs;
  std::optional<TotalsOfRuns> totals;
  if (by_surrogate) {
    surrogate = load_surrogate(inputs.artefact("surrogate.nc"));
    const Archive archive = read_archive(inputs.artefact("campaign.nc"));
    runs = KnownRuns{.thetas = archive.theta, .means = archive.mean.cast<double>()};
    if (study.sensitivity.run_totals) totals = totals_of(inputs, archive.theta);
  }
  std::optional<SimulatedModel> kept;
  if (!by_surrogate) kept.emplace(inputs.runs());
  const ForwardModel& model = surrogate ? static_cast<const ForwardModel&>(*surrogate) : *kept;
  const auto& parameters = study.parameters();
  const auto progress = stage_progress("sensitivity", command.quiet);
  const SensitivityInputs in{.model = model,
                             .options = study.sensitivity,
                             .seed = command.seed,
                             .threads = command.threads,
                             .theta = parameters_at(parameters, study.sensitivity.measure == "prior"),
                             .runs = std::move(runs),
                             .totals = std::move(totals),
                             .progress = [&](std::size_t done, std::size_t all) { progress("evaluations", done, all); },
                             .stop = &stop_requested()};
  const Sensitivity s = analyse_sensitivity(in);
  const SensitivityWords words = sensitivity_words(s, parameters.size(), in.runs ? &*in.runs : nullptr, upstream == ExitStatus::done);
  if (!by_surrogate && inputs.runs().store().lost() > 0)
    inputs.notes().warn({fmt::format("{} evaluations got no response: --fresh requests them again", inputs.runs().store().lost())});
  write_sensitivity(inputs.artefact("sensitivity.nc"), s, model.shape(), in.totals ? &*in.totals : nullptr, provenance);
  write_atomically(inputs.artefact("sensitivity.csv"), sensitivity_csv(s, parameters));
  write_json(inputs.artefact("sensitivity.json"), sensitivity_json(s, in, words, provenance));
  inputs.notes().say(sensitivity_lines(s, words, parameters));
  return words.doubt.empty() ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

}  // namespace calomel
