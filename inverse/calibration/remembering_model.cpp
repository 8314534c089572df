#include "inverse/calibration/remembering_model.hpp"

namespace calomel {

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

std::vector<Prediction> RememberingModel::predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted) const {
  const auto theta = [&](Eigen::Index i) { return std::span<const double>(thetas.col(i).data(), std::size_t(thetas.rows())); };
  std::vector<Eigen::Index> unknown;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i)
    if (!knows(theta(i))) unknown.push_back(i);
  auto made = model_.predictions(thetas(Eigen::all, unknown), threads, predicted);
  for (std::size_t i = 0; i < unknown.size(); ++i) learn(theta(unknown[i]), std::move(made[i]), true);
  std::vector<Prediction> all;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) all.push_back(evaluate(theta(i)));
  return all;
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
