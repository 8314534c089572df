#include "uq/diagnosis/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double reach = 1.0;          ///< half width of the first box of a candidate's number, over its distance from off to first order
constexpr double widths = 4;           ///< the same in standard deviations to first order
constexpr double least_width = 0.15;   ///< the same over the number's range
constexpr double farthest_shift = 0.7; ///< of the base parameters' box by what the first order says, in its half widths
constexpr double worth_fitting = 3;    ///< log Bayes factor to first order
constexpr double spare = 3;            ///< runs of the coarser meshes over coefficients of a candidate's emulator, to begin with: they cost an eighth of the finer's
constexpr double spare_fine = 1.5;     ///< of the finest mesh
constexpr double zoom = 0.4, box_in_deviations = 4;        ///< the second box over the first, at least, and in deviations of the answer
constexpr int first_rounds = 1, most_rounds = 6;           ///< of a candidate's emulator: before it is given up, and at all
constexpr double steady = 3, steady_share = 0.1;            ///< change of a log Bayes factor in a round, and that over itself, below which it stays; twice is enough
constexpr double hopeless = Gates{}.lead;  ///< log Bayes factors below the best so far: the lead that a name needs
constexpr double alike = 4;            ///< distance in standard deviations below which two explanations are one class

/// Log evidence of a fit under the errors of another, each on its own emulator.
double evidence(const PosteriorFit& fit, const PosteriorFit& errors) {
  if (&fit == &errors) return log_evidence(*fit.posterior, fit.modes[0]);
  const LogPosterior p = fit.under(errors.hypotheses);
  const auto modes = find_modes(p, {fit.modes[0].q});
  if (modes.empty()) throw NumericsError("no mode of a posterior was found under the errors of another");
  return log_evidence(p, modes[0]);
}

/// Deviations of the free parameters, natural units: Laplace's, and what the mode moved while runs were added, which his do not know of.
Eigen::VectorXd parameter_deviations(const PosteriorFit& fit, const LocalMode& m) {
  Eigen::VectorXd variance = parameter_covariance(*fit.posterior, m).diagonal();
  const std::size_t first = std::min<std::size_t>(1, fit.rounds.size() - 1);  // the first fit may be far off
  const auto n = double(fit.rounds.size() - first);
  const auto& free = fit.posterior->free();
  for (std::size_t i = 0; i < free.size() && n > 1; ++i) {
    double sum = 0, squares = 0;
    for (std::size_t r = first; r < fit.rounds.size(); ++r) {
      const double t = fit.rounds[r].theta[std::size_t(free[i])] - m.at.theta[std::size_t(free[i])];
      sum += t, squares += t * t;
    }
    variance[Eigen::Index(i)] += (squares - sum * sum / n) / (n - 1);
  }
  return variance.cwiseSqrt();
}

class Engine {
 public:
  explicit Engine(const DiagnosisInputs& in) : in_(in), own_(in.base.problem.shape.parameters.size()) {}

