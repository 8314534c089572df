#include "uq/true_model_density.hpp"

#include <cmath>

#include "uq/posterior_density.hpp"

namespace calomel {

double TrueModelDensity::log_density(std::span<const double> x) const {
  const LogPosterior& posterior = *fit_.posterior;
  const Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size()));
  const double by_emulator = posterior.log_density(q);
  if (by_emulator == never) return never;
  const auto at = posterior.point(q);
  const auto records = [&] {
    const std::lock_guard one(running_);
    return in_.run(Eigen::Map<const Eigen::VectorXd>(at.theta.data(), Eigen::Index(at.theta.size())), {0});
  }();
  if (!records.at(0).done) {
    ++failed_;
    return never;
  }
  const MultilevelRegression& emulator = posterior.emulator();
  const Eigen::VectorXd beyond = emulator.features(at.u, at.beyond) - emulator.level_features(at.u, 0);
  const Eigen::VectorXd prediction = fit_.errors->grid().apply(records[0].history()) + fit_.coefficients * beyond;
  const double noise = in_.box.shrinks() ? 0 : emulator.noise_ratio()[0];
  return by_emulator - posterior.density(at).log_likelihood + posterior.log_likelihood_of(prediction, noise + emulator.variance(beyond));
}

void TrueModelDensity::constrain(std::span<const double> x, std::span<double> values) const { PosteriorDensity(*fit_.posterior).constrain(x, values); }

}  // namespace calomel
