#include "uq/diagnosis/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double rounding = 1e-5;      ///< of the histories: an effect smaller than this is none
constexpr double reach = 1.5;          ///< of the first box of a candidate's number, over its first-order estimate
constexpr double least_width = 0.1;    ///< half width of that box, over the number's range
constexpr double worth_fitting = 0;    ///< log Bayes factor to first order
constexpr int first_rounds = 1;        ///< of infill, before a candidate is given up
constexpr double hopeless = 60;        ///< log Bayes factors below the best so far
constexpr double alike = 4;            ///< distance in standard deviations below which two explanations are one class

/// What a number does at one strength.
struct Effect {
  std::size_t group, number;  ///< indices
  double strength;
  Eigen::VectorXd change;     ///< (values) per unit
};

/// A group, or a gauge's own part of one, with one strength of each number.
struct Asked {
  std::string name;
  std::size_t group;
  std::optional<std::size_t> sensor;
  std::vector<std::size_t> numbers;  ///< indices into the group
  AddedDirections directions;
  FirstOrder worth;
  double p_value = 1;
};

double prior_sd(const AddedParameter& a, double strength) {
  return a.parameter.prior == "half_cauchy" ? strength : Prior(a.parameter).scale();
}

/// Distance of a value from the middle of its prior in standard deviations; half-Cauchy by the normal deviate of the same tail.
double plausibility(const AddedParameter& a, double value) {
  if (a.parameter.prior == "half_cauchy") return value > a.parameter.max ? std::numeric_limits<double>::infinity() : std::log(1 + value / *a.parameter.scale) / std::log(10.0);
  const double nominal = *a.parameter.nominal, far = value > nominal ? a.parameter.max - nominal : nominal - a.parameter.min;
  return far > 0 ? 2 * std::abs(value - nominal) / far : 0;  // the range is taken for two standard deviations
}

