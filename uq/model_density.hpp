#pragma once
/// The posterior of a model with cheap runs, in the form that samplers use.
#include "inverse/posterior/model_posterior.hpp"
#include "uq/log_density.hpp"

namespace calomel {

/// ModelPosterior in its unconstrained coordinates; reported are the parameters in natural units. The posterior outlives the object.
class ModelDensity final : public LogDensity {
 public:
  explicit ModelDensity(const ModelPosterior& posterior) : posterior_(posterior) {
    for (const auto& p : posterior.parameters()) names_.push_back(p.name);
  }
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return names_; }
  [[nodiscard]] double log_density(std::span<const double> x) const override { return posterior_.log_density(vector_of(x)); }
  [[nodiscard]] bool has_gradient() const override { return posterior_.has_gradient(); }
  double log_density_and_gradient(std::span<const double> x, std::span<double> gradient) const override {
    Eigen::VectorXd g;
    const double value = posterior_.log_density(vector_of(x), g);
    std::copy(g.data(), g.data() + g.size(), gradient.begin());
    return value;
  }
  void constrain(std::span<const double> x, std::span<double> values) const override {
    const auto theta = posterior_.theta(vector_of(x));
    std::copy(theta.begin(), theta.end(), values.begin());
  }

 private:
  [[nodiscard]] static Eigen::VectorXd vector_of(std::span<const double> x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size())); }
  const ModelPosterior& posterior_;
  std::vector<std::string> names_;
};

}  // namespace calomel
