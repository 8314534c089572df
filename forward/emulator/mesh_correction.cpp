#include "forward/emulator/mesh_correction.hpp"

#include <algorithm>

#include "base/errors.hpp"

namespace calomel {

namespace {

Eigen::VectorXd clamped(const Eigen::VectorXd& u) { return u.cwiseMax(-1.0).cwiseMin(1.0); }

}  // namespace

MeshCorrection::MeshCorrection(EmulatorBox box, const MultilevelRegression& regression, const Eigen::MatrixXd& histories, int working_level,
                               std::vector<double> fixed_fine, std::vector<double> fixed_working)
    : box_(std::move(box)), regression_(regression), level_(working_level), fine_(std::move(fixed_fine)), working_(std::move(fixed_working)) {
  expect(histories.cols() == regression.size(), "every run of the regression has a history");
  directions_ = regression.fit(histories);
  expect(level_ >= 0 && level_ < regression.levels(), "the working mesh is one of the emulator's");
  expect(fine_.size() == working_.size() && Eigen::Index(fine_.size()) <= box_.size(), "either mesh has the same numbers beside the parameters");
}

std::vector<double> MeshCorrection::with(std::span<const double> theta, const std::vector<double>& fixed) const {
  std::vector<double> all(theta.begin(), theta.end());
  all.insert(all.end(), fixed.begin(), fixed.end());
  expect(Eigen::Index(all.size()) == box_.size(), "a point has the parameters of the emulator's box");
  return all;
}

Eigen::VectorXd MeshCorrection::features(const Eigen::VectorXd& u_fine, const Eigen::VectorXd& u_working) const {
  return regression_.features(u_fine, 0) - regression_.level_features(u_working, level_);
}

bool MeshCorrection::inside(std::span<const double> theta) const { return box_.contains(with(theta, fine_)) && box_.contains(with(theta, working_)); }

Eigen::VectorXd MeshCorrection::weights(std::span<const double> theta) const {
  return features(clamped(box_.u(with(theta, fine_))), clamped(box_.u(with(theta, working_))));
}

Eigen::VectorXd MeshCorrection::vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const {
  const Eigen::VectorXd by_feature = directions_.transpose() * Eigen::Map<const Eigen::VectorXd>(weights.data(), Eigen::Index(weights.size()));
  const Eigen::VectorXd u = box_.u(with(theta, fine_)), fine = clamped(u), working = clamped(box_.u(with(theta, working_))), by_u = box_.derivative(u);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(Eigen::Index(theta.size()));
  for (Eigen::Index k = 0; k < g.size(); ++k) {
    if (std::abs(u[k]) > 1) continue;
    const Eigen::VectorXd e = 0.5 * Eigen::VectorXd::Unit(u.size(), k);  // features are of order two: a central difference is exact
    g[k] = by_feature.dot(features(fine + e, working + e) - features(fine - e, working - e)) / by_u[k];
  }
  return g;
}

Prediction CorrectedModel::corrected(Prediction p, std::span<const double> theta) const {
  if (p.ok && !correction_.empty()) Eigen::Map<Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size())) += correction_.shift(theta);
  return p;
}

Prediction CorrectedModel::evaluate(std::span<const double> theta) const { return corrected(model_.evaluate(theta), theta); }

std::vector<Prediction> CorrectedModel::predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted) const {
  auto all = model_.predictions(thetas, threads, predicted);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = corrected(std::move(all[i]), {thetas.col(Eigen::Index(i)).data(), std::size_t(thetas.rows())});
  return all;
}

Eigen::MatrixXf CorrectedModel::means(const Eigen::MatrixXd& thetas, int threads) const {
  Eigen::MatrixXf y = model_.means(thetas, threads);
  if (!correction_.empty())
    for (Eigen::Index i = 0; i < y.cols(); ++i) y.col(i) += correction_.shift({thetas.col(i).data(), std::size_t(thetas.rows())}).cast<float>();
  return y;
}

HistoryBasis CorrectedModel::basis() const {
  HistoryBasis own = model_.basis();
  return own.empty() || correction_.empty() ? own : own.with(correction_.directions());
}

Eigen::MatrixXf CorrectedModel::coefficients(const Eigen::MatrixXd& thetas) const {
  Eigen::MatrixXf own = model_.coefficients(thetas);
  if (correction_.empty()) return own;
  Eigen::MatrixXf all(own.rows() + correction_.directions().cols(), own.cols());
  all.topRows(own.rows()) = own;
  for (Eigen::Index i = 0; i < own.cols(); ++i)
    all.col(i).tail(correction_.directions().cols()) = correction_.weights({thetas.col(i).data(), std::size_t(thetas.rows())}).cast<float>();
  return all;
}

Eigen::VectorXd CorrectedModel::vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const {
  const Eigen::VectorXd own = model_.vector_jacobian_product(theta, weights);
  return correction_.empty() ? own : Eigen::VectorXd(own + correction_.vector_jacobian_product(theta, weights));
}

}  // namespace calomel
