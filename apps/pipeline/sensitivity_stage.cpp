#include "apps/pipeline/sensitivity_stage.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/train_stage.hpp"
#include "apps/presentation/run_lines.hpp"
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

/// What is evaluated, and that it answers where runs failed too.
std::string surrogate_sentence(const KnownRuns& runs) {
  const Eigen::Index all = runs.means.cols();
  Eigen::Index failed = 0;
  for (Eigen::Index i = 0; i < all; ++i) failed += !runs.means.col(i).allFinite();
  std::string s = "Sobol' indices and elementary effects are those of the surrogate, the polynomial is fitted to the campaign's runs of the model";
  if (failed > 0) s += fmt::format("; {} of its {} runs failed, and the surrogate still predicts there", failed, all);
  return s;
}

/// What the shares of a total are and how far to believe them.
std::string total_line(const QuantitySensitivity& q, const std::vector<Parameter>& parameters) {
  std::string line = fmt::format("sensitivity: {}{}:", q.name, q.condition.empty() ? "" : " of " + q.condition);
  if (!q.source.empty()) {
    line += fmt::format(" {:.3g} {} with sd {:.2g};", q.mean, q.unit, q.sd);
    for (std::size_t k = 0; k < parameters.size(); ++k)
      line += fmt::format("{} {} {:.3g} alone, {:.3g} with the others", k ? "," : "", parameters[k].name, q.sobol.first_order[k].value,
                          q.sobol.total_order[k].value);
    line += fmt::format("; by {}, left-out R2 {:.3f}", q.source, q.left_out_r2);
  }
  return line + (q.note.empty() ? "" : (q.source.empty() ? " " : "; ") + q.note);
}

std::vector<std::string> lines_of(const Sensitivity& s, const std::vector<Parameter>& parameters) {
  const auto& whole = s.quantities.back();
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto &f = whole.sobol.first_order[k], &t = whole.sobol.total_order[k];
    lines.push_back(fmt::format("sensitivity: {}: {:.3g} of the variance of all records alone ({:.3g} to {:.3g}), {:.3g} with the others ({:.3g} to {:.3g})",
                                parameters[k].name, f.value, f.low, f.high, t.value, t.low, t.high));
  }
  for (const auto& q : s.quantities)
    if (std::any_of(std::begin(run_totals), std::end(run_totals), [&](const auto& t) { return q.name == t.name; })) lines.push_back(total_line(q, parameters));
  if (!s.doubt.empty()) lines.push_back("sensitivity: not to be trusted: " + s.doubt);
  lines.push_back(
      fmt::format("sensitivity: {} evaluations, {} failed; every gauge and time in sensitivity.nc, a table in sensitivity.csv", s.evaluations, s.failed));
  return lines;
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
  Sensitivity s = analyse_sensitivity(in);
  if (!by_surrogate && inputs.runs().store().lost() > 0)
    inputs.notes().warn({fmt::format("{} evaluations got no response: --fresh requests them again", inputs.runs().store().lost())});
  if (s.doubt.empty() && upstream != ExitStatus::done)
    s.doubt = "the campaign or the surrogate is not to be trusted: campaign.json and train.json give the reason";
  const std::string source = by_surrogate ? surrogate_sentence(*in.runs) : "all by the model itself";
  write_sensitivity(inputs.artefact("sensitivity.nc"), s, model.shape(), in.totals ? &*in.totals : nullptr, provenance);
  write_atomically(inputs.artefact("sensitivity.csv"), sensitivity_csv(s, parameters));
  write_json(inputs.artefact("sensitivity.json"), sensitivity_json(s, in, source, provenance));
  inputs.notes().say(lines_of(s, parameters));
  return s.doubt.empty() ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

}  // namespace calomel
