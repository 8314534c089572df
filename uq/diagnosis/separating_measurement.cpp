#include "uq/diagnosis/separating_measurement.hpp"

#include <algorithm>
#include <cmath>

#include "uq/diagnosis/fit_measures.hpp"

namespace calomel {

std::vector<Explanation> explanations_by_evidence(const BaseEvidence& base, const std::vector<Alternative>& candidates) {
  std::vector<Explanation> all;
  for (const auto& c : candidates) all.push_back(c.explanation);
  sort_by_evidence(base, all);
  return all;
}

const Alternative* find_alternative(const std::vector<Alternative>& candidates, const std::string& name) {
  const auto at = std::find_if(candidates.begin(), candidates.end(), [&](const auto& c) { return c.explanation.name == name; });
  return at == candidates.end() ? nullptr : &*at;
}

std::optional<SeparatingMeasurement> separating_measurement(const Problem& problem, const BaseFit& base, const std::vector<Alternative>& candidates,
                                                            const Verdict& verdict) {
  std::vector<const Alternative*> two;  // of the verdict first, and then by their evidence
  const auto take = [&](const std::string& name) {
    const Alternative* c = find_alternative(candidates, name);
    if (!c->history.empty() && two.size() < 2 && std::find(two.begin(), two.end(), c) == two.end()) two.push_back(c);
  };
  for (const auto& name : verdict.mechanisms) take(name);
  for (const auto& e : explanations_by_evidence(base.evidence, candidates)) take(e.name);
  if (two.empty()) return {};
  const Decimation& grid = base.grid();
  const std::vector<double>& other = two.size() > 1 ? two[1]->history : base.history;
  const Eigen::VectorXd difference = grid.apply(values_of(two[0]->history) - values_of(other));
  const Eigen::VectorXd z = difference.cwiseQuotient(base.fit.errors->covariance().diagonal().cwiseSqrt());
  Eigen::Index most = 0;
  z.cwiseAbs().maxCoeff(&most);
  std::size_t at = 0;
  while (at + 1 < grid.observations() && Eigen::Index(grid.offset(at + 1)) <= most) ++at;
  return SeparatingMeasurement{.first = two[0]->explanation.name,
                               .second = two.size() > 1 ? two[1]->explanation.name : std::string(),
                               .gauge = problem.label(problem.observations[at]),
                               .time = grid.times()[most],
                               .difference = problem.mae_scale * std::abs(difference[most]),
                               .unit = problem.mae_unit,
                               .standard_deviations = std::abs(z[most])};
}

}  // namespace calomel