/// Of a number at a value that the fit has; in the case's unit where that is its inverse.
Estimate estimate_of(const AddedParameter& a, double value, double sd, const std::string& sensor = "") {
  const std::string name = (sensor.empty() ? "" : sensor + '.') + a.parameter.name;
  return a.inverse ? Estimate{name, 1 / value, sd / (value * value)} : Estimate{name, value, sd};
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
    std::tie(out_.base_history, out_.base_true_model_shift) = at_mode(out_.base, base);
    say("score tests");
    ask();
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
    auto records = in_.run(thetas, level, added);
    for (std::size_t i = 0; i < level.size(); ++i) {
      std::string key = std::to_string(level[i]);
      for (Eigen::Index k = 0; k < thetas.rows(); ++k)
        if (std::size_t(k) < in_.base.parameters.size() || thetas(k, Eigen::Index(i)) != *added[std::size_t(k) - in_.base.parameters.size()].parameter.nominal)
          key += fmt::format(" {}:{}", k, thetas(k, Eigen::Index(i)));
      for (const auto& a : added) key += ' ' + a.parameter.name;
      seen_.insert(key);
    }
    runs_ = int(seen_.size());
    return records;
  }
  /// chi-squared of a fit without any discrepancy at the mode of the posterior with it.
  [[nodiscard]] static double plain_chi2(const PosteriorFit& fit, const LogPosterior& posterior, const LocalMode& m, const ErrorModel& errors) {
    const auto density = posterior.density(m.at);
    const Eigen::VectorXd r = errors.data() - fit.coefficients * posterior.emulator().features(m.at.u, m.at.beyond);
    return Cholesky(errors.covariance() + density.variance * fit.noise).solve_lower(r).squaredNorm();
  }
  /// Root mean square distance of the case's own parameters from the middle of their priors, in standard deviations.
  [[nodiscard]] std::vector<double> pulls(std::span<const double> theta) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < own_; ++k) {
      const Parameter& p = in_.base.parameters[k];
      if (p.prior == "normal" || p.prior == "truncated_normal") all.push_back((theta[k] - *p.mean) / *p.sd);
      else if (p.prior == "lognormal") all.push_back((std::log(theta[k]) - *p.mu) / *p.sigma);
      else all.push_back(0);
    }
    return all;
  }
  [[nodiscard]] static double root_mean_square(const std::vector<double>& x) {
    double sum = 0;
    for (const double v : x) sum += v * v;
    return x.empty() ? 0 : std::sqrt(sum / double(x.size()));
  }
  [[nodiscard]] std::vector<Estimate> own_parameters(const PosteriorFit& fit, const LogPosterior& posterior, const LocalMode& m) const {
    const Eigen::VectorXd sd = parameter_covariance(posterior, m).diagonal().cwiseSqrt();
    std::vector<Estimate> all;
    for (std::size_t i = 0; i < posterior.free().size(); ++i) {
      const auto k = std::size_t(posterior.free()[i]);
      if (k < own_) all.push_back({in_.base.parameters[k].name, m.at.theta[k], sd[Eigen::Index(i)]});
    }
    (void)fit;
    return all;
  }

  /// The history at a fit's mode: the model's own where its runs cost little, with the log likelihood by it less that by the emulator; else the emulator's.
  [[nodiscard]] static std::pair<std::vector<double>, double> at_mode(const PosteriorFit& fit, const PosteriorInputs& in) {
    const LocalMode& m = fit.modes[0];
    Eigen::VectorXd history = fit.history(m.at.u, m.at.beyond);
    double shift = 0;
    if (in.draw_in) {
      const RunRecord run = in.run(Eigen::Map<const Eigen::MatrixXd>(m.at.theta.data(), Eigen::Index(m.at.theta.size()), 1), {0})[0];
      if (!run.done) throw NumericsError("the model fails at the mode of its emulator: " + run.message);
      const LogPosterior& p = *fit.posterior;
      const double variance = p.emulator().variance(p.emulator().features(m.at.u, m.at.beyond));
      history = run.history();
      shift = p.log_likelihood_of(fit.errors->grid().apply(history), variance) - p.log_likelihood_of(fit.coefficients * p.emulator().features(m.at.u, m.at.beyond), variance);
    }
    return {{history.begin(), history.end()}, shift};
  }

  [[nodiscard]] double best_so_far() const {
    double best = 0;
    for (const auto& c : out_.candidates) best = std::max(best, c.explanation.log_bayes_factor);
    return best;
  }
  void describe_base();
  void ask();
  void fit_linear();
  void fit_linear(const Asked& q);
  void fit_leaders();
  void fit_pair();
  void fit(const std::vector<const Asked*>& with);
  void judge_all();
  void hold_out();
  void locate_all();
  void separate();
  [[nodiscard]] std::vector<AddedParameter> union_of_groups() const;

  const DiagnosisInputs& in_;
  const std::size_t own_;  ///< the case's own parameters
  Diagnosis out_;
  Eigen::MatrixXd places_;
  std::vector<Asked> asked_;              ///< the most promising of each group and gauge, best first
  std::map<std::string, PosteriorFit> fits_;  ///< of candidates by name
  std::map<std::string, std::vector<std::pair<Eigen::Index, double>>> held_;
  std::set<std::string> seen_;  ///< runs by their numbers
  int runs_ = 0;                ///< of them
};

void Engine::describe_base() {
  const LocalMode& m = mode();
  const LogPosterior& posterior = *out_.base.posterior;
  out_.base_parameters = own_parameters(out_.base, posterior, m);
  out_.handbook_pulls = pulls(m.at.theta);
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
    const LogPosterior p(posterior.box(), posterior.emulator(), out_.base.coefficients, part, out_.base.noise, posterior.priors(), posterior.beyond_prior());
    const auto modes = find_modes(p, {p.q(m.at.theta, m.at.beyond)});
    return modes.empty() ? -std::numeric_limits<double>::infinity() : log_evidence(p, modes[0]);
  };
  const double whole = log_evidence(posterior, m);
  e.log_plain = evidence_of(none) - whole, e.log_discrepancy = evidence_of(some) - whole;
}

std::vector<AddedParameter> Engine::union_of_groups() const {
  std::vector<AddedParameter> all;
  for (const auto& g : in_.groups) all.insert(all.end(), g.added.begin(), g.added.end());
  return all;
}

