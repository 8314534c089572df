#include "uq/slips.hpp"

#include "inverse/posterior/pulls.hpp"
#include "uq/diagnosis/mixed_up.hpp"
#include "uq/diagnosis/plain_words.hpp"

namespace calomel {

namespace {

std::vector<std::string> slips_of_gauges(const Problem& problem, const std::vector<MixedUp>& mixed) {
  std::vector<std::string> told;
  if (!problem.dead.empty()) told.push_back(plain_dead(problem.dead));
  for (const auto& m : mixed) told.push_back(plain_mixed_up(m));
  return told;
}

}  // namespace

std::vector<std::string> slips(const PosteriorInputs& in, const PosteriorFit& fit) {
  const auto mixed = mixed_up(in.problem, fit);
  auto told = slips_of_gauges(in.problem, mixed);
  if (!mixed.empty()) return told;
  if (const auto late = late_records(in.problem, fit)) told.push_back(plain_late(*late) + " Physics that was left out may look so, too: ask calomel diagnose.");
  for (auto& pulled : far_pulls(pulls(residual_of(fit)), in.errors)) told.push_back(std::move(pulled));
  return told;
}

std::vector<std::string> slips(const Problem& problem, const ErrorOptions& options, const ErrorModel& errors, const Eigen::VectorXd& prediction,
                               const FitResidual& left) {
  const auto mixed = mixed_up(problem, errors.grid(), errors.data(), prediction);
  auto told = slips_of_gauges(problem, mixed);
  if (!mixed.empty()) return told;
  for (auto& pulled : far_pulls(pulls(left), options)) told.push_back(std::move(pulled));
  return told;
}

}  // namespace calomel
