#include "inverse/likelihood/kriging.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr double usual_length = 0.3, length_spread = 1.2;  ///< median, and sd of the logarithm, of the lengths before the data
constexpr std::array<double, 6> nuggets{1e-6, 0.01, 0.04, 0.12, 0.4, 1};
constexpr std::array<double, 5> powers{2, 1.6, 1.25, 1, 0.75};
constexpr double shortest = 0.01, longest = 10;
constexpr int length_steps = 21, sweeps = 4;

double kernel(double squared_distance, double power) { return std::exp(-std::pow(0.5 * squared_distance, 0.5 * power)); }

}  // namespace

Kriging::Kriging(std::vector<Parameter> parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& outputs) : parameters_(std::move(parameters)) {
  expect(theta.cols() >= 2 && outputs.cols() == theta.cols() && std::size_t(theta.rows()) == parameters_.size(), "kriging needs two points or more, and an output at each");
  points_.resize(theta.rows(), theta.cols());
  for (Eigen::Index i = 0; i < theta.cols(); ++i) points_.col(i) = scaled({theta.col(i).data(), std::size_t(theta.rows())});
  fit(outputs.transpose() * outputs);
  // P = R^-1 - R^-1 1 (1' R^-1 1)^-1 1' R^-1, of rank n - 1.
  const Eigen::Index n = size();
  const Eigen::MatrixXd p = factor_.solve(Eigen::MatrixXd::Identity(n, n)) - ones_ * ones_.transpose() / ones_.sum();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(p);
  root_ = eigen.eigenvectors().rightCols(n - 1) * (eigen.eigenvalues().tail(n - 1).cwiseMax(0.0) / double(n - 1)).cwiseSqrt().asDiagonal();
}

Eigen::VectorXd Kriging::scaled(std::span<const double> theta) const {
  Eigen::VectorXd u(Eigen::Index(theta.size()));
  for (std::size_t k = 0; k < theta.size(); ++k) {
    const Parameter& p = parameters_[k];
    u[Eigen::Index(k)] = p.min > 0 ? std::log(theta[k] / p.min) / std::log(p.max / p.min) : (theta[k] - p.min) / (p.max - p.min);
  }
  return u;
}

Eigen::MatrixXd Kriging::correlation(const Shape& shape) const {
  const Eigen::MatrixXd u = shape.lengths.cwiseInverse().asDiagonal() * points_;
  Eigen::MatrixXd r(size(), size());
  for (Eigen::Index i = 0; i < size(); ++i)
    for (Eigen::Index j = 0; j <= i; ++j) r(i, j) = r(j, i) = kernel((u.col(i) - u.col(j)).squaredNorm(), shape.power);
  r.diagonal().array() += shape.nugget;
  return r;
}

Eigen::VectorXd Kriging::correlation_with(std::span<const double> theta) const {
  const Eigen::VectorXd u = scaled(theta);
  Eigen::VectorXd k(size());
  for (Eigen::Index i = 0; i < size(); ++i) k[i] = kernel(((u - points_.col(i)).array() / fitted_.lengths.array()).square().sum(), fitted_.power);
  return k;
}

double Kriging::deviance(const Shape& shape, const Eigen::MatrixXd& gram) const {
  const Eigen::LLT<Eigen::MatrixXd> factor(correlation(shape));
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd ones = factor.solve(Eigen::VectorXd::Ones(size()));
  const double squares = factor.solve(gram).trace() - ones.dot(gram * ones) / ones.sum();
  const double floor = 1e-12 * gram.trace();  // what is constant over the points has no scatter to learn from
  const double prior = (shape.lengths.array() / usual_length).log().square().sum() / (length_spread * length_spread);
  return double(size() - 1) * std::log(std::max(squares, floor)) + 2 * factor.matrixLLT().diagonal().array().log().sum() + std::log(ones.sum()) + prior;
}

void Kriging::fit(const Eigen::MatrixXd& gram) {
  double least = std::numeric_limits<double>::infinity();
  for (const double power : powers) {  // each from the same start: the lengths that suit one power do not suit another
    Shape shape{Eigen::VectorXd::Constant(points_.rows(), usual_length), power, nuggets[3]};
    const double d = descend(shape, gram);
    if (fitted_.lengths.size() == 0 || d < least) least = d, fitted_ = shape;
  }
  factor_.compute(correlation(fitted_));
  ones_ = factor_.solve(Eigen::VectorXd::Ones(size()));
}

double Kriging::descend(Shape& shape, const Eigen::MatrixXd& gram) const {
  double best = deviance(shape, gram);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    Shape trial = shape;
    for (const double nugget : nuggets) {
      trial.nugget = nugget;
      if (const double d = deviance(trial, gram); d < best) best = d, shape.nugget = nugget;
    }
    for (Eigen::Index k = 0; k < shape.lengths.size(); ++k) {
      trial = shape;
      for (int i = 0; i < length_steps; ++i) {
        trial.lengths[k] = shortest * std::pow(longest / shortest, double(i) / (length_steps - 1));
        if (const double d = deviance(trial, gram); d < best) best = d, shape.lengths[k] = trial.lengths[k];
      }
    }
  }
  return best;
}

Eigen::VectorXd Kriging::weights(std::span<const double> theta) const {
  const Eigen::VectorXd w = factor_.solve(correlation_with(theta));
  return w + (1 - w.sum()) / ones_.sum() * ones_;
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
  const Eigen::VectorXd k = correlation_with(theta);
  const double missing = 1 - ones_.dot(k);
  return std::max(0.0, 1 + fitted_.nugget - k.dot(factor_.solve(k)) + missing * missing / ones_.sum());
}

}  // namespace calomel