  Diagnosis run() {
    say("base fit");
    PosteriorInputs base = in_.base;
    base.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return counted(thetas, level, {}); };
    out_.base = fit_posterior(base);
    if (base.gauge_places) places_ = base.gauge_places(mode().at.theta);
    describe_base();
    ask_all();
    fit_linear();
    fit_leaders();
    judge_all();
    if (in_.options.pairs && out_.verdict.kind == VerdictKind::unknown) fit_pair();
    hold_out();
    locate_all();
    separate();
    out_.runs = runs_;
    return std::move(out_);
  }

 private:
  void say(const std::string& text) const {
    if (in_.say) in_.say(text);
  }
  [[nodiscard]] const LocalMode& mode() const { return out_.base.modes[0]; }
  [[nodiscard]] const Decimation& grid() const { return out_.base.errors->grid(); }
  std::vector<RunRecord> counted(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
    runs_ += int(level.size());
    return in_.run(thetas, level, added);
  }
  /// chi-squared of a fit without any discrepancy at the mode of the posterior with it.
  [[nodiscard]] static double plain_chi2(const PosteriorFit& fit, const LogPosterior& posterior, const LocalMode& m, const ErrorModel& errors) {
    const auto density = posterior.density(m.at);
    const Eigen::VectorXd r = errors.data() - fit.coefficients * posterior.emulator().features(m.at.u, m.at.beyond);
    return Cholesky(errors.covariance() + density.variance * fit.noise).solve_lower(r).squaredNorm();
  }
  /// Distances of the case's own parameters from the middle of their priors, in standard deviations; 0 of one that has no handbook's.
  [[nodiscard]] std::vector<double> pulls(std::span<const double> theta) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < own_; ++k) all.push_back(prior_deviation(in_.base.parameters[k], theta[k]).value_or(0));
    return all;
  }
  [[nodiscard]] static double root_mean_square(const std::vector<double>& x) {
    double sum = 0;
    for (const double v : x) sum += v * v;
    return x.empty() ? 0 : std::sqrt(sum / double(x.size()));
  }
  [[nodiscard]] std::vector<Estimate> own_parameters(const LogPosterior& posterior, const Eigen::VectorXd& sd, const LocalMode& m) const {
    std::vector<Estimate> all;
    for (std::size_t i = 0; i < posterior.free().size(); ++i) {
      const auto k = std::size_t(posterior.free()[i]);
      if (k < own_) all.push_back({in_.base.parameters[k].name, m.at.theta[k], sd[Eigen::Index(i)]});
    }
    return all;
  }

  /// Of a fit over the base model's, both under the errors of the one and both under those of the other: what counts is the lesser.
  [[nodiscard]] double log_bayes_factor(const PosteriorFit& f) const {
    return std::min(evidence(f, f) - evidence(out_.base, f), evidence(f, out_.base) - evidence(out_.base, out_.base));
  }
  [[nodiscard]] double best_so_far() const {
    double best = 0;
    for (const auto& c : out_.candidates) best = std::max(best, c.explanation.log_bayes_factor);
    return best;
  }
  void describe_base();
  void ask_all();
  void fit_linear();
  void fit_linear(const Question& q);
  void fit_leaders();
  void fit_pair();
  void fit(const std::vector<const Question*>& with);
  void reach_back(PosteriorInputs& in) const;
  [[nodiscard]] PosteriorFit followed(PosteriorInputs& in) const;
  void judge_all();
  void hold_out();
  void locate_all();
  void separate();

  const DiagnosisInputs& in_;
  const std::size_t own_;  ///< the case's own parameters
  Diagnosis out_;
  Eigen::MatrixXd places_;
  std::vector<Question> asked_;               ///< most telling first
  std::map<std::string, PosteriorFit> fits_;  ///< of candidates by name
  int runs_ = 0;
};

void Engine::describe_base() {
  const LocalMode& m = mode();
  const LogPosterior& posterior = *out_.base.posterior;
  out_.base_parameters = own_parameters(posterior, parameter_deviations(out_.base, m), m);
  out_.handbook_pulls = pulls(m.at.theta);
  const Eigen::VectorXd history = out_.base.history(m.at.u, m.at.beyond);
  out_.base_history.assign(history.begin(), history.end());
  BaseEvidence& e = out_.evidence;
  e.values = double(grid().size());
  e.chi2 = plain_chi2(out_.base, posterior, m, *out_.base.errors);
  e.base_pull = root_mean_square(out_.handbook_pulls);
  // The mixture's parts apart: the first hypothesis has no discrepancy.
  std::vector<WeightedErrors> none{out_.base.hypotheses[0]};
  const std::vector<WeightedErrors> some(out_.base.hypotheses.begin() + 1, out_.base.hypotheses.end());
  const auto evidence_of = [&](std::vector<WeightedErrors> part) {
    if (part.empty()) return -std::numeric_limits<double>::infinity();
    double total = 0;
    for (const auto& h : part) total += std::exp(h.log_weight);
    for (auto& h : part) h.log_weight -= std::log(total);
    const LogPosterior p = out_.base.under(part);
    const auto modes = find_modes(p, {p.q(m.at.theta, m.at.beyond)});
    return modes.empty() ? -std::numeric_limits<double>::infinity() : log_evidence(p, modes[0]);
  };
  const double whole = log_evidence(posterior, m);
  e.log_plain = evidence_of(none) - whole, e.log_discrepancy = evidence_of(some) - whole;
}

