#include "inverse/map_models.hpp"

namespace calomel {

Likelihood likelihood_at(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const LikelihoodOptions& options,
                         double distance, const MapModels& models, std::span<const double> theta, bool with_surrogate) {
  ModelError e;
  const Prediction p = (models.surrogate ? *models.surrogate : models.true_model).evaluate(theta);
  const auto vector = [](const std::vector<double>& v) { return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size()))); };
  e.mesh = models.mesh, e.unknowns = models.unknowns;
  if (p.ok && !p.energy_slope.empty()) e.energy_slope = vector(p.energy_slope);
  if (models.floor_variance.size())
    e.floor_variance = models.floor_variance;
  else if (p.ok && !p.scatter.empty())
    e.floor_variance = vector(p.scatter).array().square();
  if (with_surrogate && models.surrogate && models.surrogate_variance) e.surrogate_variance = models.surrogate_variance(theta);
  std::optional<MeshError::Spread> spread;
  if (!models.mesh.empty()) spread = models.mesh.spread(theta), e.mesh_known = spread->known;
  const Likelihood l(problem, recordings, recording_options, options, e);
  const auto shaped = [&](const Eigen::VectorXd& amplitude) { return discrepancy_shape(problem, l.grid(), amplitude, models.positions, distance, mesh_kernel); };
  if (spread) {
    const Eigen::VectorXd remainder = l.grid().apply(spread->remainder), scatter = l.grid().apply(spread->scatter.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    return l.with("mesh, beyond the pairs", shaped(remainder) + shaped(scatter));
  }
  return models.mesh_relative > 0 ? l.with("mesh, assumed", models.mesh_relative * models.mesh_relative * shaped(l.data())) : l;
}

}  // namespace calomel
