#include "inverse/likelihood/kriging.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr double usual_length = 0.3, length_spread = 1.2;  ///< median, and sd of the logarithm, of the lengths before the data
constexpr std::array<double, 6> nuggets{1e-6, 0.01, 0.04, 0.12, 0.4, 1};
constexpr double shortest = 0.01, longest = 10;
constexpr int length_steps = 21, sweeps = 4;
constexpr Eigen::Index waves = 256;  ///< of a drawn realisation

}  // namespace

Kriging::Kriging(std::vector<Parameter> parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& outputs) : parameters_(std::move(parameters)) {
  expect(theta.cols() >= 2 && outputs.cols() == theta.cols() && std::size_t(theta.rows()) == parameters_.size(), "kriging needs two points or more, and an output at each");
  points_.resize(theta.rows(), theta.cols());
  for (Eigen::Index i = 0; i < theta.cols(); ++i) points_.col(i) = scaled({theta.col(i).data(), std::size_t(theta.rows())});
  fit(outputs.transpose() * outputs);
  // P = R^-1 - R^-1 1 (1' R^-1 1)^-1 1' R^-1, of rank n - 1.
  const Eigen::Index n = size();
  const Eigen::MatrixXd p = factor_.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n))) - ones_ * ones_.transpose() / ones_.sum();
  const SymmetricEigen eigen = symmetric_eigen(p);
  root_ = eigen.vectors.rightCols(n - 1) * (eigen.values.tail(n - 1).cwiseMax(0.0) / double(n - 1)).cwiseSqrt().asDiagonal();
}

Eigen::VectorXd Kriging::scaled(std::span<const double> theta) const {
  Eigen::VectorXd u(Eigen::Index(theta.size()));
  for (std::size_t k = 0; k < theta.size(); ++k) {
    const Parameter& p = parameters_[k];
    u[Eigen::Index(k)] = p.min > 0 ? std::log(theta[k] / p.min) / std::log(p.max / p.min) : (theta[k] - p.min) / (p.max - p.min);
  }
  return u;
}

Eigen::MatrixXd Kriging::correlation(const Eigen::VectorXd& lengths, double nugget) const {
  const Eigen::MatrixXd u = lengths.cwiseInverse().asDiagonal() * points_;
  Eigen::MatrixXd r(size(), size());
  for (Eigen::Index i = 0; i < size(); ++i)
    for (Eigen::Index j = 0; j < size(); ++j) r(i, j) = std::exp(-0.5 * (u.col(i) - u.col(j)).squaredNorm());
  r.diagonal().array() += nugget;
  return r;
}

double Kriging::deviance(const Eigen::VectorXd& lengths, double nugget, const Eigen::MatrixXd& gram) const {
  const Cholesky factor(correlation(lengths, nugget));
  if (!factor.positive_definite()) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd ones = factor.solve(Eigen::VectorXd(Eigen::VectorXd::Ones(size())));
  const double squares = factor.solve(gram).trace() - ones.dot(gram * ones) / ones.sum();
  const double floor = 1e-12 * gram.trace();  // what is constant over the points has no scatter to learn from
  const double prior = (lengths.array() / usual_length).log().square().sum() / (length_spread * length_spread);
  return double(size() - 1) * std::log(std::max(squares, floor)) + 2 * factor.half_log_determinant() + std::log(ones.sum()) + prior;
}

void Kriging::fit(const Eigen::MatrixXd& gram) {
  lengths_ = Eigen::VectorXd::Constant(points_.rows(), usual_length);
  nugget_ = nuggets[3];
  double best = deviance(lengths_, nugget_, gram);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const double nugget : nuggets)
      if (const double d = deviance(lengths_, nugget, gram); d < best) best = d, nugget_ = nugget;
    for (Eigen::Index k = 0; k < lengths_.size(); ++k) {
      Eigen::VectorXd trial = lengths_;
      for (int i = 0; i < length_steps; ++i) {
        trial[k] = shortest * std::pow(longest / shortest, double(i) / (length_steps - 1));
        if (const double d = deviance(trial, nugget_, gram); d < best) best = d, lengths_[k] = trial[k];
      }
    }
  }
  factor_ = Cholesky(correlation(lengths_, nugget_));
  ones_ = factor_.solve(Eigen::VectorXd(Eigen::VectorXd::Ones(size())));
}