/// Runs every number of every group at its first strengths, on the next to finest mesh at the base mode, and asks what each group is worth.
void Engine::ask() {
  const auto added = union_of_groups();
  const auto& theta = mode().at.theta;
  const int level = in_.base.levels > 1 ? 1 : 0;
  std::vector<Effect> effects;
  std::vector<Eigen::VectorXd> columns;
  Eigen::VectorXd off(Eigen::Index(theta.size() + added.size()));
  for (std::size_t k = 0; k < theta.size(); ++k) off[Eigen::Index(k)] = theta[k];
  for (std::size_t k = 0; k < added.size(); ++k) off[Eigen::Index(theta.size() + k)] = *added[k].parameter.nominal;
  columns.push_back(off);
  std::size_t at = theta.size();
  for (std::size_t g = 0; g < in_.groups.size(); ++g)
    for (std::size_t k = 0; k < in_.groups[g].added.size(); ++k, ++at)
      for (const double strength : in_.groups[g].added[k].strengths) {
        if (in_.groups[g].linear) continue;
        columns.push_back(off);
        columns.back()[Eigen::Index(at)] = strength;
        effects.push_back({g, k, strength, {}});
      }
  Eigen::MatrixXd thetas(off.size(), Eigen::Index(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) thetas.col(Eigen::Index(i)) = columns[i];
  const auto records = counted(thetas, std::vector<int>(columns.size(), level), added);
  if (!records[0].done) throw NumericsError("the base model fails at its own mode: " + records[0].message);
  const Eigen::VectorXd zero = records[0].history();
  std::vector<Effect> seen;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const auto& a = in_.groups[effects[i].group].added[effects[i].number];
    if (!records[i + 1].done) {
      const std::string& place = in_.groups[effects[i].group].place;
      out_.skipped.push_back(fmt::format("{}{} = {:.4g}: {}", a.parameter.name, place.empty() ? "" : " (" + place + ")", effects[i].strength, records[i + 1].message));
      continue;
    }
    const Eigen::VectorXd change = records[i + 1].history() - zero;
    if (!(change.norm() > rounding * zero.norm())) continue;
    effects[i].change = change / (effects[i].strength - *a.parameter.nominal);
    seen.push_back(std::move(effects[i]));
  }

  // One question a group for each choice of strengths: either way from off is one choice, the strengths of a log-uniform number are three.
  const ModelShape& shape = in_.base.problem.shape;
  std::vector<Asked> all;
  for (std::size_t g = 0; g < in_.groups.size(); ++g) {
    const ParameterGroup& group = in_.groups[g];
    std::size_t choices = 0;
    for (const auto& a : group.added) choices = std::max(choices, a.strengths.size());
    for (std::size_t choice = 0; choice < choices; ++choice) {
      Asked q{.name = group.name, .group = g};
      std::vector<const Effect*> taken;
      for (std::size_t k = 0; k < group.added.size(); ++k) {
        const auto& strengths = group.added[k].strengths;
        if (strengths.empty()) continue;
        const double wanted = strengths[std::min(choice, strengths.size() - 1)];
        for (const auto& e : seen)
          if (e.group == g && e.number == k && e.strength == wanted) taken.push_back(&e), q.numbers.push_back(k);
      }
      if (taken.empty()) continue;
      const auto question = [&](std::optional<std::size_t> sensor) {
        Asked one = q;
        one.sensor = sensor;
        one.directions.by_number.resize(zero.size(), Eigen::Index(taken.size()));
        one.directions.prior_sd.resize(Eigen::Index(taken.size()));
        for (std::size_t i = 0; i < taken.size(); ++i) {
          Eigen::VectorXd change = taken[i]->change;
          if (sensor)
            for (std::size_t c = 0; c < shape.conditions.size(); ++c)
              for (std::size_t s = 0; s < shape.sensors.size(); ++s)
                if (s != *sensor) change.segment(Eigen::Index(shape.at(c, s, 0)), Eigen::Index(shape.times.size())).setZero();
          one.directions.by_number.col(Eigen::Index(i)) = change;
          one.directions.prior_sd[Eigen::Index(i)] = prior_sd(group.added[taken[i]->number], taken[i]->strength);
        }
        one.worth = first_order(*out_.base.posterior, mode(), grid(), one.directions);
        all.push_back(std::move(one));
      };
      if (!group.by_sensor) question({});
      else
        for (std::size_t s = 0; s < shape.sensors.size(); ++s) question(s);
    }
  }
  if (in_.linear)
    for (const auto& m : in_.linear(theta)) {
      const auto of = std::find_if(in_.groups.begin(), in_.groups.end(), [&](const auto& g) { return g.linear && g.name == m.name; });
      if (of == in_.groups.end()) continue;
      Asked q{.name = m.name, .group = std::size_t(of - in_.groups.begin())};
      q.directions.by_number = m.directions;
      q.directions.prior_sd.resize(m.directions.cols());
      for (std::size_t i = 0; i < m.keys.size(); ++i) {
        const auto a = std::find_if(of->added.begin(), of->added.end(), [&](const auto& x) { return x.parameter.name == m.name + '.' + m.keys[i]; });
        expect(a != of->added.end(), "a direction is of one of the group's numbers");
        q.numbers.push_back(std::size_t(a - of->added.begin()));
        q.directions.prior_sd[Eigen::Index(i)] = prior_sd(*a, 1);
      }
      q.worth = first_order(*out_.base.posterior, mode(), grid(), q.directions);
      all.push_back(std::move(q));
    }
  // The best question of each group and gauge, and its score test.
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.worth.log_bayes_factor > b.worth.log_bayes_factor; });
  std::vector<MechanismDirections> tests;
  for (auto& q : all) {
    const bool known = std::any_of(asked_.begin(), asked_.end(), [&](const Asked& a) { return a.group == q.group && a.sensor == q.sensor; });
    if (known) continue;
    MechanismDirections t{.name = std::to_string(asked_.size()), .directions = q.directions.by_number};
    for (const std::size_t k : q.numbers) t.keys.push_back(in_.groups[q.group].added[k].parameter.name), t.off.push_back(0);
    tests.push_back(std::move(t));
    asked_.push_back(std::move(q));
  }
  const auto tested = score_tests(*out_.base.posterior, mode().at, grid(), tests, out_.base.posterior->emulator().residuals(grid().apply(out_.base.histories())));
  for (const auto& t : tested.mechanisms) asked_[std::size_t(std::stoul(t.name))].p_value = t.p_value;
  for (const auto& q : asked_) {
    const std::string& place = in_.groups[q.group].place;
    const std::string where = q.sensor ? " of " + shape.sensors[*q.sensor] : place.empty() ? "" : " (" + place + ")";
    if (q.worth.log_bayes_factor > worth_fitting) say(fmt::format("{}{}: log Bayes factor {:.3g} to first order, p {:.2g}", q.name, where, q.worth.log_bayes_factor, q.p_value));
  }
}

