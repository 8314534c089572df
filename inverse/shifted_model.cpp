#include "inverse/shifted_model.hpp"

namespace calomel {

Prediction ShiftedModel::evaluate(std::span<const double> theta) const {
  Prediction p = model_.evaluate(theta);
  if (p.ok && !mesh_.empty()) Eigen::Map<Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size())) += mesh_.shift(theta);
  return p;
}

Eigen::MatrixXf ShiftedModel::means(const Eigen::MatrixXd& thetas, int threads) const {
  Eigen::MatrixXf y = model_.means(thetas, threads);
  if (!mesh_.empty())
    for (Eigen::Index i = 0; i < y.cols(); ++i) y.col(i) += mesh_.shift({thetas.col(i).data(), std::size_t(thetas.rows())}).cast<float>();
  return y;
}

HistoryBasis ShiftedModel::basis() const {
  HistoryBasis own = model_.basis();
  return own.empty() || mesh_.empty() ? own : own.with(mesh_.shift_directions());
}

Eigen::MatrixXf ShiftedModel::coefficients(const Eigen::MatrixXd& thetas) const {
  const Eigen::MatrixXf own = model_.coefficients(thetas);
  if (mesh_.empty()) return own;
  Eigen::MatrixXf all(own.rows() + mesh_.pairs(), own.cols());
  all << own, mesh_.kriging().weights_at(thetas).cast<float>();
  return all;
}

Eigen::VectorXd ShiftedModel::pull_back(std::span<const double> theta, std::span<const double> weights) const {
  const Eigen::VectorXd own = model_.pull_back(theta, weights);
  return mesh_.empty() ? own : Eigen::VectorXd(own + mesh_.pull_back(theta, weights));
}

Prediction RememberingModel::evaluate(std::span<const double> theta) const {
  const std::vector<double> key(theta.begin(), theta.end());
  {
    const std::lock_guard guard(lock_);
    if (const auto it = known_.find(key); it != known_.end()) return it->second;
  }
  learn(theta, model_.evaluate(theta), true);
  const std::lock_guard guard(lock_);
  return known_.at(key);
}

void RememberingModel::learn(std::span<const double> theta, Prediction prediction, bool counts) const {
  const std::lock_guard guard(lock_);
  if (known_.emplace(std::vector<double>(theta.begin(), theta.end()), std::move(prediction)).second && counts) ++runs_;
}

bool RememberingModel::knows(std::span<const double> theta) const {
  const std::lock_guard guard(lock_);
  return known_.contains({theta.begin(), theta.end()});
}

}  // namespace calomel
