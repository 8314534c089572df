#include "forward/surrogate/input_scaling.hpp"

#include <cmath>

#include "forward/surrogate/stored_array.hpp"

namespace calomel {

InputScaling::InputScaling(const std::vector<Parameter>& parameters, Coordinates coordinates, double low, double high)
    : bounds_(2, Eigen::Index(parameters.size())), low_(low), high_(high) {
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const Parameter& p = parameters[j];
    expect(p.max > p.min, "a parameter's bounds are in order");
    bounds_.col(Eigen::Index(j)) << p.min, p.max;
    const bool positive = p.min > 0;
    if (coordinates != Coordinates::log || !positive) source_.push_back(int(j)), log_.push_back(0);
    if (coordinates != Coordinates::linear && positive) source_.push_back(int(j)), log_.push_back(1);
  }
}

Eigen::MatrixXd InputScaling::features(const Eigen::MatrixXd& thetas) const {
  expect(thetas.rows() == bounds_.cols(), "a point has as many numbers as the surrogate has parameters");
  Eigen::MatrixXd x(features(), thetas.cols());
  for (Eigen::Index f = 0; f < x.rows(); ++f) {
    const Eigen::Index j = source_[std::size_t(f)];
    const double a = bounds_(0, j), b = bounds_(1, j);
    if (log_[std::size_t(f)])
      x.row(f) = low_ + (high_ - low_) * (thetas.row(j).array() / a).log() / std::log(b / a);
    else
      x.row(f) = low_ + (high_ - low_) * (thetas.row(j).array() - a) / (b - a);
  }
  return x;
}

Eigen::VectorXd InputScaling::vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& gradient) const {
  Eigen::VectorXd g = Eigen::VectorXd::Zero(parameters());
  for (Eigen::Index f = 0; f < features(); ++f) {
    const Eigen::Index j = source_[std::size_t(f)];
    const double a = bounds_(0, j), b = bounds_(1, j);
    g[j] += gradient[f] * (high_ - low_) / (log_[std::size_t(f)] ? theta[j] * std::log(b / a) : b - a);
  }
  return g;
}

double InputScaling::log_ratio(Eigen::Index feature) const {
  if (!log_[std::size_t(feature)]) return 0;
  const Eigen::Index j = source_[std::size_t(feature)];
  return std::log(bounds_(1, j) / bounds_(0, j));
}

void InputScaling::save(NetcdfWriter& file, const std::string& prefix) const {
  store(file, prefix + "input_bounds", Eigen::MatrixXd(bounds_));
  store(file, prefix + "feature_source", source_);
  store(file, prefix + "feature_is_log", log_);
  store(file, prefix + "feature_interval", Eigen::MatrixXd(Eigen::Vector2d(low_, high_)));
}

InputScaling InputScaling::load(const NetcdfReader& file, const std::string& prefix) {
  InputScaling s;
  s.bounds_ = stored_matrix<double>(file, prefix + "input_bounds");
  s.source_ = file.integers(prefix + "feature_source");
  s.log_ = file.integers(prefix + "feature_is_log");
  const auto interval = file.doubles(prefix + "feature_interval");
  s.low_ = interval[0];
  s.high_ = interval[1];
  return s;
}

}  // namespace calomel
