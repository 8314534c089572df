#include "uq/diagnosis/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/log_sum.hpp"
#include "inverse/posterior/direct_start.hpp"
#include "uq/diagnosis/engine.hpp"
#include "uq/diagnosis/plain_words.hpp"

namespace calomel {

namespace {

constexpr double alike = 4;  ///< distance in standard deviations below which two explanations are one class

}  // namespace

Diagnosis DiagnosisEngine::run() {
  say("base fit");
  PosteriorInputs base = in_.base;
  base.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return counted(thetas, level, {}); };
  base.go_on = [this](const PosteriorFit& f) { return !surely_mixed_up(in_.base.problem, f); };  // such records lead a fit astray
  out_.base = fit_posterior(base);
  if (base.least_squares) out_.base = held_to_the_model(base, std::move(out_.base));
  if (base.gauge_places) places_ = base.gauge_places(mode().at.theta);
  describe_base();
  hold_out_base();
  if (out_.mixed_up.empty())
    explain();
  else
    out_.verdict = {.kind = VerdictKind::unknown,
                    .mechanisms = {},
                    .ranking = judge(out_.evidence, {}).ranking,
                    .reason = "gauges look mixed up, and nothing was asked of mechanisms"};
  hold_out_verdict();
  locate_all();
  describe_missing();
  out_.separating = separating_measurement(out_, in_.base.problem);
  out_.runs = runs_;
  return std::move(out_);
}

/// Everything about mechanisms.
void DiagnosisEngine::explain() {
  ask_all();
  ask_clock();
  fit_terms();
  fit_leaders();
  follow_terms();
  judge_all();
  if (in_.options.pairs) fit_pair();
}

Estimate DiagnosisEngine::told(const AddedParameter& a, double mean, double sd, const std::vector<Estimate>& own) const {
  if (a.share_of.empty()) return {a.parameter.name, mean, sd};
  Estimate whole{.name = {}, .mean = a.whole};
  for (std::size_t k = 0; k < own_; ++k)
    if (in_.base.parameters[k].key == a.share_of)
      for (const auto& e : own)
        if (e.name == in_.base.parameters[k].name) whole = e;
  // What a share does set in at once: where the records do not halve its prior's deviation, what they seem to say of it is the form of the law.
  const double range = a.parameter.max - a.parameter.min, of_prior = range / std::sqrt(12);
  const bool narrowed = sd < 0.5 * of_prior;
  if (!narrowed) mean = a.parameter.min + 0.5 * range, sd = of_prior;
  return {a.parameter.name, mean * whole.mean, std::hypot(sd * whole.mean, mean * whole.sd), narrowed};
}

void DiagnosisEngine::describe_base() {
  const LocalMode& m = mode();
  const LogPosterior& posterior = *out_.base.posterior;
  out_.base_parameters = own_parameters(posterior, parameters_of(out_.base, in_.base.seed));
  out_.handbook_pulls = pulls(m.at.theta);
  out_.base_history = kept(out_.base.history_at_mode());
  BaseEvidence& e = out_.evidence;
  e.values = double(grid().size());
  e.chi2 = chi2(plain_errors(out_.base, posterior, m, *out_.base.errors), *out_.base.errors, out_.base, m);
  e.base_pull = root_mean_square(out_.handbook_pulls);
  e.misfit = misfit(values(out_.base_history));
  e.by_scale = evidence_by_scale(posterior, m, out_.base.hypotheses);
  describe_places();
  out_.dead = in_.base.problem.dead;
  out_.mixed_up = mixed_up(in_.base.problem, out_.base);
  if (!out_.mixed_up.empty()) skip("what each mechanism would be worth, and everything after it: gauges look mixed up");
  for (const auto& slip : out_.mixed_up) say(plain_mixed_up(slip));
}

