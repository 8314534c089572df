#include "uq/slips.hpp"

#include "inverse/posterior/pulls.hpp"
#include "uq/diagnosis/mixed_up.hpp"
#include "uq/diagnosis/plain_words.hpp"

namespace calomel {

namespace {

std::vector<std::string> sentences(const std::vector<MixedUp>& mixed) {
  std::vector<std::string> told;
  for (const auto& m : mixed) told.push_back(plain_mixed_up(m));
  return told;
}

}  // namespace

std::vector<std::string> slips(const PosteriorInputs& in, const PosteriorFit& fit) {
  auto told = sentences(mixed_up(in.problem, fit));
  if (!told.empty()) return told;
  if (const auto late = late_records(in.problem, fit)) told.push_back(plain_late(*late) + " Physics that was left out may look so, too: ask calomel diagnose.");
  for (auto& pulled : far_pulls(pulls(residual_of(fit)), in.errors)) told.push_back(std::move(pulled));
  return told;
}

std::vector<std::string> slips(const Problem& problem, const ErrorOptions& options, const ErrorModel& errors, const Eigen::VectorXd& prediction, const FitResidual& left) {
  const auto told = sentences(mixed_up(problem, errors.grid(), errors.data(), prediction));
  return told.empty() ? far_pulls(pulls(left), options) : told;
}

}  // namespace calomel