/// The worst gauge and the linear groups: what they do is linear in their numbers, so that these are one more term of the errors and need no runs.
void Engine::fit_linear() {
  const auto worst = std::find_if(asked_.begin(), asked_.end(), [](const Asked& q) { return q.sensor.has_value(); });
  if (worst != asked_.end()) fit_linear(*worst);
  for (const auto& q : asked_)
    if (in_.groups[q.group].linear) fit_linear(q);
}

void Engine::fit_linear(const Asked& q) {
  const ParameterGroup& group = in_.groups[q.group];
  const LogPosterior& base = *out_.base.posterior;
  Alternative c{.groups = {group.name}, .sensor = q.sensor ? in_.base.problem.shape.sensors[*q.sensor] : "", .first_log_bayes_factor = q.worth.log_bayes_factor, .p_value = q.p_value};
  c.explanation.name = group.name;
  const Eigen::MatrixXd d = grid().apply(q.directions.by_number) * q.directions.prior_sd.asDiagonal();
  const ErrorTerm term{group.name, d * d.transpose()};
  std::vector<WeightedErrors> errors;
  for (const auto& h : out_.base.hypotheses) errors.push_back({h.errors.with(term), h.log_weight, h.discrepancy});
  const LogPosterior with(base.box(), base.emulator(), out_.base.coefficients, errors, out_.base.noise, base.priors(), base.beyond_prior());
  const auto modes = find_modes(with, {with.q(mode().at.theta, mode().at.beyond)});
  if (modes.empty()) return;
  const LocalMode& m = modes[0];
  c.explanation.fitted = true;
  c.explanation.log_bayes_factor = log_evidence(with, m) - log_evidence(base, mode()) - (q.sensor ? std::log(double(in_.base.problem.observations.size())) : 0);  // any gauge might have been the one
  c.explanation.chi2 = plain_chi2(out_.base, with, m, out_.base.errors->with(term));
  c.explanation.base_pull = root_mean_square(pulls(m.at.theta));
  c.base_parameters = own_parameters(out_.base, with, m);
  // The numbers themselves: what is left of the residual at this mode in their directions.
  LocalMode there = m;
  const FirstOrder worth = first_order(base, there, grid(), q.directions);
  Eigen::VectorXd history = out_.base.history(m.at.u, m.at.beyond);
  for (std::size_t i = 0; i < q.numbers.size(); ++i) {
    const AddedParameter& a = group.added[q.numbers[i]];
    const double value = *a.parameter.nominal + worth.value[Eigen::Index(i)];
    c.numbers.push_back(estimate_of(a, value, worth.sd[Eigen::Index(i)], c.sensor));
    c.explanation.farthest = std::max(c.explanation.farthest, plausibility(a, value));
  }
  history += q.directions.by_number * worth.value;
  c.history.assign(history.begin(), history.end());
  out_.candidates.push_back(std::move(c));
}

