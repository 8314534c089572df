#include "forward/emulator/multilevel.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double ridge = 1e-12;   ///< of the greatest diagonal: keeps a coefficient regular that no run determines
constexpr int noise_passes = 30;  ///< of weights and noise in turn; they settle within ten
constexpr double shared_squares =
    0.25;  ///< by how many runs a level's noise leans on that of all, where few runs on the finest mesh leave few squares of their own

}  // namespace

EmulatorBox::EmulatorBox(std::vector<Parameter> parameters, std::span<const double> low, std::span<const double> high) : parameters_(std::move(parameters)) {
  const auto n = Eigen::Index(parameters_.size());
  expect(low.size() == parameters_.size() && high.size() == parameters_.size(), "a box has two ends for every parameter");
  centre_.resize(n);
  half_width_.resize(n);
  for (std::size_t k = 0; k < parameters_.size(); ++k) {
    const double a = parameters_[k].coordinate(low[k]), b = parameters_[k].coordinate(high[k]);
    expect(b > a, "a box is wider than a point");
    centre_[Eigen::Index(k)] = 0.5 * (a + b);
    half_width_[Eigen::Index(k)] = 0.5 * (b - a);
  }
}

Eigen::VectorXd EmulatorBox::u(std::span<const double> theta) const {
  Eigen::VectorXd u(size());
  for (Eigen::Index k = 0; k < size(); ++k) u[k] = (parameters_[std::size_t(k)].coordinate(theta[std::size_t(k)]) - centre_[k]) / half_width_[k];
  return u;
}

std::vector<double> EmulatorBox::theta(const Eigen::VectorXd& u) const {
  std::vector<double> theta(parameters_.size());
  for (Eigen::Index k = 0; k < size(); ++k) theta[std::size_t(k)] = parameters_[std::size_t(k)].natural(centre_[k] + half_width_[k] * u[k]);
  return theta;
}

Eigen::VectorXd EmulatorBox::derivative(const Eigen::VectorXd& u) const {
  Eigen::VectorXd s = half_width_;
  const auto t = theta(u);
  for (Eigen::Index k = 0; k < size(); ++k)
    if (parameters_[std::size_t(k)].logarithmic()) s[k] *= t[std::size_t(k)];
  return s;
}

std::vector<double> EmulatorBox::nearest(std::span<const double> t) const { return theta(u(t).cwiseMax(-1.0).cwiseMin(1.0)); }

Eigen::VectorXd MultilevelRegression::features(const Eigen::VectorXd& u, double beyond) const {
  const Eigen::Index d = u.size();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(coefficients(d, levels_));
  x[0] = 1;
  x.segment(1, d) = u;
  Eigen::Index at = d + 1;
  for (Eigen::Index i = 0; i < d; ++i)
    for (Eigen::Index j = i; j < d; ++j) x[at++] = u[i] * u[j];
  if (levels_ > 1) {
    x[at] = -beyond;
    x.segment(at + 1, d) = -beyond * u;
  }
  return x;
}

Eigen::MatrixXd MultilevelRegression::features_slope(const Eigen::VectorXd& u, double beyond) const {
  const Eigen::Index d = u.size();
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(coefficients(d, levels_), d + 1);
  for (Eigen::Index k = 0; k < d; ++k) s(1 + k, k) = 1;
  Eigen::Index at = d + 1;
  for (Eigen::Index i = 0; i < d; ++i)
    for (Eigen::Index j = i; j < d; ++j, ++at) s(at, i) += u[j], s(at, j) += u[i];
  if (levels_ > 1) {
    s(at, d) = -1;
    s.col(d).segment(at + 1, d) = -u;
    for (Eigen::Index k = 0; k < d; ++k) s(at + 1 + k, k) = -beyond;
  }
  return s;
}

Eigen::VectorXd MultilevelRegression::level_features(const Eigen::VectorXd& u, int level) const {
  const Eigen::Index d = u.size();
  Eigen::VectorXd x = features(u, 0);
  if (level > 0) {
    const Eigen::Index at = coefficients(d, level);
    x[at] = 1;
    x.segment(at + 1, d) = u;
  }
  return x;
}

