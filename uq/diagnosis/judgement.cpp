#include "uq/diagnosis/judgement.hpp"

#include <algorithm>

#include "uq/diagnosis/fit_measures.hpp"
#include "uq/diagnosis/hold_out_predictions.hpp"

namespace calomel {

namespace {

constexpr double class_distance = 4;  ///< distance in standard deviations of the records below which two explanations are one class

/// Marks explanations whose predictions no record distinguishes.
void mark_classes(const BaseFit& base, std::vector<Alternative>& candidates) {
  const Cholesky errors(base.fit.errors->covariance());
  const auto effect = [&](const Alternative& c) {
    return errors.solve_lower(Eigen::VectorXd(base.grid().apply(values_of(c.history) - values_of(base.history))));
  };
  for (auto& a : candidates) {
    a.explanation.same_as.clear();
    if (a.history.empty()) continue;
    const Eigen::VectorXd of_a = effect(a);
    for (const auto& b : candidates) {
      if (&a == &b || b.history.empty()) continue;
      const Eigen::VectorXd of_b = effect(b);
      if (of_a.norm() > class_distance && of_b.norm() > class_distance && (of_a - of_b).norm() < class_distance)
        a.explanation.same_as.push_back(b.explanation.name);
    }
  }
}

}  // namespace

Verdict judge_candidates(const FitContext& context) {
  auto& candidates = context.library.candidates;
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.explanation.log_bayes_factor > b.explanation.log_bayes_factor; });
  mark_classes(context.base, candidates);
  std::vector<Explanation> all;
  for (auto& c : candidates) {
    add_hold_out_predictions(context, c);
    all.push_back(c.explanation);
  }
  return judge(context.base.evidence, all);
}

}  // namespace calomel
