#pragma once
#include <Eigen/Core>
#include <vector>

#include "inverse/optimizer/optimizer.hpp"

namespace calomel {

/// Points of the unit box <-> natural units.
class UnitBox {
 public:
  explicit UnitBox(const Bounds& bounds) : low_(bounds.low), width_(bounds.high - bounds.low) {}
  [[nodiscard]] std::vector<double> theta(const Eigen::VectorXd& unit) const {
    const Eigen::VectorXd x = low_ + width_.cwiseProduct(unit);
    return {x.begin(), x.end()};
  }
  [[nodiscard]] Eigen::MatrixXd units(const Eigen::MatrixXd& thetas) const {
    return ((thetas.colwise() - low_).array().colwise() / width_.array()).cwiseMax(0.0).cwiseMin(1.0).matrix();
  }
  [[nodiscard]] Eigen::VectorXd unit(const std::vector<double>& theta) const {
    return units(Eigen::Map<const Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size())));
  }
  [[nodiscard]] bool contains(const std::vector<double>& theta) const {
    const Eigen::VectorXd x = (Eigen::Map<const Eigen::VectorXd>(theta.data(), low_.size()) - low_).cwiseQuotient(width_);
    return x.minCoeff() >= 0 && x.maxCoeff() <= 1;
  }

 private:
  Eigen::VectorXd low_, width_;
};

}  // namespace calomel
