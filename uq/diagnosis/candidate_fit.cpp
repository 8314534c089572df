#include "uq/diagnosis/candidate_fit.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "inverse/posterior/multistart_least_squares.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr double reach = 1.0;           ///< half width of the first box of a number, over its distance from off to first order
constexpr double widths = 6;            ///< the same in standard deviations to first order
constexpr double least_width = 0.1;     ///< the same over the standard deviation of the number's prior
constexpr double farthest_shift = 0.7;  ///< shift of the base parameters' box by the first-order estimate, in its half widths, at most
constexpr int spare_of_cheap = 3;  ///< runs over coefficients to begin with where runs are cheap and a box is shrunk: with the base model's two, a box about
                                   ///< a law with a step shrinks to the wrong place
constexpr double zoom = 0.4;       ///< the second box over the first, at least
constexpr double box_in_deviations = 8;       ///< the second box in deviations of the answer; in narrower boxes the deviations come out too small
constexpr double rough = 2;                   ///< numerical noise of an emulator over the base model's, as variances, beyond which its evidence means little,
constexpr double rough_beside_errors = 0.02;  ///< if it is also beyond this over the records' errors
constexpr double sets_in = 0.02;              ///< a share has set in below off by this
// Numbers of the search for the fit of a model with cheap runs.
constexpr std::size_t design_runs = 8, design_runs_a_parameter = 8, descents = 2;
constexpr int iterations = 12;
constexpr double tolerance = 1e-5;
constexpr double start_width = 0.3;               ///< half width of a further start, over a number's range
constexpr int most_rounds = 16;                   ///< of the second box: most of them are a few runs about the answer
constexpr double steady = 3, steady_share = 0.1;  ///< change of a log Bayes factor in a round, absolute and relative, below which it is stable
constexpr int stable_enough = 2;                  ///< rounds in a row
constexpr double standing = 1;  ///< move of the mode in a round, in deviations, below which it is stable: an evidence may remain while the numbers still move

/// Log evidence of a fit under the errors of another, each on its own emulator.
double evidence(const PosteriorFit& fit, const PosteriorFit& errors) {
  if (&fit == &errors) return log_evidence(*fit.posterior, fit.modes[0]);
  const LogPosterior p = fit.under(errors.hypotheses);
  const auto modes = find_modes(p, {fit.modes[0].q});
  if (modes.empty()) throw NumericsError("no mode of a posterior was found under the errors of another");
  return log_evidence(p, modes[0]);
}

/// Makes the box reach back to the handbook where the handbook is narrower than the box, because a base fit without the physics has moved its parameters away
/// from it.
void reach_back(PosteriorInputs& in) {
  for (std::size_t k = 0; k < in.centre.size(); ++k) {
    const Parameter& p = in.parameters[k];
    const auto deviation = prior_deviation(p, in.centre[k]);
    if (!deviation) continue;
    const bool lognormal = p.prior == "lognormal";
    const double known = lognormal ? std::exp(*p.mu) : *p.mean,
                 sd = p.coordinate_width(lognormal ? *p.sigma * known : *p.sd, known);  // of the box's coordinate
    if (sd > in.half_width[k]) continue;
    const double from = p.coordinate(in.centre[k]), to = p.coordinate(known);
    const double middle = 0.5 * (from + to);
    in.half_width[k] = std::max(in.half_width[k], 0.5 * (std::abs(from - to) + in.half_width[k]));
    in.centre[k] = p.natural(middle);
  }
}

using RoundDone = std::function<void(const PosteriorRound&)>;

/// One side of a box.
struct Side {
  double centre = 0, half_width = 0;
};

/// The side of a number, about its estimate to first order. The half width is in its coordinate, as the box has it.
Side side_of(const AddedParameter& a, double estimate, double sd) {
  const Parameter& p = a.parameter;
  const double away = std::abs(p.coordinate(estimate) - p.coordinate(*p.nominal)), deviation = p.coordinate_width(sd, estimate);
  const double least = p.prior == "half_cauchy" ? 0.5 * a.strengths[0] : p.coordinate_width(least_width * Prior(p).scale(), estimate);
  return {estimate, std::max({reach * away, widths * deviation, least})};
}

/// The best of several fits of one candidate, and why the last one failed.
struct BestFit {
  std::optional<CandidateFit> fit;
  double log_bayes_factor = 0;
  std::exception_ptr failure;

  void offer(PosteriorInputs inputs, PosteriorFit made, double of_fit) {
    if (fit && !(of_fit > log_bayes_factor)) return;
    log_bayes_factor = of_fit;
    const bool stable = made.settled;
    fit.emplace(CandidateFit{.inputs = std::move(inputs), .fit = std::move(made), .stable = stable});
  }
  CandidateFit take() {
    if (!fit) std::rethrow_exception(failure);
    return std::move(*fit);
  }
};