Eigen::VectorXd Kriging::weights(std::span<const double> theta) const {
  const Eigen::VectorXd u = scaled(theta);
  Eigen::VectorXd k(size());
  for (Eigen::Index i = 0; i < size(); ++i) k[i] = std::exp(-0.5 * ((u - points_.col(i)).array() / lengths_.array()).square().sum());
  const Eigen::VectorXd w = factor_.solve(k);
  return w + (1 - w.sum()) / ones_.sum() * ones_;
}

Eigen::MatrixXd Kriging::weights_at(const Eigen::MatrixXd& thetas) const {
  Eigen::MatrixXd k(size(), thetas.cols());
  const Eigen::VectorXd inverse = lengths_.cwiseInverse();
  for (Eigen::Index j = 0; j < k.cols(); ++j) {
    const Eigen::VectorXd u = scaled({thetas.col(j).data(), std::size_t(thetas.rows())});
    for (Eigen::Index i = 0; i < size(); ++i) k(i, j) = -0.5 * (u - points_.col(i)).cwiseProduct(inverse).squaredNorm();
  }
  Eigen::MatrixXd w = factor_.solve(Eigen::MatrixXd(k.array().exp()));
  w += ones_ / ones_.sum() * (1 - w.colwise().sum().array()).matrix();
  return w;
}

Eigen::VectorXd Kriging::slope(std::span<const double> theta, const Eigen::VectorXd& seen) const {
  Eigen::VectorXd g(Eigen::Index(theta.size()));
  std::vector<double> at(theta.begin(), theta.end());
  for (std::size_t k = 0; k < at.size(); ++k) {  // the weights are smooth: central differences lose nothing
    const Parameter& p = parameters_[k];
    const double h = 1e-5 * (p.max - p.min), middle = at[k];
    const double up = std::min(p.max, middle + h), down = std::max(p.min, middle - h);
    at[k] = up;
    const Eigen::VectorXd above = weights(at);
    at[k] = down;
    g[Eigen::Index(k)] = (above - weights(at)).dot(seen) / (up - down);
    at[k] = middle;
  }
  return g;
}

double Kriging::variance_factor(std::span<const double> theta) const {
  const Eigen::VectorXd u = scaled(theta);
  Eigen::VectorXd k(size());
  for (Eigen::Index i = 0; i < size(); ++i) k[i] = std::exp(-0.5 * ((u - points_.col(i)).array() / lengths_.array()).square().sum());
  const double missing = 1 - ones_.dot(k);
  return std::max(0.0, 1 + nugget_ - k.dot(factor_.solve(k)) + missing * missing / ones_.sum());
}

KrigingError::KrigingError(const Kriging& kriging, Eigen::Index fields, RandomStream& random)
    : kriging_(kriging), frequencies_(waves, kriging.points().rows()), amplitudes_(fields, 2 * waves), seen_(fields, kriging.size()) {
  for (Eigen::Index k = 0; k < frequencies_.cols(); ++k)
    for (Eigen::Index i = 0; i < waves; ++i) frequencies_(i, k) = random.normal() / kriging.lengths()[k];
  for (auto& a : amplitudes_.reshaped()) a = random.normal() / std::sqrt(double(waves));
  for (Eigen::Index i = 0; i < seen_.cols(); ++i) {
    seen_.col(i) = realisation(kriging.points().col(i));
    for (Eigen::Index f = 0; f < fields; ++f) seen_(f, i) += std::sqrt(kriging.nugget()) * random.normal();
  }
}

Eigen::VectorXd KrigingError::realisation(const Eigen::VectorXd& scaled) const {
  const Eigen::ArrayXd phase = (frequencies_ * scaled).array();
  Eigen::VectorXd features(2 * waves);
  features << phase.cos().matrix(), phase.sin().matrix();
  return amplitudes_ * features;
}

Eigen::VectorXd KrigingError::at(std::span<const double> theta) const { return realisation(kriging_.scaled(theta)) - seen_ * kriging_.weights(theta); }

}  // namespace calomel
