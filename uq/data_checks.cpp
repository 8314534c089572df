#include "uq/data_checks.hpp"

namespace calomel {

DataChecks check_data(const PosteriorInputs& in, const PosteriorFit& fit) {
  DataChecks checks{.dead = in.problem.dead, .mislabelled = mislabelled_channels(in.problem, fit)};
  if (!checks.mislabelled.empty()) return checks;
  checks.clock = clock_offset(in.problem, fit);
  checks.nuisances = prior_deviations(residual_of(fit));
  return checks;
}

DataChecks check_data(const Problem& problem, const ErrorModel& errors, const Eigen::VectorXd& prediction, const FitResidual& left) {
  DataChecks checks{.dead = problem.dead, .mislabelled = mislabelled_channels(problem, errors.grid(), errors.data(), prediction)};
  if (checks.mislabelled.empty()) checks.nuisances = prior_deviations(left);
  return checks;
}

}  // namespace calomel
