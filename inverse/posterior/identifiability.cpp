#include "inverse/posterior/identifiability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double quantile95 = 1.959964;
constexpr double pinned_share = 0.25;  ///< of the prior sd: below it a direction is the data's own

std::string powers(const std::vector<std::string>& names, const Eigen::VectorXd& exponents) {
  std::string s;
  for (Eigen::Index k = 0; k < exponents.size(); ++k)
    if (std::abs(exponents[k]) >= 0.05) s += fmt::format("{}{}^{:.2f}", s.empty() ? "" : " ", names[std::size_t(k)], exponents[k]);
  return s;
}

Combination combination(const std::string& name, double value, double relative_sd) {
  return {name, value, value * std::exp(-quantile95 * relative_sd), value * std::exp(quantile95 * relative_sd), relative_sd};
}

}  // namespace

Identification identify(const std::vector<Parameter>& parameters, const std::vector<double>& theta, const Eigen::MatrixXd& data,
                        const Eigen::MatrixXd& covariance, const Eigen::VectorXd& prior_sd, const std::vector<std::string>& keys,
                        const std::vector<PowerProduct>& products) {
  Identification out;
  const auto positive = [&](std::size_t k) { return theta[k] > 0; };
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (positive(k) && std::find(keys.begin(), keys.end(), parameters[k].key) != keys.end()) out.parameters.push_back(k);
  if (out.parameters.size() < 2) {
    out.parameters.clear();
    for (std::size_t k = 0; k < parameters.size(); ++k)
      if (positive(k)) out.parameters.push_back(k);
  }
  const auto n = Eigen::Index(out.parameters.size());
  if (n == 0) return out;
  // Everything by the logarithms; what the others may do is part of the covariance, not of the data's own curvature.
  Eigen::VectorXd value(n), before(n);
  std::vector<std::string> names;
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::size_t p = out.parameters[std::size_t(k)];
    value[k] = theta[p];
    before[k] = prior_sd[Eigen::Index(p)] / theta[p];
    names.push_back(parameters[p].name);
  }
  const auto chosen = [&](const Eigen::MatrixXd& m) {
    Eigen::MatrixXd s(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) s(i, j) = m(Eigen::Index(out.parameters[std::size_t(i)]), Eigen::Index(out.parameters[std::size_t(j)]));
    return s;
  };
  const Eigen::MatrixXd hessian = value.asDiagonal() * chosen(data) * value.asDiagonal();
  const Eigen::MatrixXd relative = value.cwiseInverse().asDiagonal() * chosen(covariance) * value.cwiseInverse().asDiagonal();
  const SymmetricEigen eigen = symmetric_eigen(hessian);
  for (Eigen::Index k = n; k-- > 0;) {
    Direction d;
    d.exponents = eigen.vectors.col(k);
    Eigen::Index largest = 0;
    d.exponents.cwiseAbs().maxCoeff(&largest);
    if (d.exponents[largest] < 0) d.exponents = -d.exponents;
    d.value = std::exp((d.exponents.array() * value.array().log()).sum());
    d.data_sd = eigen.values[k] > 1e-12 ? std::sqrt(1 / eigen.values[k]) : std::numeric_limits<double>::infinity();
    d.sd = std::sqrt(std::max(0.0, d.exponents.dot(relative * d.exponents)));
    d.prior_sd = std::sqrt((d.exponents.array() * before.array()).square().sum());
    d.pinned = d.data_sd < pinned_share * d.prior_sd;
    d.product = powers(names, d.exponents);
    out.directions.push_back(std::move(d));
  }
  for (const auto& product : products) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(n);
    double of_values = 1;
    std::size_t found = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto power = product.exponents.find(parameters[out.parameters[std::size_t(k)]].key);
      if (power == product.exponents.end()) continue;
      ++found;
      v[k] = power->second;
      of_values *= std::pow(value[k], power->second);
    }
    if (found < product.exponents.size()) continue;
    out.combinations.push_back(combination(product.name, of_values, std::sqrt(std::max(0.0, v.dot(relative * v)))));
  }
  return out;
}

}  // namespace calomel
