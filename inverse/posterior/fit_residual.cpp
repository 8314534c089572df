#include "inverse/posterior/fit_residual.hpp"

#include "base/errors.hpp"
#include "base/linear_algebra.hpp"

namespace calomel {

FitResidual residual_of(const PosteriorFit& fit) {
  const LogPosterior& posterior = *fit.posterior;
  const LocalMode& mode = fit.modes[0];
  const ErrorModel& errors = fit.likeliest().errors;
  const auto density = posterior.density(mode.at);
  return {.residual = errors.data() - fit.prediction(mode.at),
          .covariance = errors.covariance() + density.variance * fit.noise,
          .directions = errors.directions(),
          .chi2 = density.chi2,
          .parameters = std::size_t(posterior.dimension()),
          .freedom = posterior.freedom(posterior.likeliest(mode.at))};
}

FitResidual residual_of(const ErrorModel& errors, const Eigen::VectorXd& prediction, std::size_t parameters) {
  FitResidual out{.residual = errors.data() - prediction,
                  .covariance = errors.covariance(),
                  .directions = errors.directions(),
                  .chi2 = 0,
                  .parameters = parameters,
                  .freedom = errors.freedom()};
  const Cholesky factor(out.covariance);
  if (!factor.positive_definite()) throw NumericsError("the covariance of the records' errors is not positive definite");
  out.chi2 = factor.solve_lower(out.residual).squaredNorm();
  return out;
}

}  // namespace calomel
