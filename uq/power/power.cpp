#include "uq/power/power.hpp"

#include <algorithm>
#include <cmath>

#include "uq/diagnosis/held_out.hpp"

namespace calomel {

namespace {

constexpr int trials = 48;               ///< of strengths, evenly in the logarithm
constexpr double least_strength = 1e-3;  ///< of a number's range

/// One plan's records: the fit with the values of the others left out.
class Part {
 public:
  Part(const PosteriorFit& fit, const std::vector<std::size_t>& observations, const std::vector<Question>& questions)
      : Part(fit, rows_of(fit.errors->grid(), observations), questions) {}
  /// The evidence for question `asked` as records with number k of question `concealed` would give it.
  [[nodiscard]] FirstOrderModel::Expected expected(std::size_t concealed, Eigen::Index k, std::size_t asked) const {
    return model_->expected(blocks_[concealed], k, blocks_[asked]);
  }

 private:
  Part(const PosteriorFit& fit, const std::vector<Eigen::Index>& rows, const std::vector<Question>& questions)
      : posterior_(part_of(fit, fit.hypotheses, rows)), modes_(find_modes(posterior_, {fit.modes[0].q})) {
    if (modes_.empty()) throw NumericsError("no mode was found for a part of the planned records");
    model_.emplace(posterior_, modes_[0]);
    for (const auto& q : questions) blocks_.push_back(model_->block({Eigen::MatrixXd(q.directions.by_number(rows, Eigen::all)), q.directions.prior_sd}));
  }
  LogPosterior posterior_;
  std::vector<LocalMode> modes_;
  std::optional<FirstOrderModel> model_;
  std::vector<FirstOrderModel::Block> blocks_;
};

/// How far a number may be expected to go on a side, from off.
double reach_of(const AddedParameter& a, double direction) {
  const auto [least, greatest] = expected_range(a.parameter);
  return direction > 0 ? greatest - *a.parameter.nominal : *a.parameter.nominal - least;
}

}  // namespace

std::vector<PlanPower> power(const PosteriorFit& fit, const Problem& problem, const std::vector<ParameterGroup>& groups, const std::vector<Question>& questions,
                             const std::vector<Plan>& plans, const Gates& gates) {
  std::vector<PlanPower> out;
  for (const auto& plan : plans) {
    const Part part(fit, plan.observations, questions);
    PlanPower p{.plan = plan};
    for (std::size_t q = 0; q < questions.size(); ++q) {
      const Question& question = questions[q];
      const ParameterGroup& group = groups[question.group];
      const bool recorded = !question.sensor || std::any_of(plan.observations.begin(), plan.observations.end(),
                                                            [&](auto i) { return problem.observations[i].sensor == *question.sensor; });
      if (group.numerical || group.part || !recorded) continue;
      for (std::size_t i = 0; i < question.numbers.size(); ++i) {
        const AddedParameter& a = group.added[question.numbers[i]];
        const double up = reach_of(a, 1), sign = up > 0 ? 1 : -1, range = up > 0 ? up : reach_of(a, -1),
                     prior_sd = question.directions.prior_sd[Eigen::Index(i)];
        const auto value = [&](double from_off) {  // of the case's number
          const double v = *a.parameter.nominal + sign * from_off;
          return a.inverse ? 1 / v : a.whole * v;
        };
        Detectable d{.mechanism = group.name,
                     .place = question.sensor ? problem.shape.sensors[*question.sensor] : group.place,
                     .of_gauge = question.sensor.has_value(),
                     .number = a.parameter.name,
                     .off = value(0),
                     .from = {},
                     .farthest = value(range),
                     .limited_by = {}};
        const auto own = part.expected(q, Eigen::Index(i), q);
        std::vector<std::pair<std::size_t, FirstOrderModel::Expected>> rivals;
        for (std::size_t r = 0; r < questions.size(); ++r)
          if (questions[r].group != question.group && groups[questions[r].group].name != group.name)
            rivals.emplace_back(r, part.expected(q, Eigen::Index(i), r));
        for (int trial = 0; trial <= trials && !d.from; ++trial) {
          const double strength = range * std::pow(least_strength, 1 - double(trial) / trials), deviations = strength / prior_sd,
                       log_b = own.log_bayes_factor(deviations);
          double next = 0;
          d.limited_by.clear();
          for (const auto& [r, expected] : rivals)
            if (const double b = expected.log_bayes_factor(deviations); b > next) next = b, d.limited_by = label(questions[r], groups, problem.shape);
          if (log_b >= gates.log_bayes_factor && log_b - next >= gates.lead) d.from = value(strength), d.share = strength / range;
          if (log_b < gates.log_bayes_factor) d.limited_by.clear();
        }
        p.numbers.push_back(std::move(d));
      }
    }
    // Over the numbers of the first plan: a further gauge has faults of its own, which are no gain.
    const auto& first = out.empty() ? p.numbers : out[0].numbers;
    for (const auto& d : first) {
      const auto here = std::find_if(p.numbers.begin(), p.numbers.end(), [&](const auto& n) { return n.number == d.number && n.place == d.place; });
      if (here != p.numbers.end()) p.gain += std::log(d.share / here->share) / double(first.size());
    }
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace calomel
