#pragma once
/// A case's posterior as samplers take it.
#include "inverse/posterior/log_posterior.hpp"
#include "uq/log_density.hpp"

namespace calomel {

/// LogPosterior in its unconstrained coordinates; reported are the parameters in natural units and, where it is a coordinate, how far past the finest mesh
/// the records lie. The posterior outlives the object.
class PosteriorDensity final : public LogDensity {
 public:
  explicit PosteriorDensity(const LogPosterior& posterior) : posterior_(posterior), names_(posterior.names()) {}

  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return names_; }
  [[nodiscard]] double log_density(std::span<const double> x) const override { return posterior_.log_density(map(x)); }
  [[nodiscard]] bool has_gradient() const override { return true; }
  double log_density_and_gradient(std::span<const double> x, std::span<double> gradient) const override {
    Eigen::VectorXd g(posterior_.dimension());
    const double value = posterior_.log_density(map(x), &g);
    std::copy(g.data(), g.data() + g.size(), gradient.begin());
    return value;
  }
  void constrain(std::span<const double> x, std::span<double> values) const override {
    const auto at = posterior_.point(map(x));
    const auto& free = posterior_.free();
    for (std::size_t i = 0; i < free.size(); ++i) values[i] = at.theta[std::size_t(free[i])];
    if (posterior_.has_beyond()) values[free.size()] = at.beyond;
  }

 private:
  [[nodiscard]] Eigen::VectorXd map(std::span<const double> x) const { return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size())); }
  const LogPosterior& posterior_;
  std::vector<std::string> names_;
};

}  // namespace calomel