void Engine::ask_all() {
  say("what each mechanism would be worth, to first order");
  Answers answers = ask({.fit = out_.base,
                         .problem = in_.base.problem,
                         .groups = in_.groups,
                         .level = in_.base.levels > 1 ? 1 : 0,
                         .run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) { return counted(thetas, level, added); },
                         .linear = in_.linear});
  asked_ = std::move(answers.questions);
  out_.skipped.insert(out_.skipped.end(), answers.skipped.begin(), answers.skipped.end());
  for (const auto& q : asked_)
    if (q.worth.log_bayes_factor > worth_fitting)
      say(fmt::format("{}: log Bayes factor {:.3g} to first order, p {:.2g}", label(q, in_.groups, in_.base.problem.shape), q.worth.log_bayes_factor, q.p_value));
}

/// The worst gauge and the linear groups: what they do is linear in their numbers, so that these are one more term of the errors and need no runs.
void Engine::fit_linear() {
  const auto worst = std::find_if(asked_.begin(), asked_.end(), [](const auto& q) { return q.sensor.has_value(); });
  if (worst != asked_.end()) fit_linear(*worst);
  for (const auto& q : asked_)
    if (in_.groups[q.group].linear) fit_linear(q);
}

void Engine::fit_linear(const Question& q) {
  const ParameterGroup& group = in_.groups[q.group];
  const LogPosterior& base = *out_.base.posterior;
  Alternative c{.groups = {group.name}, .sensor = q.sensor ? in_.base.problem.shape.sensors[*q.sensor] : "", .place = group.place, .first_log_bayes_factor = q.worth.log_bayes_factor, .p_value = q.p_value};
  c.explanation.name = group.name;
  const Eigen::MatrixXd d = q.directions.by_number * q.directions.prior_sd.asDiagonal();
  const ErrorTerm term{group.name, d * d.transpose()};
  std::vector<WeightedErrors> errors;
  for (const auto& h : out_.base.hypotheses) errors.push_back({h.errors.with(term), h.log_weight, h.discrepancy});
  const LogPosterior with = out_.base.under(errors);
  const auto modes = find_modes(with, {with.q(mode().at.theta, mode().at.beyond)});
  if (modes.empty()) return;
  const LocalMode& m = modes[0];
  c.explanation.fitted = true;
  c.explanation.log_bayes_factor = log_evidence(with, m) - log_evidence(base, mode()) - (q.sensor ? std::log(double(in_.base.problem.observations.size())) : 0);  // any gauge might have been the one
  c.explanation.chi2 = plain_chi2(out_.base, with, m, out_.base.errors->with(term));
  c.explanation.base_pull = root_mean_square(pulls(m.at.theta));
  c.base_parameters = own_parameters(with, parameter_covariance(with, m).diagonal().cwiseSqrt(), m);
  // The numbers themselves: what is left of the residual at this mode in their directions.
  const FirstOrder worth = FirstOrderModel(base, m).worth(q.directions);
  Eigen::VectorXd history = out_.base.history(m.at.u, m.at.beyond);
  for (std::size_t i = 0; i < q.numbers.size(); ++i) {
    const AddedParameter& a = group.added[q.numbers[i]];
    const double value = *a.parameter.nominal + worth.value[Eigen::Index(i)];
    c.numbers.push_back({(c.sensor.empty() ? "" : c.sensor + '.') + a.parameter.name, value, worth.sd[Eigen::Index(i)]});
    c.explanation.farthest = std::max(c.explanation.farthest, implausibility(a, value));
  }
  history += q.effects * worth.value;
  c.history.assign(history.begin(), history.end());
  out_.candidates.push_back(std::move(c));
}

