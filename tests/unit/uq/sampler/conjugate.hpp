#pragma once
/// A model whose posterior and evidence are known in closed form.
#include <cmath>
#include <numbers>
#include <vector>

#include "base/random.hpp"
#include "uq/log_density.hpp"

namespace calomel::testing {

/// y_i ~ N(mu, s), mu | s ~ N(m0, s / k0), s ~ inverse gamma(a0, b0), s a variance (Raiffa and Schlaifer 1961; Gelman et al. 2013, section 3.3). Coordinates
/// mu, ln s, with the Jacobian s in the density, or, for controls, without. All constants are in the density.
class ConjugateNormal : public LogDensity {
 public:
  static constexpr double m0 = 0.5, k0 = 0.5, a0 = 2, b0 = 2;

  explicit ConjugateNormal(std::vector<double> data, bool jacobian = true) : data_(std::move(data)), jacobian_(jacobian) {}

  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return names_; }
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    std::vector<double> g(2);
    return log_density_and_gradient(x, g);
  }
  [[nodiscard]] bool has_gradient() const override { return true; }
  double log_density_and_gradient(std::span<const double> x, std::span<double> g) const override {
    const double mu = x[0], log_s = x[1], s = std::exp(log_s), n = double(data_.size());
    double squares = k0 * (mu - m0) * (mu - m0) + 2 * b0, slope = k0 * (m0 - mu);
    for (const double y : data_) squares += (y - mu) * (y - mu), slope += y - mu;
    const double power = 0.5 * (n + 1) + a0 + 1 - (jacobian_ ? 1 : 0);
    g[0] = slope / s;
    g[1] = 0.5 * squares / s - power;
    return -0.5 * squares / s - power * log_s - 0.5 * (n + 1) * std::log(2 * std::numbers::pi) + 0.5 * std::log(k0) + a0 * std::log(b0) - std::lgamma(a0);
  }

  /// ln of the integral over both: Gamma(a_n) / Gamma(a0) b0^a0 / b_n^a_n sqrt(k0 / k_n) (2 pi)^(-n / 2).
  [[nodiscard]] double log_evidence() const {
    const double n = double(data_.size()), kn = k0 + n, an = a0 + n / 2;
    double mean = 0, squares = 0;
    for (const double y : data_) mean += y / n;
    for (const double y : data_) squares += (y - mean) * (y - mean);
    const double bn = b0 + 0.5 * squares + 0.5 * k0 * n / kn * (mean - m0) * (mean - m0);
    return std::lgamma(an) - std::lgamma(a0) + a0 * std::log(b0) - an * std::log(bn) + 0.5 * std::log(k0 / kn) - 0.5 * n * std::log(2 * std::numbers::pi);
  }

  /// Parameters from the prior, (mu, ln s), and n data from them.
  struct Drawn {
    double mu, log_s;
    std::vector<double> data;
  };
  static Drawn draw(std::size_t n, RandomStream& random) {
    double gamma = 0;  // of the integer shape a0 and rate b0: a sum of exponentials
    for (int k = 0; k < int(a0); ++k) gamma -= std::log1p(-random.uniform()) / b0;
    const double s = 1 / gamma;
    Drawn d{.mu = m0 + std::sqrt(s / k0) * random.normal(), .log_s = std::log(s), .data = {}};
    for (std::size_t i = 0; i < n; ++i) d.data.push_back(d.mu + std::sqrt(s) * random.normal());
    return d;
  }

 private:
  std::vector<double> data_;
  bool jacobian_;
  std::vector<std::string> names_{"mu", "ln s"};
};

}  // namespace calomel::testing
