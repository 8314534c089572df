#pragma once
/// Student's t with 4 degrees of freedom in d dimensions, whose tails seldom end before those of a posterior; and mixtures of it.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "base/log_sum.hpp"
#include "base/random.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

/// One Student's t.
class StudentT {
 public:
  static constexpr double freedom = 4;

  /// factor: (d, d), the lower Cholesky factor of the scale.
  StudentT(Eigen::VectorXd mean, Eigen::MatrixXd factor) : mean_(std::move(mean)), factor_(std::move(factor)) {
    const double d = double(mean_.size());
    log_norm_ =
        std::lgamma((freedom + d) / 2) - std::lgamma(freedom / 2) - 0.5 * d * std::log(freedom * std::numbers::pi) - factor_.diagonal().array().log().sum();
  }
  [[nodiscard]] const Eigen::VectorXd& mean() const { return mean_; }
  [[nodiscard]] const Eigen::MatrixXd& factor() const { return factor_; }
  [[nodiscard]] Eigen::VectorXd draw(RandomStream& random) const {
    Eigen::VectorXd z(mean_.size());
    for (double& v : z) v = random.normal();
    // Chi-squared with 4 degrees of freedom is minus twice the logarithm of a product of two uniform numbers of (0, 1].
    const double chi2 = -2 * (std::log1p(-random.uniform()) + std::log1p(-random.uniform()));
    return mean_ + factor_ * (z * std::sqrt(freedom / std::max(chi2, std::numeric_limits<double>::min())));
  }
  [[nodiscard]] double log_density(const Eigen::VectorXd& x) const {
    const double square = factor_.triangularView<Eigen::Lower>().solve(x - mean_).squaredNorm();
    return log_norm_ - 0.5 * (freedom + double(mean_.size())) * std::log1p(square / freedom);
  }

 private:
  Eigen::VectorXd mean_;
  Eigen::MatrixXd factor_;
  double log_norm_;
};

/// A mixture of Student's t.
class StudentMixture {
 public:
  /// Puts a part about each mode, `widening` times as wide as its covariance; weights sum to 1. Errors: InputError when a covariance is not positive definite.
  StudentMixture(const std::vector<StartMode>& modes, double inflation) {
    for (const auto& m : modes) parts_.emplace_back(m.weight, StudentT(m.mean, inflation * covariance_factor(m.covariance, std::size_t(m.mean.size()))));
  }
  /// A part, drawn by its weight.
  [[nodiscard]] const StudentT& choose(RandomStream& random) const {
    if (parts_.size() == 1) return parts_[0].second;
    std::size_t part = 0;
    for (double left = random.uniform() - parts_[0].first; left >= 0 && part + 1 < parts_.size(); left -= parts_[part].first) ++part;
    return parts_[part].second;
  }
  [[nodiscard]] std::size_t parts() const { return parts_.size(); }
  [[nodiscard]] const StudentT& part(std::size_t k) const { return parts_[k].second; }
  /// The part to which x belongs with the greatest probability.
  [[nodiscard]] std::size_t part_of(const Eigen::VectorXd& x) const {
    if (parts_.size() == 1) return 0;
    const auto logs = log_parts(x);
    return std::size_t(std::max_element(logs.begin(), logs.end()) - logs.begin());
  }
  [[nodiscard]] double log_density(const Eigen::VectorXd& x) const { return parts_.size() == 1 ? parts_[0].second.log_density(x) : log_sum(log_parts(x)); }

 private:
  [[nodiscard]] std::vector<double> log_parts(const Eigen::VectorXd& x) const {
    std::vector<double> logs;
    for (const auto& [weight, shape] : parts_) logs.push_back(std::log(weight) + shape.log_density(x));
    return logs;
  }
  std::vector<std::pair<double, StudentT>> parts_;  ///< weight and shape
};

}  // namespace calomel
