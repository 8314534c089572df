#include "uq/power/power.hpp"

#include <algorithm>
#include <cmath>

#include "uq/diagnosis/held_out.hpp"

namespace calomel {

namespace {

constexpr int trials = 48;              ///< of strengths, evenly in the logarithm
constexpr double least_strength = 1e-3; ///< of a number's range
constexpr double beyond = 2;            ///< of the range: what an unnameable number counts as

/// One plan's records: the fit with the values of the others left out.
class Part {
 public:
  Part(const PosteriorFit& fit, const std::vector<std::size_t>& observations, const std::vector<Question>& questions)
      : rows_(rows_of(fit.errors->grid(), observations)), posterior_(part_of(fit, fit, rows_)), modes_(find_modes(posterior_, {fit.modes[0].q})) {
    if (modes_.empty()) throw NumericsError("no mode was found for a part of the planned records");
    model_.emplace(posterior_, modes_[0]);
    for (const auto& q : questions) blocks_.push_back(model_->block({of_rows(q.directions.by_number), q.directions.prior_sd}));
  }
  /// The evidence for question `asked` as records with number k of question `true_one` would give it.
  [[nodiscard]] FirstOrderModel::Expected expected(const Question& true_one, Eigen::Index k, std::size_t asked) const {
    return model_->expected(of_rows(true_one.directions.by_number).col(k), blocks_[asked]);
  }

 private:
  [[nodiscard]] Eigen::MatrixXd of_rows(const Eigen::MatrixXd& m) const { return m(rows_, Eigen::all); }
  std::vector<Eigen::Index> rows_;
  LogPosterior posterior_;
  std::vector<LocalMode> modes_;
  std::optional<FirstOrderModel> model_;
  std::vector<FirstOrderModel::Block> blocks_;
};

/// How far a number may go on the side that its question asks, from off.
double reach_of(const AddedParameter& a, double direction) {
  const Parameter& p = a.parameter;
  return direction > 0 ? p.max - *p.nominal : *p.nominal - p.min;
}

}  // namespace

std::vector<PlanPower> power(const PosteriorFit& fit, const Problem& problem, const std::vector<ParameterGroup>& groups, const std::vector<Question>& questions, const std::vector<Plan>& plans,
                             const Gates& gates) {
  std::vector<PlanPower> out;
  for (const auto& plan : plans) {
    const Part part(fit, plan.observations, questions);
    PlanPower p{.plan = plan};
    for (std::size_t q = 0; q < questions.size(); ++q) {
      const Question& question = questions[q];
      const ParameterGroup& group = groups[question.group];
      if (group.numerical || group.part) continue;
      for (std::size_t i = 0; i < question.numbers.size(); ++i) {
        const AddedParameter& a = group.added[question.numbers[i]];
        const double up = reach_of(a, 1), sign = up > 0 ? 1 : -1, range = up > 0 ? up : reach_of(a, -1);
        Detectable d{.mechanism = label(question, groups, problem.shape), .number = a.parameter.name, .off = *a.parameter.nominal, .farthest = *a.parameter.nominal + sign * range};
        const auto own = part.expected(question, Eigen::Index(i), q);
        std::vector<std::pair<std::size_t, FirstOrderModel::Expected>> rivals;
        for (std::size_t r = 0; r < questions.size(); ++r)
          if (questions[r].group != question.group && groups[questions[r].group].name != group.name) rivals.emplace_back(r, part.expected(question, Eigen::Index(i), r));
        for (int trial = 0; trial <= trials && !d.from; ++trial) {
          const double strength = range * std::pow(least_strength, 1 - double(trial) / trials), log_b = own.log_bayes_factor(strength);
          double next = 0;
          d.limited_by.clear();
          for (const auto& [r, expected] : rivals)
            if (const double b = expected.log_bayes_factor(strength); b > next) next = b, d.limited_by = label(questions[r], groups, problem.shape);
          if (log_b >= gates.log_bayes_factor && log_b - next >= gates.lead) d.from = d.off + sign * strength;
          if (log_b < gates.log_bayes_factor) d.limited_by.clear();
        }
        p.numbers.push_back(std::move(d));
      }
    }
    const auto needed = [](const Detectable& d) { return std::abs(d.from ? *d.from - d.off : beyond * (d.farthest - d.off)); };
    for (std::size_t i = 0; i < p.numbers.size(); ++i) p.gain += std::log(needed(out.empty() ? p.numbers[i] : out[0].numbers[i]) / needed(p.numbers[i])) / double(p.numbers.size());
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace calomel