/// Those that could still lead, or stand in the way of what leads, by what they are worth to first order.
void Engine::fit_leaders() {
  int fitted = 0;
  for (const auto& q : asked_) {
    const std::string& name = in_.groups[q.group].name;
    const bool there = std::any_of(out_.candidates.begin(), out_.candidates.end(), [&](const auto& c) { return c.explanation.name == name; });
    if (q.sensor || there) continue;  // a wall that says less, too
    const double worth = q.worth.log_bayes_factor;
    if (fitted == 0 || (fitted < in_.options.leaders && (in_.base.draw_in || (worth > worth_fitting && worth > best_so_far() - hopeless)))) {
      fit({&q});
      ++fitted;
      continue;
    }
    Alternative c{.groups = {name}, .place = in_.groups[q.group].place, .first_log_bayes_factor = worth, .p_value = q.p_value};
    c.explanation = {.name = name, .numerical = in_.groups[q.group].numerical, .log_bayes_factor = worth, .chi2 = out_.evidence.chi2, .base_pull = out_.evidence.base_pull};
    for (std::size_t i = 0; i < q.numbers.size(); ++i) {
      const auto& a = in_.groups[q.group].added[q.numbers[i]];
      c.numbers.push_back({a.parameter.name, *a.parameter.nominal + q.worth.value[Eigen::Index(i)], q.worth.sd[Eigen::Index(i)]});
    }
    c.message = "to first order";
    out_.candidates.push_back(std::move(c));
  }
}

/// Followed until more runs would not change what it is worth, if it may lead.
PosteriorFit Engine::followed(PosteriorInputs& in) const {
  double last = -std::numeric_limits<double>::infinity();
  int stayed = 0;
  in.go_on = [&](const PosteriorFit& f) {
    const double now = log_bayes_factor(f);
    stayed = std::abs(now - last) < std::max(steady, steady_share * std::abs(now)) ? stayed + 1 : 0;
    last = now;
    const auto rounds = int(f.rounds.size());
    return rounds <= first_rounds || (rounds < most_rounds && now > best_so_far() - hopeless && stayed < 2);
  };
  return fit_posterior(in);
}

/// A base fit that had to do without the physics has pushed its parameters away from what is known of them: the box reaches back there, where knowledge is narrower than the box.
void Engine::reach_back(PosteriorInputs& in) const {
  for (std::size_t k = 0; k < in.centre.size(); ++k) {
    const Parameter& p = in.parameters[k];
    const bool logarithm = p.min > 0;
    const auto deviation = prior_deviation(p, in.centre[k]);
    if (!deviation) continue;
    const double sd = p.prior == "lognormal" ? *p.sigma : logarithm ? *p.sd / *p.mean : *p.sd;  // of the box's coordinate
    if (sd > in.half_width[k]) continue;
    const double from = logarithm ? std::log(in.centre[k]) : in.centre[k], to = from - *deviation * sd;
    const double middle = 0.5 * (from + to);
    in.half_width[k] = std::max(in.half_width[k], 0.5 * (std::abs(from - to) + in.half_width[k]));
    in.centre[k] = logarithm ? std::exp(middle) : middle;
  }
}