/// Fits a model with cheap runs from the planned box and from one about the middle of the numbers' ranges, because a box shrinks about whatever mode it shows
/// first.
CandidateFit fit_from_two(const PosteriorInputs& planned, const PosteriorFit& base, const RoundDone& round_done) {
  BestFit best;
  for (const bool about_the_middle : {false, true}) {
    PosteriorInputs in = planned;
    for (std::size_t k = planned.known_dimension; k < in.parameters.size() && about_the_middle; ++k) {
      const Parameter& p = in.parameters[k];
      const auto [least, greatest] = expected_range(p);
      const double low = p.coordinate(least), high = p.coordinate(greatest);
      in.centre[k] = p.natural(0.5 * (low + high));
      in.half_width[k] = start_width * (high - low);
    }
    try {
      PosteriorFit fit = fit_posterior(in, {.round_done = round_done, .go_on = {}});
      const double of_fit = log_bayes_factor(fit, base);
      best.offer(std::move(in), std::move(fit), of_fit);
    } catch (const NumericsError&) {
      best.failure = std::current_exception();
    }
  }
  return best.take();
}

/// Fits a model with cheap runs itself first, from the planned box, from the fit without the numbers and from a design; the emulator's box is placed about the
/// best. That is done with the records' errors alone and, where the likeliest errors of the base fit have a discrepancy, with those: the errors of records far
/// better than the model contain little information on where it fits best. The better fit counts.
CandidateFit fit_by_least_squares(const PosteriorInputs& planned, const PosteriorFit& base, const std::function<bool(std::optional<double>)>& wanted,
                                  const RoundDone& round_done) {
  MultistartOptions search{.design_runs = design_runs,
                           .design_runs_a_parameter = design_runs_a_parameter,
                           .descents = descents,
                           .iterations = iterations,
                           .tolerance = tolerance,
                           .starts = {planned.centre}};
  std::vector<double> off = base.modes[0].at.theta;
  for (std::size_t k = off.size(); k < planned.parameters.size(); ++k) off.push_back(*planned.parameters[k].nominal);
  search.starts.push_back(std::move(off));
  const WeightedErrors& likeliest = base.likeliest();
  std::vector<const ErrorModel*> errors{nullptr};
  if (likeliest.discrepancy > 0) errors.push_back(&likeliest.errors);
  BestFit best;
  for (const ErrorModel* e : errors) {
    PosteriorInputs in = planned;
    search.errors = e;
    try {
      place_box_by_least_squares(in, search);
      const auto go_on = [&](const PosteriorFit& f) { return wanted(log_bayes_factor(f, base)); };
      PosteriorFit fit = held_to_the_model(in, fit_posterior(in, {.round_done = round_done, .go_on = go_on}));
      const double of_fit = log_bayes_factor(fit, base);
      best.offer(std::move(in), std::move(fit), of_fit);
    } catch (const NumericsError&) {
      best.failure = std::current_exception();
    }
  }
  return best.take();
}

}  // namespace

CandidatePlan plan_candidate(const PosteriorInputs& inputs, const PosteriorFit& fit, const ParameterGroup& group, const ScreenedCandidate& screened) {
  CandidatePlan plan{.added = {}, .inputs = inputs};
  PosteriorInputs& in = plan.inputs;
  const std::size_t n = in.parameters.size();
  const FirstOrderEstimate& estimate = screened.first_order;
  std::vector<Side> sides;
  for (std::size_t i = 0; i < screened.numbers.size(); ++i) {
    const AddedParameter& a = group.added[screened.numbers[i]];
    const auto k = Eigen::Index(i);
    plan.added.push_back(a);
    sides.push_back(side_of(a, std::clamp(*a.parameter.nominal + estimate.value[k], a.parameter.min, a.parameter.max), estimate.sd[k]));
  }
  for (std::size_t i = 0; i < group.shapes.size(); ++i) {  // about the value with the greatest evidence
    plan.added.push_back(group.shapes[i]);
    const Parameter& p = group.shapes[i].parameter;
    sides.push_back({screened.shapes[i], p.sigma ? *p.sigma
                                         : p.sd  ? p.coordinate_width(*p.sd, screened.shapes[i])
                                                 : 0.5 * (p.coordinate(p.max) - p.coordinate(p.min))});
  }
  Eigen::VectorXd u = fit.modes[0].at.u;
  const auto& free = fit.posterior->free();
  for (std::size_t i = 0; i < free.size(); ++i) u[free[i]] += std::clamp(estimate.shift[Eigen::Index(i)], -farthest_shift, farthest_shift);
  in.centre = fit.posterior->box().theta(u);
  reach_back(in);
  for (std::size_t i = 0; i < plan.added.size(); ++i) {
    in.parameters.push_back(plan.added[i].parameter);
    if (Parameter& p = in.parameters.back(); !plan.added[i].share_of.empty()) {
      p.max = *p.nominal - sets_in;
      p.nominal.reset();  // the base model's runs lie beyond the step
    }
    in.centre.push_back(sides[i].centre);
    in.half_width.push_back(sides[i].half_width);
  }
  const auto d = Eigen::Index(in.parameters.size());
  in.emulator.coarse_runs = 0;  // by its own number of coefficients
  in.emulator.fine_runs = in.box.shrinks() ? spare_of_cheap * int(MultilevelRegression::coefficients(d, 1)) : 0;
  in.emulator.round_coarse = std::max<int>(in.emulator.round_coarse, 3 * int(d));
  in.known.clear();
  for (const auto& r : fit.runs) {
    TrainingRun known = r;
    for (const auto& a : plan.added) known.theta.push_back(*a.parameter.nominal);
    in.known.push_back(std::move(known));
  }
  in.known_dimension = n;
  return plan;
}

