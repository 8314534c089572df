#include "uq/diagnosis/fit_measures.hpp"

#include <cmath>
#include <limits>

#include "inverse/posterior/prior.hpp"
#include "uq/diagnosis/held_out.hpp"

namespace calomel {

Cholesky plain_errors(const PosteriorFit& fit, const LogPosterior& posterior, const LocalMode& mode, const ErrorModel& errors) {
  return Cholesky(errors.covariance() + posterior.density(mode.at, false).variance * fit.noise);
}

double plain_chi2(const Cholesky& plain, const ErrorModel& errors, const PosteriorFit& fit, const LocalMode& mode) {
  return plain.solve_lower(Eigen::VectorXd(errors.data() - fit.prediction(mode.at))).squaredNorm();
}

double misfit_of_history(const PosteriorFit& fit, const Eigen::VectorXd& history) {
  const Decimation& grid = fit.errors->grid();
  return misfit_of_all(grid, grid.apply(history), fit.errors->data());
}

std::vector<double> misfits_by_gauge(const PosteriorFit& fit, const std::vector<double>& history) {
  const Decimation& grid = fit.errors->grid();
  std::vector<double> all(grid.observations(), std::numeric_limits<double>::quiet_NaN());
  if (history.empty()) return all;
  const Eigen::VectorXd prediction = grid.apply(values_of(history));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = misfit_of(fold_of(grid, {i}), grid, prediction, fit.errors->data());
  return all;
}

std::vector<double> prior_deviations(const DiagnosisInputs& in, std::span<const double> theta) {
  std::vector<double> all;
  for (std::size_t k = 0; k < in.own_parameters(); ++k) all.push_back(prior_deviation(in.base.parameters[k], theta[k]).value_or(0));
  return all;
}

std::vector<Estimate> own_parameters(const DiagnosisInputs& in, const LogPosterior& posterior, const Moments& moments) {
  std::vector<Estimate> all;
  for (std::size_t i = 0; i < posterior.free().size(); ++i) {
    const auto k = std::size_t(posterior.free()[i]);
    if (k < in.own_parameters()) all.push_back({in.base.parameters[k].name, moments.mean[Eigen::Index(i)], moments.sd[Eigen::Index(i)]});
  }
  return all;
}

double root_mean_square(const std::vector<double>& x) {
  double sum = 0;
  for (const double v : x) sum += v * v;
  return x.empty() ? 0 : std::sqrt(sum / double(x.size()));
}

}  // namespace calomel
