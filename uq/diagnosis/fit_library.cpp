#include "uq/diagnosis/fit_library.hpp"

#include <algorithm>
#include <cmath>

namespace calomel {

double FitLibrary::best_log_bayes_factor() const {
  double best = 0;
  for (const auto& c : candidates)
    if (c.explanation.fitted) best = std::max(best, c.explanation.log_bayes_factor);
  return best;
}

ScreeningInputs screening_about(const DiagnosisInputs& in, RunBudget& budget, const PosteriorFit& fit, std::vector<AddedParameter> added,
                                const std::vector<ParameterGroup>& groups) {
  return {.fit = fit,
          .problem = in.base.problem,
          .groups = groups,
          .level = in.coarser_level(),
          .run = [&budget, added = std::move(added)](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> further) {
            std::vector<AddedParameter> all = added;
            all.insert(all.end(), further.begin(), further.end());
            return budget.run(thetas, level, all);
          }};
}

Estimate reported_number(const DiagnosisInputs& in, const AddedParameter& a, double mean, double sd, const std::vector<Estimate>& own) {
  if (a.share_of.empty()) return {a.parameter.name, mean, sd};
  Estimate whole{.name = {}, .mean = a.whole};
  for (std::size_t k = 0; k < in.own_parameters(); ++k)
    if (in.base.parameters[k].key == a.share_of)
      for (const auto& e : own)
        if (e.name == in.base.parameters[k].name) whole = e;
  // The effect of a share sets in at once. Where the records do not halve its prior's deviation, what they seem to show of it is the form of the law.
  const double range = a.parameter.max - a.parameter.min, of_prior = range / std::sqrt(12);
  const bool narrowed = sd < 0.5 * of_prior;
  if (!narrowed) {
    mean = a.parameter.min + 0.5 * range;
    sd = of_prior;
  }
  return {a.parameter.name, mean * whole.mean, std::hypot(sd * whole.mean, mean * whole.sd), narrowed};
}

void report_fitted(const FitContext& context, const Alternative& a) {
  const BaseEvidence& base = context.base.evidence;
  const Explanation& e = a.explanation;
  context.in.say(ExplanationFitted{e.name, e.log_bayes_factor, e.chi2, base.values, base.chi2, a.runs});
}

}  // namespace calomel