int first_runs(const CandidatePlan& plan) {
  const PosteriorInputs& in = plan.inputs;
  const auto d = Eigen::Index(in.parameters.size());
  const int coarse = in.emulator.coarser_to_begin(d), fine = in.finest_to_begin(d);
  return (in.levels - 1) * (coarse - in.stood_for(coarse, false)) + fine - in.stood_for(fine, in.levels > 1);
}

EvidenceByScale evidence_by_scale(const LogPosterior& posterior, const LocalMode& m, const std::vector<WeightedErrors>& hypotheses, double plus) {
  const double whole = log_evidence(posterior, m);
  std::map<double, std::vector<std::size_t>> parts;
  for (std::size_t j = 0; j < hypotheses.size(); ++j) parts[hypotheses[j].discrepancy].push_back(j);
  EvidenceByScale all;
  for (const auto& [scale, part] : parts) {
    double weight = 0;
    for (const auto j : part) weight += std::exp(hypotheses[j].log_weight);
    const LogPosterior p = posterior.part(part);
    const auto modes = find_modes(p, {p.q(m.at.theta, m.at.beyond)});
    all.push_back({scale, weight, modes.empty() ? -std::numeric_limits<double>::infinity() : plus + log_evidence(p, modes[0]) - whole});
  }
  return all;
}

double log_bayes_factor(const PosteriorFit& fit, const PosteriorFit& base) {
  return std::min(evidence(fit, fit) - evidence(base, fit), evidence(fit, base) - evidence(base, base));
}

CandidateFit fit_candidate(CandidatePlan plan, const PosteriorFit& base, const std::function<bool(std::optional<double>)>& wanted,
                           const RoundDone& round_done) {
  PosteriorInputs& in = plan.inputs;
  if (in.box.shrinks()) return in.box.by_least_squares() ? fit_by_least_squares(in, base, wanted, round_done) : fit_from_two(in, base, round_done);
  const std::size_t own = in.known_dimension;
  const auto is_rough = [&](const PosteriorFit& f) {
    return f.noise.trace() > std::max(rough * base.noise.trace(), rough_beside_errors * f.errors->covariance().trace());
  };
  PosteriorFit fit = fit_posterior(in, {.round_done = round_done, .go_on = [](const PosteriorFit& f) { return f.rounds.size() == 1; }});
  double last = log_bayes_factor(fit, base);
  if (!wanted(is_rough(fit) ? std::nullopt : std::optional(last))) return {.inputs = std::move(in), .fit = std::move(fit)};
  // Again about the answer: over a wide box a quadratic is only so good.
  const LocalMode& mode = fit.modes[0];
  const Eigen::VectorXd sd = mode.covariance.diagonal().cwiseSqrt();
  in.centre = mode.at.theta;
  for (std::size_t k = 0; k < in.half_width.size(); ++k)
    if (k < own || plan.added[k - own].share_of.empty())  // the effect of a share is nearly the same over all its range
      in.half_width[k] *= k >= own && is_rough(fit) ? zoom : std::clamp(box_in_deviations * sd[Eigen::Index(k)], zoom, 1.0);
  in.box.clear_of_edge = 1;  // a box that is placed again whenever a moving mode comes near an edge would lose the runs that make the mode stable
  in.known = std::move(fit.runs);
  in.known_dimension = in.parameters.size();
  int stable_rounds = 0;
  const auto go_on = [&](const PosteriorFit& f) {
    if (is_rough(f)) return f.rounds.size() == 1 && wanted({});
    const double now = log_bayes_factor(f, base);
    const bool stable = std::abs(now - last) < std::max(steady, steady_share * std::abs(now)) && f.rounds.back().moved < standing;
    stable_rounds = stable ? stable_rounds + 1 : 0;
    last = now;
    return int(f.rounds.size()) <= most_rounds && stable_rounds < stable_enough && wanted(now);
  };
  PosteriorFit second = fit_posterior(in, {.round_done = round_done, .go_on = go_on});
  const bool stable = stable_rounds >= stable_enough || second.settled;
  return {.inputs = std::move(in), .fit = std::move(second), .stable = stable};
}

}  // namespace calomel