/// What the base model is worth where something is missing in one place alone: the mean over all places. Of those, the likeliest.
void DiagnosisEngine::describe_places() {
  const auto places = places_of_discrepancy(in_.base.problem, in_.base.places.positions);
  if (!(in_.base.errors.discrepancy > 0) || places.empty()) return;
  const double whole = log_evidence(*out_.base.posterior, mode());
  std::vector<double> worth;
  for (const auto& place : places) {
    const LogPosterior local = out_.base.under(with_local_discrepancy(*out_.base.errors, in_.base.problem, in_.base.errors, in_.base.places.positions, place));
    const auto modes = find_modes(local, {local.q(mode().at.theta, mode().at.beyond)});
    worth.push_back(modes.empty() ? -std::numeric_limits<double>::infinity() : log_evidence(local, modes[0]) - whole);
    if (worth.back() < *std::max_element(worth.begin(), worth.end())) continue;
    out_.likeliest_place.clear();
    for (const std::size_t s : place) out_.likeliest_place.push_back(in_.base.problem.shape.sensors[s]);
  }
  out_.evidence.local = log_mean(worth);
  say(fmt::format("something in one place alone: log evidence {:.3g}", *out_.evidence.local));
}

/// Questions about a fit with these numbers added.
QuestionInputs DiagnosisEngine::about(const PosteriorFit& fit, std::vector<AddedParameter> added, const std::vector<ParameterGroup>& groups) {
  return {.fit = fit,
          .problem = in_.base.problem,
          .groups = groups,
          .level = in_.base.levels > 1 ? 1 : 0,
          .run = [this, added](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> further) {
            std::vector<AddedParameter> all = added;
            all.insert(all.end(), further.begin(), further.end());
            return counted(thetas, level, all);
          }};
}

void DiagnosisEngine::ask_all() {
  say("what each mechanism would be worth, to first order");
  Answers answers = ask(about(out_.base, {}, in_.groups));
  asked_ = std::move(answers.questions);
  out_.skipped.insert(out_.skipped.end(), answers.skipped.begin(), answers.skipped.end());
  for (const auto& q : asked_)
    if (q.worth.log_bayes_factor > worth_fitting)
      say(fmt::format("{}: log Bayes factor {:.3g} to first order, p {:.2g}", label(q, in_.groups, in_.base.problem.shape), q.worth.log_bayes_factor,
                      q.p_value));
}

/// Whether all records are late together, which no mechanism is: the beam's profile, as a longer pulse, would come nearest.
void DiagnosisEngine::ask_clock() {
  const auto late = late_records(in_.base.problem, out_.base);
  if (!late || (!asked_.empty() && late->log_bayes_factor < asked_[0].worth.log_bayes_factor + Gates{}.lead)) return;
  out_.late = late;
  say(plain_late(*out_.late));
}

void DiagnosisEngine::judge_all() {
  std::stable_sort(out_.candidates.begin(), out_.candidates.end(),
                   [](const auto& a, const auto& b) { return a.explanation.log_bayes_factor > b.explanation.log_bayes_factor; });
  // Explanations whose predictions no record tells apart, once scaled to each other.
  const Cholesky errors(out_.base.errors->covariance());
  const auto effect = [&](const Alternative& c) { return errors.solve_lower(Eigen::VectorXd(grid().apply(values(c.history) - values(out_.base_history)))); };
  for (auto& a : out_.candidates) {
    a.explanation.same_as.clear();
    if (a.history.empty()) continue;
    const Eigen::VectorXd fa = effect(a);
    for (const auto& b : out_.candidates) {
      if (&a == &b || b.history.empty()) continue;
      const Eigen::VectorXd fb = effect(b);
      if (fa.norm() > alike && fb.norm() > alike && (fa - fb).norm() < alike) a.explanation.same_as.push_back(b.explanation.name);
    }
  }
  std::vector<Explanation> all;
  for (auto& c : out_.candidates) hold_out(c), all.push_back(c.explanation);
  out_.verdict = judge(out_.evidence, all);
}

void DiagnosisEngine::hold_out_base() {
  held_out_.emplace(in_.base.problem, out_.base, in_.base.places);
  out_.held_out_history = held_out_->base().history;
  out_.held_out_before = out_.held_out_after = out_.evidence.held_out = held_out_->mean(held_out_->base().misfit);
}

void DiagnosisEngine::hold_out(Alternative& c) {
  const auto fit = fits_.find(c.explanation.name);
  if (!held_out_->possible() || fit == fits_.end() || c.explanation.log_bayes_factor <= 0 || !c.held_out.empty()) return;
  if (c.explanation.of_a_gauge && !in_.base.least_squares) return;  // of the many gauges of a target one hardly moves what the others are predicted by
  keep(held_out_->by(fit->second.fit), c);
}