void Engine::fit_leaders() {
  int fitted = 0;
  for (const auto& q : asked_) {
    const bool there = std::any_of(out_.candidates.begin(), out_.candidates.end(), [&](const auto& c) { return c.explanation.name == q.name; });
    if (q.sensor || there) continue;  // a wall that says less, too
    Alternative c{.groups = {q.name}, .first_log_bayes_factor = q.worth.log_bayes_factor, .p_value = q.p_value};
    if (fitted < in_.options.leaders && (q.worth.log_bayes_factor > worth_fitting || fitted == 0 || in_.base.draw_in)) {
      fit({&q});
      ++fitted;
      continue;
    }
    c.explanation = {.name = q.name, .numerical = in_.groups[q.group].numerical, .log_bayes_factor = std::min(0.0, q.worth.log_bayes_factor), .chi2 = out_.evidence.chi2, .base_pull = out_.evidence.base_pull};
    for (std::size_t i = 0; i < q.numbers.size(); ++i) {
      const auto& a = in_.groups[q.group].added[q.numbers[i]];
      c.numbers.push_back(estimate_of(a, *a.parameter.nominal + q.worth.value[Eigen::Index(i)], q.worth.sd[Eigen::Index(i)]));
    }
    c.message = "to first order";
    out_.candidates.push_back(std::move(c));
  }
}