/// The base model with the numbers of one or two groups beside its own parameters, on one emulator and under the same errors with and without them.
void Engine::fit(const std::vector<const Question*>& with) {
  Alternative c;
  std::vector<AddedParameter> added;
  std::vector<Parameter> parameters;
  std::vector<double> estimate, sd;  ///< to first order
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(out_.base.posterior->dimension());
  std::vector<std::string> names;
  for (const Question* q : with) {
    const ParameterGroup& group = in_.groups[q->group];
    names.push_back(group.name), c.groups.push_back(group.name);
    c.explanation.numerical |= group.numerical;
    if (!group.place.empty()) c.place = group.place;
    c.first_log_bayes_factor += q->worth.log_bayes_factor, c.p_value = std::min(c.p_value, q->p_value);
    for (std::size_t i = 0; i < q->numbers.size(); ++i) {
      const AddedParameter& a = group.added[q->numbers[i]];
      added.push_back(a), parameters.push_back(a.parameter);
      sd.push_back(q->worth.sd[Eigen::Index(i)]);
      estimate.push_back(std::clamp(*a.parameter.nominal + q->worth.value[Eigen::Index(i)], a.parameter.min, a.parameter.max));
    }
    for (std::size_t i = 0; i < group.shapes.size(); ++i) {
      const AddedParameter& a = group.shapes[i];
      added.push_back(a), parameters.push_back(a.parameter);
      estimate.push_back(q->shapes[i]), sd.push_back(0);
    }
    shift += q->worth.shift;
  }
  std::sort(names.begin(), names.end());
  c.explanation.name = names[0] + (names.size() > 1 ? '+' + names[1] : "");
  const int planned = in_.options.candidate_coarse + in_.options.candidate_fine;
  if (runs_ + planned > in_.options.max_runs) {
    out_.skipped.push_back(fmt::format("{}: {} runs are spent of diagnosis.max_runs = {}", c.explanation.name, runs_, in_.options.max_runs));
    return;
  }
  say(fmt::format("fit of {} ({} runs so far)", c.explanation.name, runs_));

  PosteriorInputs in = in_.base;
  const std::size_t n = in.parameters.size();
  in.run = [this, added](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return counted(thetas, level, added); };
  if (places_.size()) in.gauge_places = [this](std::span<const double>) { return places_; };
  in.parameters.insert(in.parameters.end(), parameters.begin(), parameters.end());
  in.round_done = [&](const PosteriorRound& r) {
    if (in_.round) in_.round(r, in.parameters);
  };
  Eigen::VectorXd u = mode().at.u;
  for (std::size_t i = 0; i < out_.base.posterior->free().size(); ++i) u[out_.base.posterior->free()[i]] += std::clamp(shift[Eigen::Index(i)], -farthest_shift, farthest_shift);
  in.centre = out_.base.posterior->box().theta(u);
  reach_back(in);
  for (std::size_t i = 0; i < added.size(); ++i) {
    // The logarithm where the lower bound is positive, as the box has it.
    const Parameter& p = added[i].parameter;
    const auto coordinate = [&](double x) { return p.min > 0 ? std::log(x) : x; };
    const double away = std::abs(coordinate(estimate[i]) - coordinate(*p.nominal)), deviation = p.min > 0 ? sd[i] / estimate[i] : sd[i];
    if (p.prior == "lognormal") {  // a shape: about the value that did best
      in.centre.push_back(estimate[i]), in.half_width.push_back(*p.sigma);
      continue;
    }
    const double least = p.prior == "half_cauchy" ? 0.5 * added[i].strengths[0] : least_width * (coordinate(p.max) - coordinate(p.min));
    in.centre.push_back(estimate[i]);
    in.half_width.push_back(std::max({reach * away, widths * deviation, least}));
  }
  const auto d = Eigen::Index(in.parameters.size());
  in.emulator.coarse_runs = std::max(in_.options.candidate_coarse, int(spare * double(MultilevelRegression::coefficients(d, 1))));
  in.emulator.fine_runs = std::max<int>(in_.options.candidate_fine, int(spare_fine * double(d + 1)) + 1);
  in.emulator.round_coarse = std::max<int>(in.emulator.round_coarse, 3 * int(d));
  for (const auto& r : out_.base.runs) {
    TaughtRun known = r;
    for (const auto& a : added) known.theta.push_back(*a.parameter.nominal);
    in.known.push_back(std::move(known));
  }
  const int before = runs_;
  try {
    PosteriorFit fitted = followed(in);
    double worth = log_bayes_factor(fitted);
    if (worth > worth_fitting && worth > best_so_far() - hopeless) {  // once more about the answer: over a wide box a quadratic is only so good
      in.centre = fitted.modes[0].at.theta;
      const Eigen::VectorXd sd = fitted.modes[0].covariance.diagonal().cwiseSqrt();
      for (std::size_t k = 0; k < in.half_width.size(); ++k) in.half_width[k] *= std::clamp(box_in_deviations * sd[Eigen::Index(k)], zoom, 1.0);
      in.known = std::move(fitted.runs);
      fitted = followed(in);
      worth = log_bayes_factor(fitted);
    }
    const LocalMode& full = fitted.modes[0];
    const LogPosterior& posterior = *fitted.posterior;
    c.explanation.fitted = true;
    c.explanation.log_bayes_factor = worth;
    c.explanation.chi2 = plain_chi2(fitted, posterior, full, *fitted.errors);
    c.explanation.base_pull = root_mean_square(pulls(full.at.theta));
    const Eigen::VectorXd deviations = parameter_deviations(fitted, full);
    c.base_parameters = own_parameters(posterior, deviations, full);
    for (std::size_t i = 0; i < added.size(); ++i) {
      c.numbers.push_back({added[i].parameter.name, full.at.theta[n + i], deviations[Eigen::Index(n + i)]});
      c.explanation.farthest = std::max(c.explanation.farthest, implausibility(added[i], full.at.theta[n + i]));
    }
    const Eigen::VectorXd history = fitted.history(full.at.u, full.at.beyond);
    c.history.assign(history.begin(), history.end());
    c.settled = fitted.settled, c.message = fitted.message;
    fits_.insert_or_assign(c.explanation.name, std::move(fitted));
  } catch (const NumericsError& e) {
    c.message = e.what();
    c.explanation.chi2 = out_.evidence.chi2, c.explanation.base_pull = out_.evidence.base_pull;
  }
  c.runs = runs_ - before;
  say(fmt::format("{}: log Bayes factor {:.4g}, chi-squared {:.4g} for {:.0f} values ({:.4g} without it), {} runs", c.explanation.name, c.explanation.log_bayes_factor, c.explanation.chi2,
                  out_.evidence.values, out_.evidence.chi2, c.runs));
  out_.candidates.push_back(std::move(c));
}