MultilevelRegression::MultilevelRegression(const EmulatorRuns& runs, const Eigen::MatrixXd& outputs, const Eigen::VectorXd& weights)
    : levels_(runs.levels), parameters_(runs.u.rows()), level_(runs.level), noise_ratio_(std::size_t(runs.levels), 1.0) {
  const Eigen::Index n = runs.u.cols(), p = coefficients(runs.u.rows(), levels_);
  expect(std::size_t(n) == level_.size() && outputs.cols() == n && weights.size() == outputs.rows(), "every run has a place, a level and outputs");
  expect(n > p, "an emulator is trained on more runs than it has coefficients");
  features_.resize(p, n);
  for (Eigen::Index i = 0; i < n; ++i) features_.col(i) = level_features(runs.u.col(i), level_[std::size_t(i)]);
  std::vector<double> noise(std::size_t(levels_), 1.0);
  for (int pass = 0; pass < noise_passes; ++pass) {
    weigh(noise);
    const Eigen::MatrixXd rest = outputs - fit(outputs) * features_;
    Eigen::VectorXd squares(n);
    for (Eigen::Index i = 0; i < n; ++i) squares[i] = rest.col(i).cwiseAbs2().dot(weights);
    if (!(squares.sum() > 0)) break;  // outputs without noise: any weights serve
    const auto next = level_noise(squares, (1 - leverage_.array()).matrix());
    double relative = 0;
    for (std::size_t l = 0; l < next.size(); ++l) relative = std::max(relative, std::abs(next[l] / noise[l] - 1));
    noise = next;
    if (relative < 1e-6) break;
  }
  inverse_ /= noise[0];
  for (std::size_t l = 0; l < noise.size(); ++l) noise_ratio_[l] = noise[l] / noise[0];
}

void MultilevelRegression::weigh(const std::vector<double>& noise) {
  const Eigen::Index n = features_.cols(), p = features_.rows();
  Eigen::VectorXd w(n);
  for (Eigen::Index i = 0; i < n; ++i) w[i] = 1 / noise[std::size_t(level_[std::size_t(i)])];
  Eigen::MatrixXd normal = features_ * w.asDiagonal() * features_.transpose();
  normal.diagonal().array() += ridge * normal.diagonal().maxCoeff();
  inverse_ = Cholesky(normal).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(p, p)));
  gain_ = inverse_ * features_ * w.asDiagonal();
  leverage_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) leverage_[i] = std::min(features_.col(i).dot(gain_.col(i)), 1 - 1e-6);
}

std::vector<double> MultilevelRegression::level_noise(const Eigen::VectorXd& run_squares, const Eigen::VectorXd& run_left) const {
  std::vector<double> squares(std::size_t(levels_), 0.0), left(std::size_t(levels_), 0.0), out(squares.size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const auto l = std::size_t(level_[std::size_t(i)]);
    squares[l] += run_squares[i];
    left[l] += run_left[i];
  }
  double all_squares = 0, all_left = 0;
  for (std::size_t l = 0; l < squares.size(); ++l) all_squares += squares[l], all_left += left[l];
  for (std::size_t l = 0; l < squares.size(); ++l) out[l] = (squares[l] + shared_squares * all_squares / all_left) / (left[l] + shared_squares);
  return out;
}

MultilevelRegression MultilevelRegression::with_noise_ratio(const std::vector<double>& ratio) const {
  expect(ratio.size() == noise_ratio_.size(), "every level has a noise");
  MultilevelRegression out = *this;
  out.noise_ratio_ = ratio;
  out.weigh(ratio);
  return out;
}

Eigen::MatrixXd MultilevelRegression::residuals(const Eigen::MatrixXd& outputs) const {
  Eigen::MatrixXd rest = outputs - fit(outputs) * features_;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) rest.col(i) /= std::sqrt(noise_ratio_[std::size_t(level_[std::size_t(i)])]);
  return rest;
}

Eigen::MatrixXd MultilevelRegression::left_out(const Eigen::MatrixXd& outputs) const {
  Eigen::MatrixXd rest = outputs - fit(outputs) * features_;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) rest.col(i) /= 1 - leverage_[i];
  return rest;
}

Eigen::MatrixXd MultilevelRegression::points(int level) const {
  std::vector<Eigen::Index> of_level;
  for (Eigen::Index i = 0; i < size(); ++i)
    if (level_[std::size_t(i)] == level) of_level.push_back(i);
  return features_(Eigen::seqN(1, parameters_), of_level);
}

MultilevelRegression MultilevelRegression::with_run(const Eigen::VectorXd& u, int level) const {
  MultilevelRegression out = *this;
  const Eigen::VectorXd x = level_features(u, level), hx = inverse_ * x;
  out.inverse_ -= hx * hx.transpose() / (noise_ratio_[std::size_t(level)] + x.dot(hx));  // Sherman and Morrison
  return out;
}

}  // namespace calomel