/// The base model with the numbers of one or two groups beside its own parameters, on one emulator and under the same errors with and without them.
void Engine::fit(const std::vector<const Asked*>& with) {
  Alternative c;
  std::vector<AddedParameter> added;
  std::vector<double> estimate;
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(out_.base.posterior->dimension());
  std::vector<std::string> names;
  for (const Asked* q : with) {
    const ParameterGroup& group = in_.groups[q->group];
    names.push_back(q->name), c.groups.push_back(q->name);
    c.explanation.numerical |= group.numerical;
    c.first_log_bayes_factor += q->worth.log_bayes_factor, c.p_value = std::min(c.p_value, q->p_value);
    for (std::size_t i = 0; i < q->numbers.size(); ++i) {
      const AddedParameter& a = group.added[q->numbers[i]];
      added.push_back(a);
      estimate.push_back(std::clamp(*a.parameter.nominal + q->worth.value[Eigen::Index(i)], a.parameter.min, a.parameter.max));
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
  in.round_done = {};
  Eigen::VectorXd u = mode().at.u;
  for (std::size_t i = 0; i < out_.base.posterior->free().size(); ++i) u[out_.base.posterior->free()[i]] += std::clamp(shift[Eigen::Index(i)], -0.7, 0.7);
  in.centre = out_.base.posterior->box().theta(u);
  // On one emulator with its off values, so that the numerical noise of its runs is common to both; where there is none each has its own, about its own mode.
  const bool apart = in_.base.draw_in;
  if (!apart) in.nested_centre = mode().at.theta;
  for (std::size_t i = 0; i < added.size(); ++i) {
    const Parameter& p = added[i].parameter;
    in.parameters.push_back(p);
    if (!apart) in.held.emplace_back(Eigen::Index(n + i), *p.nominal), in.nested_centre.push_back(*p.nominal);
    // The logarithm where the lower bound is positive, as the box has it.
    const auto coordinate = [&](double x) { return p.min > 0 ? std::log(x) : x; };
    const double range = coordinate(p.max) - coordinate(p.min), away = coordinate(estimate[i]) - coordinate(*p.nominal);
    in.centre.push_back(estimate[i]);
    in.half_width.push_back(p.prior == "half_cauchy" ? std::max(reach * std::abs(away), std::abs(added[i].strengths[0])) : std::max(reach * std::abs(away), least_width * range));
  }
  in.emulator.coarse_runs = std::max(in_.options.candidate_coarse, int(1.3 * double(MultilevelRegression::coefficients(Eigen::Index(n + added.size()), 1) - MultilevelRegression::coefficients(Eigen::Index(n), 1))));
  in.emulator.fine_runs = std::max<int>(in_.options.candidate_fine, int(added.size()) + 6);
  for (const auto& r : apart ? std::vector<TaughtRun>{} : out_.base.runs) {
    TaughtRun known = r;
    for (const auto& a : added) known.theta.push_back(*a.parameter.nominal);
    in.known.push_back(std::move(known));
  }
  const int before = runs_;
  try {
    const auto worth = [&](const PosteriorFit& f) {
      return log_evidence(*f.posterior, f.modes[0]) - (apart ? log_evidence(*out_.base.posterior, mode()) : log_evidence(*f.nested, f.nested_modes[0]));
    };
    if (!apart) in.emulator.rounds = std::min(in.emulator.rounds, first_rounds);
    PosteriorFit fitted = fit_posterior(in);
    // What may lead is followed until it settles; its runs are there.
    if (!apart && !fitted.settled && worth(fitted) > best_so_far() - hopeless && in_.base.emulator.rounds > first_rounds) {
      in.emulator.rounds = in_.base.emulator.rounds;
      fitted = fit_posterior(in);
    }
    const LocalMode& full = fitted.modes[0];
    const LogPosterior& posterior = *fitted.posterior;
    c.explanation.fitted = true;
    c.explanation.log_bayes_factor = worth(fitted);
    c.explanation.chi2 = plain_chi2(fitted, posterior, full, *fitted.errors);
    c.explanation.base_pull = root_mean_square(pulls(full.at.theta));
    c.base_parameters = own_parameters(fitted, posterior, full);
    const Eigen::VectorXd sd = parameter_covariance(posterior, full).diagonal().cwiseSqrt();
    for (std::size_t i = 0; i < added.size(); ++i) {
      c.numbers.push_back(estimate_of(added[i], full.at.theta[n + i], sd[Eigen::Index(n + i)]));
      c.explanation.farthest = std::max(c.explanation.farthest, plausibility(added[i], full.at.theta[n + i]));
    }
    std::tie(c.history, c.true_model_shift) = at_mode(fitted, in);
    c.message = fitted.message;
    held_[c.explanation.name] = in.held;
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
  std::vector<const Asked*> two;
  for (const auto& c : out_.candidates) {
    if (two.size() == 2 || c.explanation.numerical || !c.explanation.fitted || !c.sensor.empty()) continue;
    const auto at = std::find_if(asked_.begin(), asked_.end(), [&](const Asked& q) { return !q.sensor && q.name == c.groups[0]; });
    if (at != asked_.end() && c.groups.size() == 1) two.push_back(&*at);
  }
  if (two.size() < 2) return;
  fit(two);
  judge_all();
}

void Engine::hold_out() {
  const auto folds = folds_by_face(in_.base.problem, grid(), in_.base.positions);
  const Eigen::VectorXd& data = out_.base.errors->data();
  std::vector<double> before, base_evidence;
  for (const auto& f : folds) {
    const PartFit part = fit_without(out_.base, {}, f);
    before.push_back(misfit_of(f, grid(), part.prediction, data)), base_evidence.push_back(part.log_evidence);
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
      const PartFit part = fit_without(fit->second, held_[c.explanation.name], folds[i]);
      with.push_back(misfit_of(folds[i], grid(), part.prediction, data));
      c.held_out.push_back(before[i]), c.held_out.push_back(with.back());
      const double worth = part.log_evidence - (held_[c.explanation.name].empty() ? base_evidence[i] : part.nested_log_evidence);
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
