#include "forward/surrogate/feasibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr std::array<double, 7> multiples{0.25, 0.4, 0.6, 1, 1.5, 2.5, 4};
constexpr double base_weight = 0.05;
constexpr Eigen::Index neighbours = 5;

std::vector<bool> failures_of(const Archive& archive) {
  std::vector<bool> failed;
  for (const auto s : archive.status) failed.push_back(s == RunStatus::failed);
  return failed;
}

}  // namespace

Feasibility::Feasibility(const Archive& archive) : Feasibility(archive.shape.parameters, archive.theta, failures_of(archive)) {}

Feasibility::Feasibility(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const std::vector<bool>& failed)
    : parameters_(parameters), points_(theta.rows(), theta.cols()), failed_(theta.cols()) {
  expect(std::size_t(theta.cols()) == failed.size() && std::size_t(theta.rows()) == parameters.size(), "every run failed or did not");
  for (Eigen::Index i = 0; i < theta.cols(); ++i) {
    points_.col(i) = scaled({theta.col(i).data(), std::size_t(theta.rows())});
    failed_[i] = failed[std::size_t(i)] ? 1 : 0;
    failures_ += failed[std::size_t(i)];
  }
  if (failures_ == 0) return;
  double best = -std::numeric_limits<double>::infinity();
  for (const double multiple : multiples) {
    double log_likelihood = 0, right = 0;
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      const double p = std::clamp(probability(points_.col(i), multiple, i), 1e-9, 1 - 1e-9);
      log_likelihood += std::log(failed_[i] > 0 ? p : 1 - p);
      right += (p >= 0.5) == (failed_[i] > 0);
    }
    if (log_likelihood > best) {
      best = log_likelihood;
      multiple_ = multiple;
      accuracy_ = right / double(points_.cols());
    }
  }
}

Eigen::VectorXd Feasibility::scaled(std::span<const double> theta) const {
  Eigen::VectorXd u(Eigen::Index(theta.size()));
  for (std::size_t k = 0; k < theta.size(); ++k) u[Eigen::Index(k)] = (theta[k] - parameters_[k].min) / (parameters_[k].max - parameters_[k].min);
  return u;
}

double Feasibility::probability(const Eigen::VectorXd& u, double multiple, Eigen::Index without) const {
  std::vector<std::pair<double, Eigen::Index>> squares;
  for (Eigen::Index i = 0; i < points_.cols(); ++i)
    if (i != without) squares.emplace_back((points_.col(i) - u).squaredNorm(), i);
  const double base = double(failures_) / double(points_.cols());
  if (squares.empty()) return base;
  const auto fifth = squares.begin() + std::min<std::ptrdiff_t>(neighbours, std::ptrdiff_t(squares.size())) - 1;
  std::nth_element(squares.begin(), fifth, squares.end());
  const double h2 = std::max(1e-12, multiple * multiple * fifth->first);
  double weight = base_weight, failed = base_weight * base;
  for (const auto& [square, i] : squares) {
    const double w = std::exp(-0.5 * square / h2);
    weight += w;
    failed += w * failed_[i];
  }
  return failed / weight;
}

double Feasibility::failure_probability(std::span<const double> theta) const { return any_failed() ? probability(scaled(theta), multiple_, -1) : 0; }

std::map<std::string, std::size_t> failure_reasons(const Archive& archive) {
  std::map<std::string, std::size_t> reasons;
  for (const auto& message : archive.message) {
    if (message.empty()) continue;
    std::string shape;  // numbers as #, so that the same fault at another step is the same reason
    for (const char c : message) {
      const bool digit =
          std::isdigit(static_cast<unsigned char>(c)) || ((c == '.' || c == '-' || c == '+' || c == 'e') && !shape.empty() && shape.back() == '#');
      if (!digit)
        shape += c;
      else if (shape.empty() || shape.back() != '#')
        shape += '#';
    }
    ++reasons[shape];
  }
  return reasons;
}

Prediction GuardedModel::evaluate(std::span<const double> theta) const {
  if (!feasibility_.feasible(theta))
    return {.ok = false, .message = fmt::format("runs of the campaign failed about here (probability {:.2g})", feasibility_.failure_probability(theta))};
  return model_.evaluate(theta);
}

Eigen::MatrixXf GuardedModel::guarded(const Eigen::MatrixXd& thetas, Eigen::MatrixXf y) const {
  if (feasibility_.any_failed())
    for (Eigen::Index i = 0; i < y.cols(); ++i)
      if (!feasibility_.feasible({thetas.col(i).data(), std::size_t(thetas.rows())})) y.col(i).setConstant(std::numeric_limits<float>::quiet_NaN());
  return y;
}

Eigen::MatrixXf GuardedModel::means(const Eigen::MatrixXd& thetas, int threads) const { return guarded(thetas, model_.means(thetas, threads)); }

Eigen::MatrixXf GuardedModel::coefficients(const Eigen::MatrixXd& thetas) const { return guarded(thetas, model_.coefficients(thetas)); }

}  // namespace calomel
