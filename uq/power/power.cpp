#include "uq/power/power.hpp"

#include <algorithm>
#include <cmath>

#include "uq/diagnosis/held_out.hpp"

namespace calomel {

namespace {

constexpr int trials = 48;               ///< strengths, evenly spaced in the logarithm
constexpr double least_strength = 1e-3;  ///< over a number's range

/// The fit to one plan's records: the values of the other plans are left out.
class PlanFit {
 public:
  PlanFit(const PosteriorFit& fit, const std::vector<std::size_t>& observations, const std::vector<ScreenedCandidate>& screened)
      : PlanFit(fit, rows_of(fit.errors->grid(), observations), screened) {}
  /// Expected evidence of candidate `of` where the records conceal number k of candidate `concealed`.
  [[nodiscard]] FirstOrderModel::Expected expected(std::size_t concealed, Eigen::Index k, std::size_t of) const {
    return model_->expected(blocks_[concealed], k, blocks_[of]);
  }

 private:
  PlanFit(const PosteriorFit& fit, const std::vector<Eigen::Index>& rows, const std::vector<ScreenedCandidate>& screened)
      : posterior_(part_of(fit, fit.hypotheses, rows)), modes_(find_modes(posterior_, {fit.modes[0].q})) {
    if (modes_.empty()) throw NumericsError("no mode was found for a part of the planned records");
    model_.emplace(posterior_, modes_[0]);
    for (const auto& c : screened) blocks_.push_back(model_->block({Eigen::MatrixXd(c.directions.by_number(rows, Eigen::all)), c.directions.prior_sd}));
  }
  LogPosterior posterior_;
  std::vector<LocalMode> modes_;
  std::optional<FirstOrderModel> model_;
  std::vector<FirstOrderModel::Block> blocks_;
};

/// Greatest expected distance of a number from off, on one side.
double reach_of(const AddedParameter& a, double direction) {
  const auto [least, greatest] = expected_range(a.parameter);
  return direction > 0 ? greatest - *a.parameter.nominal : *a.parameter.nominal - least;
}

/// One power study; what is referred to outlives it.
struct PowerStudy {
  const Problem& problem;
  const std::vector<ParameterGroup>& groups;
  const std::vector<ScreenedCandidate>& screened;
  const Gates& gates;

  [[nodiscard]] bool counts(const ScreenedCandidate& candidate, const Plan& plan) const {
    const ParameterGroup& group = groups[candidate.group];
    if (group.numerical || group.part) return false;
    return !candidate.sensor ||
           std::any_of(plan.observations.begin(), plan.observations.end(), [&](auto i) { return problem.observations[i].sensor == *candidate.sensor; });
  }

  /// The strength from which on number i of candidate c would be named.
  [[nodiscard]] Detectable detectable(const PlanFit& fit, std::size_t c, std::size_t i) const {
    const ScreenedCandidate& candidate = screened[c];
    const ParameterGroup& group = groups[candidate.group];
    const AddedParameter& a = group.added[candidate.numbers[i]];
    const auto k = Eigen::Index(i);
    const double up = reach_of(a, 1), sign = up > 0 ? 1 : -1, range = up > 0 ? up : reach_of(a, -1);
    const double prior_sd = candidate.directions.prior_sd[k];
    const auto value = [&](double from_off) {  // of the case's number
      const double v = *a.parameter.nominal + sign * from_off;
      return a.inverse ? 1 / v : a.whole * v;
    };
    Detectable d{.mechanism = group.name,
                 .place = candidate.sensor ? problem.shape.sensors[*candidate.sensor] : group.place,
                 .of_gauge = candidate.sensor.has_value(),
                 .number = a.parameter.name,
                 .off = value(0),
                 .from = {},
                 .farthest = value(range),
                 .limited_by = {}};
    const auto own = fit.expected(c, k, c);
    std::vector<std::pair<std::size_t, FirstOrderModel::Expected>> competitors;
    for (std::size_t r = 0; r < screened.size(); ++r)
      if (screened[r].group != candidate.group && groups[screened[r].group].name != group.name) competitors.emplace_back(r, fit.expected(c, k, r));
    for (int trial = 0; trial <= trials && !d.from; ++trial) {
      const double strength = range * std::pow(least_strength, 1 - double(trial) / trials), deviations = strength / prior_sd;
      const double log_b = own.log_bayes_factor(deviations);
      double next = 0;
      d.limited_by.clear();
      for (const auto& [r, expected] : competitors)
        if (const double b = expected.log_bayes_factor(deviations); b > next) {
          next = b;
          d.limited_by = label(screened[r], groups, problem.shape);
        }
      if (log_b >= gates.log_bayes_factor && log_b - next >= gates.lead) {
        d.from = value(strength);
        d.share = strength / range;
      }
      if (log_b < gates.log_bayes_factor) d.limited_by.clear();
    }
    return d;
  }
};

/// The gain of a plan over the numbers of the first one: a further gauge has faults of its own, which are no gain.
double gain_over(const std::vector<Detectable>& first, const std::vector<Detectable>& here) {
  double gain = 0;
  for (const auto& d : first) {
    const auto at = std::find_if(here.begin(), here.end(), [&](const auto& n) { return n.number == d.number && n.place == d.place; });
    if (at != here.end()) gain += std::log(d.share / at->share) / double(first.size());
  }
  return gain;
}

}  // namespace

std::vector<PlanPower> power(const PosteriorFit& fit, const Problem& problem, const std::vector<ParameterGroup>& groups,
                             const std::vector<ScreenedCandidate>& screened, const std::vector<Plan>& plans, const Gates& gates) {
  const PowerStudy study{.problem = problem, .groups = groups, .screened = screened, .gates = gates};
  std::vector<PlanPower> out;
  for (const auto& plan : plans) {
    const PlanFit plan_fit(fit, plan.observations, screened);
    PlanPower p{.plan = plan};
    for (std::size_t c = 0; c < screened.size(); ++c) {
      if (!study.counts(screened[c], plan)) continue;
      for (std::size_t i = 0; i < screened[c].numbers.size(); ++i) p.numbers.push_back(study.detectable(plan_fit, c, i));
    }
    p.gain = gain_over(out.empty() ? p.numbers : out[0].numbers, p.numbers);
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace calomel