void DiagnosisEngine::keep(HeldOutFit with, Alternative& c) {
  for (std::size_t i = 0; i < with.misfit.size(); ++i) c.held_out.push_back(held_out_->base().misfit[i]), c.held_out.push_back(with.misfit[i]);
  c.explanation.held_out = held_out_->mean(with.misfit);
  c.held_out_gain = 1 - *c.explanation.held_out / out_.held_out_before;
  c.held_out_worth = std::move(with.worth), c.held_out_history = std::move(with.history);
}

/// Of what is named, each fold by the explanation that says most without the gauges that judge. What has no fit of its own, as a fault of a gauge, foretells no
/// other gauge: nothing changes with it.
void DiagnosisEngine::hold_out_verdict() {
  std::vector<double> after = held_out_->base().misfit, best(after.size(), 0.0);
  for (const auto& c : out_.candidates)
    for (std::size_t i = 0; i < c.held_out_worth.size(); ++i)
      if (const double worth = c.held_out_worth[i] + c.choice; worth > best[i]) best[i] = worth, after[i] = c.held_out[2 * i + 1];
  const bool named = out_.verdict.kind == VerdictKind::named || out_.verdict.kind == VerdictKind::ambiguous;
  if (named && !out_.alternative(out_.verdict.mechanisms[0])->held_out.empty()) out_.held_out_after = held_out_->mean(after);
  const auto fit = named ? fits_.find(out_.verdict.mechanisms[0]) : fits_.end();
  out_.held_out_conditions = held_out_->by_condition(fit == fits_.end() ? nullptr : &fit->second.fit);
}

void DiagnosisEngine::locate_all() {
  const LogPosterior& posterior = *out_.base.posterior;
  const LocalMode& m = mode();
  const auto density = posterior.density(m.at);
  const Eigen::VectorXd r = out_.base.errors->data() - out_.base.prediction(m.at);
  const Eigen::MatrixXd j = posterior.jacobian(m.at);
  out_.location = locate(in_.base.problem, grid(), r, out_.base.errors->covariance() + density.variance * out_.base.noise + j * m.covariance * j.transpose());
}

/// Where nothing explains the records: which terms would.
void DiagnosisEngine::describe_missing() {
  if (out_.verdict.kind != VerdictKind::unknown || !out_.mixed_up.empty() || in_.terms.empty() || in_.options.term_runs == 0) return;
  if (const int runs = missing_terms_runs(in_.terms); runs > in_.options.term_runs) {
    out_.skipped.push_back(fmt::format("what is missing: its terms take {} runs, and diagnosis.term_runs is {}", runs, in_.options.term_runs));
    return;
  }
  say("which terms would do what is missing");
  out_.missing = missing_terms(about(out_.base, {}, in_.terms));
  for (auto& s : out_.missing->skipped) out_.skipped.push_back("what is missing: " + s);
}

const Alternative* Diagnosis::alternative(const std::string& name) const {
  const auto at = std::find_if(candidates.begin(), candidates.end(), [&](const auto& c) { return c.explanation.name == name; });
  return at == candidates.end() ? nullptr : &*at;
}

std::vector<Explanation> Diagnosis::by_evidence() const {
  std::vector<Explanation> all;
  for (const auto& c : candidates) all.push_back(c.explanation);
  sort_by_evidence(evidence, all);
  return all;
}

std::vector<std::string> Diagnosis::unsettled() const {
  if (verdict.mechanisms.empty()) {
    if (!base.settled) return {"base"};
    const auto all = by_evidence();
    if (!spent || verdict.kind != VerdictKind::unknown || all.empty()) return {};
    const Gate stopped = gate_not_passed(evidence, all, 0);  // what comes nearest has no fit, or leaves what a second effect may take: pairs come last
    const bool more_runs = stopped == Gate::fitted || ((stopped == Gate::explained || stopped == Gate::remainder) && !all[0].of_two);
    return more_runs ? std::vector{all[0].name} : std::vector<std::string>{};
  }
  std::vector<std::string> names;
  for (const auto& name : verdict.mechanisms)
    if (const Alternative* a = alternative(name); a && !a->settled) names.push_back(name);
  return names;
}

Diagnosis diagnose(const DiagnosisInputs& in) { return DiagnosisEngine(in).run(); }

}  // namespace calomel
