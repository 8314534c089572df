#pragma once
/// Densities whose moments are known.
#include <Eigen/Core>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>

#include "base/linear_algebra.hpp"
#include "uq/log_density.hpp"

namespace calomel::testing {

inline std::vector<std::string> numbered(std::size_t d) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < d; ++k) names.push_back("x" + std::to_string(k + 1));
  return names;
}

class Gaussian : public LogDensity {
 public:
  Gaussian(Eigen::VectorXd mean, const Eigen::MatrixXd& covariance)
      : mean_(std::move(mean)), cholesky_(covariance), names_(numbered(std::size_t(mean_.size()))) {}
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return names_; }
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    ++calls;
    const Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(x.data(), mean_.size()) - mean_;
    return -0.5 * r.dot(cholesky_.solve(r));
  }
  mutable std::atomic<std::size_t> calls{0};

 private:
  Eigen::VectorXd mean_;
  Cholesky cholesky_;
  std::vector<std::string> names_;
};

/// Given by a function of x; the quantities are those of another one, or the coordinates.
template <class F>
class Written : public LogDensity {
 public:
  Written(std::size_t d, F f) : f_(std::move(f)), names_(numbered(d)) {}
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return names_; }
  [[nodiscard]] double log_density(std::span<const double> x) const override { return f_(x); }

 private:
  F f_;
  std::vector<std::string> names_;
};

/// A density with its gradient, both written down.
class Sloped : public LogDensity {
 public:
  using Of = std::function<double(std::span<const double> x, std::span<double> gradient)>;
  Sloped(std::size_t d, Of of) : of_(std::move(of)), names_(numbered(d)) {}
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return names_; }
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    std::vector<double> g(x.size());
    return of_(x, g);
  }
  [[nodiscard]] bool has_gradient() const override { return true; }
  double log_density_and_gradient(std::span<const double> x, std::span<double> g) const override { return of_(x, g); }

 private:
  Of of_;
  std::vector<std::string> names_;
};

/// x1 ~ N(1, 1), x2 | x1 ~ N(x1^2, 1/2): means 1 and 2, variances 1 and 6.5. ln of its integral is ln(2 pi) - ln(2) / 2.
inline Sloped banana() {
  return {2, [](std::span<const double> x, std::span<double> g) {
            const double r = x[1] - x[0] * x[0];
            g[0] = 1 - x[0] + 4 * r * x[0];
            g[1] = -2 * r;
            return -0.5 * std::pow(1 - x[0], 2) - r * r;
          }};
}

}  // namespace calomel::testing
