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

void RememberingModel::learn(std::span<const double> theta, Prediction prediction, bool counts) const {
  const std::lock_guard guard(lock_);
  if (known_.emplace(std::vector<double>(theta.begin(), theta.end()), std::move(prediction)).second && counts) ++runs_;
}

bool RememberingModel::knows(std::span<const double> theta) const {
  const std::lock_guard guard(lock_);
  return known_.contains({theta.begin(), theta.end()});
}

}  // namespace calomel
