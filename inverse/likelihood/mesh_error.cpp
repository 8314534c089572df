#include "inverse/likelihood/mesh_error.hpp"

#include <cmath>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr double pairs_that_show_half = 8;  ///< of the directions in which the difference scatters

}  // namespace

MeshError::MeshError(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& differences, BeyondFiner beyond)
    : kriging_(parameters, theta, differences), beyond_(beyond), differences_(differences) {
  expect(beyond.mean >= 0 && beyond.sd >= 0 && beyond.remainder >= 0, "the shift goes to the finer mesh or beyond");
}

Eigen::VectorXd MeshError::pull_back(std::span<const double> theta, std::span<const double> weights) const {
  return (1 + beyond_.mean) * kriging_.slope(theta, differences_.transpose() * Eigen::Map<const Eigen::VectorXd>(weights.data(), Eigen::Index(weights.size())));
}

double MeshError::known_share() const {
  const double seen = double(pairs() - 1);
  return seen / (seen + pairs_that_show_half);
}

MeshError MeshError::with_known_scatter_drawn() const {
  MeshError m = *this;
  m.known_drawn_ = true;
  return m;
}

MeshError MeshError::with_records_beyond(double mean, double sd) const {
  MeshError m = *this;
  m.beyond_.sd = std::hypot(sd, mean - beyond_.mean);
  return m;
}

MeshError::Draw MeshError::draw(RandomStream& random) const { return {KrigingError(kriging_, pairs() - 1, random), std::sqrt(known_share()) * root()}; }

MeshError::Spread MeshError::spread(std::span<const double> theta) const {
  const double share = known_share();
  const Eigen::MatrixXd own = std::sqrt(kriging_.smooth_variance_factor(theta)) * root();
  const Eigen::VectorXd d = difference(theta);
  Spread s;
  s.known.resize(differences_.rows(), pairs());
  s.known.leftCols(pairs() - 1) = (known_drawn_ ? 0 : std::sqrt(share)) * own;
  s.known.col(pairs() - 1) = beyond_.sd * d;
  s.scatter = std::sqrt(1 - share) * own.rowwise().norm();
  s.remainder = beyond_.remainder * d;
  return s;
}

}  // namespace calomel
