#include "uq/diagnosis/linearised_fit.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "uq/diagnosis/candidate_fit.hpp"
#include "uq/diagnosis/fit_measures.hpp"
#include "uq/diagnosis/hold_out_predictions.hpp"
#include "uq/diagnosis/linearised_effect.hpp"
#include "uq/diagnosis/reported_moments.hpp"

namespace calomel {

namespace {

/// The parts of the linear fit of a group, for all its rounds.
struct LinearFit {
  const FitContext& context;
  const ParameterGroup& group;
  const Alternative* on_top_of;
  const PosteriorFit& below;  ///< the fit that the group is added to
  LinearisedEffect effect;
};

/// The hypotheses of the fit below about the records less `rest`, and the same with the group's numbers as one more term.
struct LinearErrors {
  std::vector<WeightedErrors> without, with;
};

LinearErrors errors_of(const PosteriorFit& below, const ErrorTerm& term, const Eigen::VectorXd& rest) {
  LinearErrors errors;
  for (const auto& h : below.hypotheses) {
    errors.without.push_back({h.errors.less(rest), h.log_weight, h.discrepancy});
    errors.with.push_back({errors.without.back().errors.with(term), h.log_weight, h.discrepancy});
  }
  return errors;
}

/// Numbers of the alternative below, as those of every pair: without the name of its gauge.
std::vector<Estimate> numbers_of_pair(const Alternative& below) {
  std::vector<Estimate> numbers = below.numbers;
  for (auto& n : numbers)
    if (const std::string& gauge = below.sensor; !gauge.empty() && n.name.starts_with(gauge + '.')) n.name.erase(0, gauge.size() + 1);
  return numbers;
}

/// Adds the group's own numbers and what follows from them, given the mode with them. The numbers are what is left of the residual at this mode in their
/// directions with fixed parameters, because the mode already has the freedom of the numbers.
void add_numbers(LinearFit& fit, Alternative& a, const LinearErrors& errors, const LogPosterior& with, const LocalMode& m) {
  const ScreenedCandidate& candidate = fit.effect.candidate;
  const AddedDirections& directions = candidate.directions;
  const LogPosterior unmoved = fit.below.under(errors.without);
  FirstOrderEstimate estimate = FirstOrderModel(unmoved, m).estimate(directions);
  estimate.value = numbers_beside(unmoved, m.at, directions, with.likeliest(m.at));
  if (fit.on_top_of) a.explanation.farthest = fit.on_top_of->explanation.farthest;
  for (std::size_t i = 0; i < candidate.numbers.size(); ++i) {
    const auto k = Eigen::Index(i);
    const AddedParameter& number = fit.group.added[candidate.numbers[i]];
    const double value = *number.parameter.nominal + estimate.value[k];
    const std::string name = (a.sensor.empty() ? "" : a.sensor + '.') + number.parameter.name;
    a.numbers.push_back({name, value, tempered_sd(estimate.sd[k], directions.prior_sd[k])});
    a.explanation.farthest = std::max(a.explanation.farthest, implausibility(number, value, a.numbers.back().sd));
  }
  a.history = kept(fit.below.history(m.at.u, m.at.beyond) + fit.effect.rest + candidate.effects * estimate.value);
  a.explanation.misfit = misfit_of_history(fit.context.base.fit, values_of(a.history));
  fit.effect.set_estimate(estimate, m.at.theta);
}

/// One round: the group's part of the records is rest + effects . numbers. Leaves the estimate in `fit.effect`; nothing where no mode is found.
std::optional<Alternative> one_round(LinearFit& fit) {
  const DiagnosisInputs& in = fit.context.in;
  const BaseFit& base = fit.context.base;
  const Alternative* on_top_of = fit.on_top_of;
  const ScreenedCandidate& candidate = fit.effect.candidate;
  const LocalMode& start = fit.below.modes[0];
  Alternative a = unfitted_alternative(fit.group, candidate, on_top_of);
  double gained = 0;  // by what it is added to
  if (on_top_of) {
    a.numbers = numbers_of_pair(*on_top_of);
    gained = on_top_of->explanation.log_bayes_factor - on_top_of->selection_penalty;
  } else {
    a.sensor = candidate.sensor ? in.base.problem.shape.sensors[*candidate.sensor] : fit.group.sensor;
    a.explanation.of_a_gauge = !a.sensor.empty();
  }
  const Eigen::MatrixXd d = candidate.directions.by_number * candidate.directions.prior_sd.asDiagonal();
  const ErrorTerm term{fit.group.name, d * d.transpose()};
  const Eigen::VectorXd rest = base.grid().apply(fit.effect.rest);
  LinearErrors errors = errors_of(fit.below, term, rest);
  const LogPosterior with = fit.below.under(errors.with);
  const auto modes = find_modes(with, {with.q(start.at.theta, start.at.beyond)});
  if (modes.empty()) return {};
  const LocalMode& m = modes[0];
  Explanation& e = a.explanation;
  e.fitted = true;
  e.log_bayes_factor = gained + log_evidence(with, m) - log_evidence(*fit.below.posterior, start) + a.selection_penalty;
  e.by_scale = evidence_by_scale(with, m, errors.with, e.log_bayes_factor);
  const ErrorModel with_term = fit.below.errors->less(rest).with(term);
  e.chi2 = plain_chi2(plain_errors(fit.below, with, m, with_term), with_term, fit.below, m);
  e.base_prior_deviation = root_mean_square(prior_deviations(in, m.at.theta));
  a.base_parameters = own_parameters(in, with, tempered_moments(with, m, in.base.seed));
  a.settled = on_top_of ? on_top_of->settled : base.fit.settled;  // it uses that emulator
  add_numbers(fit, a, errors, with, m);
  fit.effect.without = std::move(errors.without);
  fit.effect.with = std::move(errors.with);
  return a;
}

/// Linearises the effect about the estimate, by runs of the coarser mesh. False where a run failed.
bool linearise_again(LinearFit& fit) {
  const DiagnosisInputs& in = fit.context.in;
  std::vector<AddedParameter> added;
  if (fit.on_top_of) added = fit.context.library.fits.at(fit.on_top_of->explanation.name).added;
  added.insert(added.end(), fit.group.added.begin(), fit.group.added.end());
  const Eigen::MatrixXd thetas = fit.effect.points(fit.group);
  const auto records = fit.context.budget.run(thetas, std::vector<int>(std::size_t(thetas.cols()), in.coarser_level()), added);
  if (std::any_of(records.begin(), records.end(), [](const auto& r) { return !r.done; })) return false;
  fit.effect.update(thetas, records, fit.context.base.grid());
  return true;
}

/// Repeats the fit about its estimate while it may lead, until the estimate remains.
void follow_estimate(LinearFit& fit, Alternative& a, double best, int rounds) {
  RunBudget& budget = fit.context.budget;
  const int more = int(fit.effect.candidate.numbers.size()) + 2;
  for (int round = 0; may_lead(a.explanation.log_bayes_factor, best); ++round) {
    a.settled = a.settled && fit.effect.converged;
    if (fit.effect.converged || round == rounds) return;
    if (!budget.allows(more)) {
      budget.note_exhausted();
      budget.skip({.kind = SkippedStep::Kind::relinearisation, .name = a.explanation.name, .runs = more, .made = budget.made(), .limit = budget.limit()});
      return;
    }
    if (!linearise_again(fit)) {
      a.status = {.kind = FitStatus::Kind::linearised_run_failed};
      return;
    }
    if (auto next = one_round(fit)) a = std::move(*next);
  }
}

/// Adds the prediction of held-out gauges and of the beginning of the records, which many small numbers are judged by.
void add_hold_out_prediction(const LinearFit& fit, Alternative& a) {
  const HeldOut& held_out = fit.context.held_out;
  const LinearBeside beside{.fit = fit.below,
                            .without = fit.effect.without,
                            .with = fit.effect.with,
                            .directions = fit.effect.candidate.directions,
                            .effects = fit.effect.candidate.effects,
                            .rest = fit.effect.rest};
  HoldOutPrediction& prediction = a.explanation.hold_out_prediction.emplace();
  prediction.misfit_before = fit.on_top_of ? fit.on_top_of->explanation.misfit : fit.context.base.evidence.misfit;
  std::tie(prediction.beginning_before, prediction.beginning) = held_out.beginning(beside);
  if (!held_out.possible()) return;
  prediction.gauges_before = held_out.misfit_by(fit.below);
  keep_held_out_fit(held_out, held_out.by(beside), a);
}

}  // namespace

std::optional<Alternative> fit_linearised(const FitContext& context, const ParameterGroup& group, const ScreenedCandidate& screened,
                                          const Alternative* on_top_of, double best, int rounds) {
  LinearFit fit{.context = context, .group = group, .on_top_of = on_top_of, .below = context.fit_below(on_top_of), .effect = {}};
  fit.effect.candidate = screened;
  fit.effect.rest = Eigen::VectorXd::Zero(screened.effects.rows());
  std::optional<Alternative> a = one_round(fit);
  if (!a) return {};
  const int before = context.budget.made();
  if (rounds > 0 && !screened.sensor) follow_estimate(fit, *a, best, rounds);
  if (group.linear) add_hold_out_prediction(fit, *a);
  a->runs = context.budget.made() - before;
  if (!a->settled && a->runs > 0 && a->status.kind == FitStatus::Kind::unremarkable)
    a->status.kind = fit.effect.converged ? FitStatus::Kind::on_unsettled_fit : FitStatus::Kind::numbers_moved;
  if (a->runs > 0 || on_top_of) report_fitted(context, *a);
  return a;
}

}  // namespace calomel
