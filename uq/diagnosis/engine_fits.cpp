#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "uq/diagnosis/engine.hpp"
#include "uq/diagnosis/plain_words.hpp"

namespace calomel {

namespace {

constexpr std::size_t gauges_tried = 2;  ///< beside the one that says most to first order

/// What is known of an explanation before its fit: a group by itself, or on top of what was fitted already.
Alternative begun(const ParameterGroup& group, const Question& q, const Alternative* on_top_of) {
  Alternative c{.groups = {group.name},
                .places = {{group.name, group.place}},
                .first_log_bayes_factor = q.worth.log_bayes_factor,
                .choice = q.choice,
                .p_value = q.p_value};
  c.explanation.numerical = group.numerical, c.explanation.of_two = on_top_of != nullptr;
  if (on_top_of) {
    c.groups.insert(c.groups.end(), on_top_of->groups.begin(), on_top_of->groups.end());
    std::sort(c.groups.begin(), c.groups.end());
    c.choice += on_top_of->choice, c.first_log_bayes_factor += on_top_of->explanation.log_bayes_factor;
    c.places.insert(on_top_of->places.begin(), on_top_of->places.end());
  }
  for (const auto& name : c.groups) c.explanation.name += (c.explanation.name.empty() ? "" : "+") + name;
  return c;
}

}  // namespace

/// What costs no runs: the gauge that says most and the groups of many small numbers, each as one more term of the errors.
void DiagnosisEngine::fit_terms() {
  const auto worst = std::find_if(asked_.begin(), asked_.end(), [](const auto& q) { return q.sensor.has_value(); });
  if (worst != asked_.end()) fit_linear(*worst, nullptr, 0);
  for (const auto& q : asked_)
    if (groups_[q.group].linear) fit_linear(q, nullptr, 0);
}

/// The groups of many small numbers once more, in place of what they are worth about none: they are the dearest to follow, so what could lead them is fitted
/// before.
void DiagnosisEngine::follow_terms() {
  for (const auto& q : asked_) {
    if (!groups_[q.group].linear) continue;
    const auto about_none =
        std::find_if(out_.candidates.begin(), out_.candidates.end(), [&](const auto& c) { return c.explanation.name == groups_[q.group].name; });
    if (about_none == out_.candidates.end() || !may_lead(about_none->explanation.log_bayes_factor)) continue;
    out_.candidates.erase(about_none);
    fit_linear(q);
  }
}

/// A group whose effect is linear in its numbers, as one more term of the errors, beside the base model's parameters or beside those of what was fitted
/// already: about no numbers, and where it may lead, at most `rounds` times about those that come out, until they stay.
void DiagnosisEngine::fit_linear(const Question& q, const Alternative* on_top_of, int rounds) {
  Linearised about;
  about.q = q, about.rest = Eigen::VectorXd::Zero(q.effects.rows());
  std::optional<Alternative> c = linear_fit(about, on_top_of);
  const int before = runs_, more = int(q.numbers.size()) + 2;
  for (int round = 0; c && rounds > 0 && !q.sensor && may_lead(c->explanation.log_bayes_factor); ++round) {
    c->settled = c->settled && about.stays;
    if (about.stays || round == rounds) break;
    if (runs_ + more > in_.options.max_runs) {
      out_.spent = true;
      skip(fmt::format("{}: its numbers are asked for once more with {} runs, and {} are spent of diagnosis.max_runs = {}", c->explanation.name, more, runs_,
                       in_.options.max_runs));
      break;
    }
    if (!linearise(about, on_top_of)) {
      c->message = "a run about its numbers failed";
      break;
    }
    if (auto next = linear_fit(about, on_top_of)) c = std::move(next);
  }
  if (!c) return;
  if (groups_[q.group].linear) {
    const PosteriorFit& below = on_top_of ? fits_.at(on_top_of->explanation.name).fit : out_.base;
    const LinearBeside beside{
        .fit = below, .without = about.without, .with = about.with, .directions = about.q.directions, .effects = about.q.effects, .rest = about.rest};
    Foretold& f = c->explanation.foretold.emplace();
    f.misfit_before = on_top_of ? on_top_of->explanation.misfit : out_.evidence.misfit;
    std::tie(f.beginning_before, f.beginning) = held_out_->beginning(beside);
    if (held_out_->possible()) f.gauges_before = held_out_->misfit_by(below), keep(held_out_->by(beside), *c);
  }
  c->runs = runs_ - before;
  if (!c->settled && c->runs > 0 && c->message.empty())
    c->message = about.stays ? "it stands on a fit that has not settled" : fmt::format("its numbers still moved after {} runs", c->runs);
  if (c->runs > 0 || on_top_of)
    say(fmt::format("{}: log Bayes factor {:.4g}, chi-squared {:.4g} for {:.0f} values ({:.4g} without it), {} runs", c->explanation.name,
                    c->explanation.log_bayes_factor, c->explanation.chi2, out_.evidence.values, out_.evidence.chi2, c->runs));
  out_.candidates.push_back(std::move(*c));
}

/// The group's part of the records as rest + effects . numbers; none where no mode is found. Leaves in `about` where it came out.
std::optional<Alternative> DiagnosisEngine::linear_fit(Linearised& about, const Alternative* on_top_of) {
  const Question& q = about.q;
  const ParameterGroup& group = groups_[q.group];
  const PosteriorFit& below = on_top_of ? fits_.at(on_top_of->explanation.name).fit : out_.base;
  const LocalMode& start = below.modes[0];
  Alternative c = begun(group, q, on_top_of);
  if (!on_top_of) c.sensor = q.sensor ? in_.base.problem.shape.sensors[*q.sensor] : group.sensor, c.explanation.of_a_gauge = !c.sensor.empty();
  double gained = 0;  // by what it is put on top of
  if (on_top_of) {
    c.numbers = on_top_of->numbers;
    for (auto& n : c.numbers)  // as those of every pair, without the gauge
      if (const std::string& gauge = on_top_of->sensor; !gauge.empty() && n.name.starts_with(gauge + '.')) n.name.erase(0, gauge.size() + 1);
    gained = on_top_of->explanation.log_bayes_factor - on_top_of->choice;
  }
  const Eigen::MatrixXd d = q.directions.by_number * q.directions.prior_sd.asDiagonal();
  const ErrorTerm term{group.name, d * d.transpose()};
  const Eigen::VectorXd rest = grid().apply(about.rest);
  std::vector<WeightedErrors> errors, plain;
  for (const auto& h : below.hypotheses) {
    plain.push_back({h.errors.less(rest), h.log_weight, h.discrepancy});
    errors.push_back({plain.back().errors.with(term), h.log_weight, h.discrepancy});
  }
  const LogPosterior with = below.under(errors);
  const auto modes = find_modes(with, {with.q(start.at.theta, start.at.beyond)});
  if (modes.empty()) return {};
  const LocalMode& m = modes[0];
  c.explanation.fitted = true;
  c.explanation.log_bayes_factor = gained + log_evidence(with, m) - log_evidence(*below.posterior, start) + c.choice;
  c.explanation.by_scale = evidence_by_scale(with, m, errors, c.explanation.log_bayes_factor);
  const ErrorModel with_term = below.errors->less(rest).with(term);
  c.explanation.chi2 = chi2(plain_errors(below, with, m, with_term), with_term, below, m);
  c.explanation.base_pull = root_mean_square(pulls(m.at.theta));
  c.base_parameters = own_parameters(with, tempered_moments(with, m, in_.base.seed));
  c.settled = on_top_of ? on_top_of->settled : out_.base.settled;  // on whose emulator it stands
  // The numbers themselves: what is left of the residual at this mode in their directions, with the parameters where they are, for the mode already has its
  // freedom.
  const LogPosterior unmoved = below.under(plain);
  FirstOrder worth = FirstOrderModel(unmoved, m).worth(q.directions);
  worth.value = numbers_beside(unmoved, m.at, q.directions, with.likeliest(m.at));
  if (on_top_of) c.explanation.farthest = on_top_of->explanation.farthest;
  for (std::size_t i = 0; i < q.numbers.size(); ++i) {
    const AddedParameter& a = group.added[q.numbers[i]];
    const double value = *a.parameter.nominal + worth.value[Eigen::Index(i)];
    c.numbers.push_back(
        {(c.sensor.empty() ? "" : c.sensor + '.') + a.parameter.name, value, tempered(worth.sd[Eigen::Index(i)], q.directions.prior_sd[Eigen::Index(i)])});
    c.explanation.farthest = std::max(c.explanation.farthest, implausibility(a, value, c.numbers.back().sd));
  }
  c.history = kept(below.history(m.at.u, m.at.beyond) + about.rest + q.effects * worth.value);
  c.explanation.misfit = misfit(values(c.history));
  about.came_out(worth, m.at.theta);
  about.without = std::move(plain), about.with = std::move(errors);
  return c;
}

/// What the group's numbers do about where they came out, by runs of the coarser mesh. False where one failed.
bool DiagnosisEngine::linearise(Linearised& about, const Alternative* on_top_of) {
  const ParameterGroup& group = groups_[about.q.group];
  std::vector<AddedParameter> added = on_top_of ? fits_.at(on_top_of->explanation.name).added : std::vector<AddedParameter>{};
  added.insert(added.end(), group.added.begin(), group.added.end());
  const Eigen::MatrixXd thetas = about.points(group);
  const auto records = counted(thetas, std::vector<int>(std::size_t(thetas.cols()), in_.base.levels > 1 ? 1 : 0), added);
  if (std::any_of(records.begin(), records.end(), [](const auto& r) { return !r.done; })) return false;
  about.learn(thetas, records, grid());
  return true;
}

/// A question about one gauge as one about a group of its own, whose numbers the model can be run with.
Question DiagnosisEngine::of_its_own(Question q) {
  if (!q.sensor) return q;
  groups_.push_back(of_one_sensor(groups_[q.group], in_.base.problem.shape.sensors[*q.sensor]));
  q.group = groups_.size() - 1, q.sensor.reset();
  return q;
}

/// A fault of one gauge beyond first order, for a low pass or a delay is far from linear in its number: linearised anew until the numbers stay, on the emulator
/// of what it stands beside, which knows all but this gauge. Where that does not explain the records, asks for a number outside its range, or the model is
/// searched without an emulator, by a fit of its own; the better one is kept.
void DiagnosisEngine::fit_fault(const Question& q, const Alternative* on_top_of) {
  const Question own = of_its_own(q);
  const std::size_t before = out_.candidates.size();
  if (!in_.base.draw_in) fit_linear(own, on_top_of);
  const std::size_t linearised = out_.candidates.size();
  if (linearised > before) {
    const Alternative& c = out_.candidates.back();
    if (c.settled && std::isfinite(c.explanation.farthest) && c.explanation.log_bayes_factor > worth_fitting &&
        c.explanation.chi2 < greatest_plausible(out_.evidence))
      return;
  }
  fit(own, on_top_of);
  if (linearised == before || out_.candidates.size() == linearised) return;
  const Explanation& now = out_.candidates.back().explanation;
  Alternative& kept = out_.candidates[linearised - 1];
  if (now.fitted && (kept.runs == 0 || !std::isfinite(kept.explanation.farthest) || now.log_bayes_factor > kept.explanation.log_bayes_factor))
    std::swap(kept, out_.candidates.back());
  out_.candidates.pop_back();
}

/// The gauge that says most, in place of what its fault is worth to first order.
void DiagnosisEngine::fit_gauge(const Question& q) {
  const auto linear = std::find_if(out_.candidates.begin(), out_.candidates.end(), [&](const auto& c) { return c.explanation.name == groups_[q.group].name; });
  if (linear == out_.candidates.end()) return;
  const std::size_t others = out_.candidates.size(), place = std::size_t(linear - out_.candidates.begin());
  fit_fault(q);
  if (out_.candidates.size() == others) return;  // no runs left
  if (out_.candidates.back().explanation.fitted) out_.candidates[place] = std::move(out_.candidates.back());
  out_.candidates.pop_back();
}

/// What is known of an explanation that is not fitted: what it is worth to first order about the base fit.
Alternative DiagnosisEngine::to_first_order(const Question& q) const {
  const ParameterGroup& group = groups_[q.group];
  Alternative c = begun(group, q, nullptr);
  c.sensor = group.sensor, c.explanation.of_a_gauge = !c.sensor.empty();
  const double worth = q.worth.log_bayes_factor;
  c.explanation.log_bayes_factor = worth, c.explanation.chi2 = out_.evidence.chi2, c.explanation.misfit = out_.evidence.misfit,
  c.explanation.base_pull = out_.evidence.base_pull;
  for (std::size_t i = 0; i < q.numbers.size(); ++i) {
    const auto& a = group.added[q.numbers[i]];
    c.numbers.push_back(told(a, *a.parameter.nominal + q.worth.value[Eigen::Index(i)],
                             tempered(q.worth.sd[Eigen::Index(i)], q.directions.prior_sd[Eigen::Index(i)]), out_.base_parameters));
  }
  c.explanation.by_scale = out_.evidence.by_scale;  // it leaves what the base model leaves
  for (auto& s : c.explanation.by_scale) s.log_evidence = worth + std::min(0.0, s.log_evidence);
  c.message = "to first order";
  return c;
}

/// Those that could still lead, or stand in the way of what leads, by what they are worth to first order; where the base model does not explain the records,
/// the best of them in any case. What the budget leaves out keeps what it is worth to first order, so that nothing is named as if it had no rival.
void DiagnosisEngine::fit_leaders() {
  int fitted = 0;
  bool best_asked = false, gauge_asked = false;
  for (const auto& q : asked_) {
    const ParameterGroup& group = groups_[q.group];
    const bool there = std::any_of(out_.candidates.begin(), out_.candidates.end(), [&](const auto& c) { return c.explanation.name == group.name; });
    const double worth = q.worth.log_bayes_factor;
    if (q.sensor) {
      const bool first = !std::exchange(gauge_asked, true);
      if (first && fitted < in_.options.leaders && may_lead(worth)) fit_gauge(q), ++fitted;
      continue;
    }
    if (there) continue;  // a wall that says less, too
    if ((!best_asked && puzzled()) || (fitted < in_.options.leaders && (in_.base.draw_in || may_lead(worth)))) {
      best_asked = true;
      const std::size_t before = out_.candidates.size();
      group.sensor.empty() && !group.law ? fit(q) : fit_best_of(q);
      if (out_.candidates.size() > before) {
        ++fitted;
        continue;
      }
    }
    out_.candidates.push_back(to_first_order(q));  // where no runs were left for it, too
  }
}

/// The gauge that does not read true, and others in its place that could be as likely: two gauges that part may leave it open which of them is at fault.
/// Likewise the laws of a mechanism, of which the best is kept.
void DiagnosisEngine::fit_best_of(const Question& q) {
  const std::string& name = groups_[q.group].name;
  const auto key = [](const Alternative& a) { return a.sensor.empty() ? a.places.begin()->second : a.sensor; };
  std::vector<Alternative> all;
  std::map<std::string, Fitted> fits;  // by gauge or law
  for (const auto& other : asked_) {
    const bool one_of_them = groups_[other.group].name == name && other.worth.log_bayes_factor > q.worth.log_bayes_factor - hopeless;
    if (&other != &q && (!one_of_them || all.size() > gauges_tried)) continue;
    const std::size_t before = out_.candidates.size();
    fit(other);
    if (out_.candidates.size() == before) continue;  // no runs left
    all.push_back(std::move(out_.candidates.back()));
    out_.candidates.pop_back();
    if (auto made = fits_.extract(name)) fits.emplace(key(all.back()), std::move(made.mapped()));
  }
  if (all.empty()) return;
  const auto worth = [](const Alternative& a) { return a.explanation.log_bayes_factor; };
  // One that no runs were left for stays what it is worth to first order where that leads the fitted ones: none of these is named as if it were the best.
  const double fitted = std::accumulate(all.begin(), all.end(), -std::numeric_limits<double>::infinity(),
                                        [&](double most, const auto& a) { return a.explanation.fitted ? std::max(most, worth(a)) : most; });
  const auto rank = [&](const Alternative& a) { return std::pair(a.explanation.fitted || (out_.spent && worth(a) > fitted + Gates{}.lead), worth(a)); };
  const auto best = std::max_element(all.begin(), all.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  for (const auto& other : all)
    if (&other != &*best && other.explanation.fitted && !other.sensor.empty() && worth(*best) - worth(other) < Gates{}.lead)
      best->other_sensors.push_back(other.sensor);
  if (auto made = fits.extract(key(*best))) fits_.emplace(name, std::move(made.mapped()));
  out_.candidates.push_back(std::move(*best));
}

/// A group beside the base model's parameters, or beside those of what was fitted already.
void DiagnosisEngine::fit(const Question& q, const Alternative* on_top_of) {
  const ParameterGroup& group = groups_[q.group];
  Alternative c = begun(group, q, on_top_of);
  const PosteriorInputs* inputs = &in_.base;
  const PosteriorFit* below = &out_.base;
  std::vector<AddedParameter> added;
  if (on_top_of != nullptr) {
    const Fitted& f = fits_.at(on_top_of->explanation.name);
    inputs = &f.inputs, below = &f.fit, added = f.added;
  } else {
    c.sensor = group.sensor, c.explanation.of_a_gauge = !c.sensor.empty();
  }
  CandidatePlan plan = plan_candidate(*inputs, *below, groups_, q);
  added.insert(added.end(), plan.added.begin(), plan.added.end());
  if (runs_ + first_runs(plan) > in_.options.max_runs) {
    skip(fmt::format("{}: it begins with {} runs, and {} are spent of diagnosis.max_runs = {}", c.explanation.name, first_runs(plan), runs_,
                     in_.options.max_runs));
    out_.spent = true;
    return;
  }
  say(fmt::format("fit of {} ({} runs so far)", c.explanation.name, runs_));
  PosteriorInputs& in = plan.inputs;
  ended_ = false;
  in.run = [this, added](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
    const bool beyond = in_.base.draw_in && runs_ + int(level.size()) > in_.options.max_runs;  // a search of the model itself may take any number
    ended_ = ended_ || beyond;
    if (beyond) throw NumericsError(fmt::format("diagnosis.max_runs = {} ended its fit before it was done", in_.options.max_runs));
    return counted(thetas, level, added);
  };
  if (places_.size()) in.gauge_places = [this](std::span<const double>) { return places_; };
  in.round_done = [&](const PosteriorRound& r) {
    if (in_.round) in_.round(r, in.parameters);
  };
  const int before = runs_;
  try {
    FittedCandidate fitted =
        fit_candidate(plan, out_.base, [&](std::optional<double> worth) { return (!worth || may_lead(*worth + c.choice)) && runs_ < in_.options.max_runs; });
    const PosteriorFit& fit = fitted.fit;
    const LocalMode& full = fit.modes[0];
    const LogPosterior& posterior = *fit.posterior;
    c.explanation.fitted = true;
    c.explanation.log_bayes_factor = log_bayes_factor(fit, out_.base) + c.choice;
    c.explanation.by_scale = evidence_by_scale(posterior, full, fit.hypotheses, c.explanation.log_bayes_factor);
    const Cholesky plain = plain_errors(fit, posterior, full, *fit.errors);
    c.explanation.chi2 = chi2(plain, *fit.errors, fit, full);
    c.explanation.base_chi2 = chi2(plain, *fit.errors, out_.base, mode());
    c.explanation.base_pull = root_mean_square(pulls(full.at.theta));
    const Moments moments = parameters_of(fit, in_.base.seed);
    c.base_parameters = own_parameters(posterior, moments);
    const std::size_t n = in_.base.parameters.size();
    for (std::size_t i = 0; i < added.size(); ++i) {
      c.numbers.push_back(told(added[i], moments.mean[Eigen::Index(n + i)], moments.sd[Eigen::Index(n + i)], c.base_parameters));
      if (!c.sensor.empty()) c.numbers.back().name.insert(0, c.sensor + '.');
      c.explanation.farthest = std::max(c.explanation.farthest, implausibility(added[i], full.at.theta[n + i]));
    }
    for (auto& [name, place] : c.places) place = fitted_place(name, place, c.numbers);
    c.history = kept(fit.history_at_mode());
    c.explanation.misfit = misfit(values(c.history));
    c.settled = fitted.stands;
    if (ended_)
      skip(fmt::format("{}: diagnosis.max_runs = {} ended a search for its fit before it was done; the best that was found is told", c.explanation.name,
                       in_.options.max_runs));
    out_.spent = out_.spent || (!c.settled && (ended_ || runs_ >= in_.options.max_runs));
    c.message = fitted.stands && !fit.settled
                    ? fmt::format("evidence and numbers stood still from {} coarse and {} fine runs on", fit.rounds.back().coarse, fit.rounds.back().fine)
                    : fit.message;
    fits_.emplace(c.explanation.name, Fitted{added, std::move(fitted.inputs), std::move(fitted.fit)});
  } catch (const NumericsError& e) {
    if (ended_) skip(c.explanation.name + ": " + e.what()), out_.spent = true;
    if (ended_ && !on_top_of) {
      c = to_first_order(q);
    } else {  // nothing of a fit that failed half way
      c.explanation.fitted = false, c.explanation.log_bayes_factor = 0, c.explanation.base_chi2.reset(), c.explanation.farthest = 0;
      c.explanation.by_scale = out_.evidence.by_scale;
      c.explanation.chi2 = out_.evidence.chi2, c.explanation.misfit = out_.evidence.misfit, c.explanation.base_pull = out_.evidence.base_pull;
      c.numbers.clear(), c.base_parameters.clear(), c.history.clear();
    }
    c.message = e.what();
  }
  c.runs = runs_ - before;
  say(fmt::format("{}: log Bayes factor {:.4g}, chi-squared {:.4g} for {:.0f} values ({:.4g} without it), {} runs", c.explanation.name,
                  c.explanation.log_bayes_factor, c.explanation.chi2, out_.evidence.values, out_.evidence.chi2, c.runs));
  out_.candidates.push_back(std::move(c));
}

/// Where nothing is named: the physics that leads among what was fitted, and on top of it what then says most. A fault of a gauge comes first only where no
/// physics has the evidence, and second after all physics. Where physics is named: a gauge at fault beside it, which nothing that the physics leaves looks
/// like.
void DiagnosisEngine::fit_pair() {
  const bool named = out_.verdict.kind == VerdictKind::named;
  if (!named && out_.verdict.kind != VerdictKind::unknown) return;
  const auto may_be_first = [&](const Alternative& c, bool gauges) {
    const bool fitted = fits_.contains(c.explanation.name) && !c.explanation.numerical;
    return fitted && (gauges || c.sensor.empty()) && c.explanation.log_bayes_factor >= (gauges ? worth_fitting : Gates{}.log_bayes_factor);
  };
  auto first = std::find_if(out_.candidates.begin(), out_.candidates.end(),
                            [&](const auto& c) { return may_be_first(c, false) && (!named || c.explanation.name == out_.verdict.mechanisms[0]); });
  if (first == out_.candidates.end() && !named)
    first = std::find_if(out_.candidates.begin(), out_.candidates.end(), [&](const auto& c) { return may_be_first(c, true); });
  if (first == out_.candidates.end()) return;
  const Alternative below = *first;
  const Fitted& f = fits_.at(below.explanation.name);
  const auto asked = [&](const ParameterGroup& g) { return g.name != below.groups[0] && (!named || g.by_sensor || !g.sensor.empty()); };
  if (named && std::none_of(in_.groups.begin(), in_.groups.end(), asked)) return;
  say(fmt::format("what {} would be worth on top of {}, to first order", named ? "a fault of each gauge" : "each mechanism", below.explanation.name));
  QuestionInputs in = about(f.fit, f.added, in_.groups);
  in.asked = asked;
  auto questions = ask(in).questions;
  // Where runs cost little several are fitted, gauges last: on top of what already explains much, first order says little.
  const bool quick = in_.base.least_squares && !named;
  if (quick) std::stable_partition(questions.begin(), questions.end(), [&](const Question& q) { return groups_[q.group].sensor.empty(); });
  const std::size_t most = quick ? std::size_t(in_.options.leaders) : 1;
  const double least = named ? Gates{}.log_bayes_factor : worth_fitting;
  std::set<std::string> tried;
  for (const auto& q : questions) {
    if (groups_[q.group].numerical || !tried.insert(groups_[q.group].name).second) continue;
    if (tried.size() > most || (!quick && q.worth.log_bayes_factor < least)) break;
    say(fmt::format("{}: log Bayes factor {:.3g} to first order on top of it", label(q, groups_, in_.base.problem.shape), q.worth.log_bayes_factor));
    q.sensor ? fit_fault(q, &below) : groups_[q.group].linear ? fit_linear(q, &below) : fit(q, &below);
  }
  judge_all();
}

}  // namespace calomel