void Engine::judge_all() {
  std::stable_sort(out_.candidates.begin(), out_.candidates.end(),
                   [](const auto& a, const auto& b) { return a.explanation.log_bayes_factor > b.explanation.log_bayes_factor; });
  // Explanations whose predictions no record tells apart, once scaled to each other.
  const Cholesky errors(out_.base.errors->covariance());
  const auto effect = [&](const Alternative& c) {
    const Eigen::VectorXd change = Eigen::Map<const Eigen::VectorXd>(c.history.data(), Eigen::Index(c.history.size())) -
                                   Eigen::Map<const Eigen::VectorXd>(out_.base_history.data(), Eigen::Index(out_.base_history.size()));
    return errors.solve_lower(Eigen::VectorXd(grid().apply(change)));
  };
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
  for (const auto& c : out_.candidates) all.push_back(c.explanation);
  out_.verdict = judge(out_.evidence, all);
}

/// The two singles that lead, together.
void Engine::fit_pair() {
  std::vector<const Question*> two;
  for (const auto& c : out_.candidates) {
    if (two.size() == 2 || c.explanation.numerical || !c.explanation.fitted || !c.sensor.empty()) continue;
    const auto at = std::find_if(asked_.begin(), asked_.end(), [&](const Question& q) { return !q.sensor && in_.groups[q.group].name == c.groups[0]; });
    if (at != asked_.end() && c.groups.size() == 1) two.push_back(&*at);
  }
  if (two.size() < 2) return;
  fit(two);
  judge_all();
}

void Engine::hold_out() {
  const auto folds = folds_by_face(in_.base.problem, grid(), in_.base.positions);
  const Eigen::VectorXd& data = out_.base.errors->data();
  const PosteriorFit& base = out_.base;
  std::vector<double> before;
  for (const auto& f : folds) {
    const PartFit part = fit_without(base, base, f);
    before.push_back(misfit_of(f, grid(), part.prediction, data));
    keep_held_out(f, grid(), in_.base.problem, part.history, out_.held_out_history);
  }
  const auto gauges = [&](const std::vector<double>& by_fold) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < folds.size(); ++i) sum += by_fold[i] * folds[i].records, count += folds[i].records;
    return sum / count;
  };
  out_.held_out_before = out_.held_out_after = gauges(before);
  std::vector<double> best(folds.size(), -std::numeric_limits<double>::infinity()), after = before;
  for (auto& c : out_.candidates) {
    const auto fit = fits_.find(c.explanation.name);
    if (fit == fits_.end() || c.explanation.log_bayes_factor <= 0) continue;
    std::vector<double> with;
    for (std::size_t i = 0; i < folds.size(); ++i) {
      const PartFit part = fit_without(fit->second, fit->second, folds[i]);
      with.push_back(misfit_of(folds[i], grid(), part.prediction, data));
      keep_held_out(folds[i], grid(), in_.base.problem, part.history, c.held_out_history);
      c.held_out.push_back(before[i]), c.held_out.push_back(with.back());
      const double worth = part.log_evidence - fit_without(base, fit->second, folds[i]).log_evidence;
      if (worth > std::max(0.0, best[i])) best[i] = worth, after[i] = with.back();  // selected without the gauges that judge
    }
    c.held_out_gain = 1 - gauges(with) / out_.held_out_before;
  }
  if (out_.verdict.kind == VerdictKind::named || out_.verdict.kind == VerdictKind::ambiguous) out_.held_out_after = gauges(after);
}

void Engine::locate_all() {
  const LogPosterior& posterior = *out_.base.posterior;
  const LocalMode& m = mode();
  const auto density = posterior.density(m.at);
  const Eigen::VectorXd r = out_.base.errors->data() - out_.base.coefficients * posterior.emulator().features(m.at.u, m.at.beyond);
  const Eigen::MatrixXd j = posterior.jacobian(m.at);
  out_.location = locate(in_.base.problem, grid(), r, out_.base.errors->covariance() + density.variance * out_.base.noise + j * m.covariance * j.transpose(), 1);
}

/// Where and when the first two explanations differ most, in standard deviations of a mean record.
void Engine::separate() {
  std::vector<const Alternative*> two;
  for (const auto& c : out_.candidates)
    if (!c.history.empty() && two.size() < 2) two.push_back(&c);
  if (two.empty()) {
    out_.separating = "nothing was fitted that a further measurement could tell apart";
    return;
  }
  const auto values = [](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size())); };
  const Eigen::VectorXd other = two.size() > 1 ? Eigen::VectorXd(values(two[1]->history)) : Eigen::VectorXd(values(out_.base_history));
  const Eigen::VectorXd difference = grid().apply(values(two[0]->history) - other);
  const Eigen::VectorXd z = difference.cwiseQuotient(out_.base.errors->covariance().diagonal().cwiseSqrt());
  Eigen::Index most = 0;
  z.cwiseAbs().maxCoeff(&most);
  std::size_t at = 0;
  while (at + 1 < grid().observations() && Eigen::Index(grid().offset(at + 1)) <= most) ++at;
  const double time = grid().times()[most];
  out_.separating = fmt::format("{} and {} differ most at gauge {} about {:.0f} us, by {:.2g} {} ({:.2g} standard deviations of its mean record and what is not known of it): more pulses, or a second gauge beside it, tell most there",
                                two[0]->explanation.name, two.size() > 1 ? two[1]->explanation.name : "the base model", in_.base.problem.label(in_.base.problem.observations[at]), 1e6 * time,
                                in_.base.problem.mae_scale * std::abs(difference[most]), in_.base.problem.mae_unit, std::abs(z[most]));
}

}  // namespace

Diagnosis diagnose(const DiagnosisInputs& in) {
  Diagnosis out = Engine(in).run();
  for (const auto& p : in.base.problem.shape.parameters) out.parameters.push_back(p.name);
  return out;
}

}  // namespace calomel
