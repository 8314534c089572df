#include "forward/surrogate/polynomial_basis.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"

namespace calomel {

namespace {

/// Whether products that begin with these degrees belong to the space.
bool belongs(const PolynomialSpace& space, std::span<const int> degrees) {
  long sum = 0, product = 1, levels = 0;
  int largest = 0;
  for (const int i : degrees) {
    sum += i;
    product *= i + 1;
    largest = std::max(largest, i);
    levels += sparse_grid_level(i);
  }
  if (space.kind == "total_degree") return sum <= space.order;
  if (space.kind == "tensor_product") return largest <= space.order;
  if (space.kind == "sparse_grid") return levels <= space.order;
  expect(space.kind == "hyperbolic_cross", "the kind of a polynomial space is known");
  return product <= space.order + 1;
}

/// Calls `take` with every product of the space in lexicographic order until it returns false.
template <class Take>
void for_each_product(const PolynomialSpace& space, std::size_t dimensions, const Take& take) {
  std::vector<int> degrees(dimensions, 0);
  for (;;) {
    if (!take(degrees)) return;
    std::size_t k = dimensions;
    while (k > 0) {
      ++degrees[k - 1];
      if (belongs(space, degrees)) break;
      degrees[--k] = 0;
    }
    if (k == 0) return;
  }
}

constexpr Eigen::Index block = 16;  // points that go through the terms together

}  // namespace

std::size_t PolynomialSpace::terms(std::size_t dimensions, std::size_t cap) const {
  std::size_t n = 0;
  for_each_product(*this, dimensions, [&](const auto&) { return ++n < cap; });
  return n;
}

Eigen::MatrixXi PolynomialSpace::degrees(std::size_t dimensions) const {
  std::vector<int> all;
  for_each_product(*this, dimensions, [&](const auto& degrees) {
    all.insert(all.end(), degrees.begin(), degrees.end());
    return true;
  });
  return Eigen::Map<const Eigen::MatrixXi>(all.data(), Eigen::Index(dimensions), Eigen::Index(all.size() / dimensions));
}

int sparse_grid_level(int degree) { return degree == 0 ? 0 : std::max(1, int(std::bit_width(unsigned(degree - 1)))); }

void chebyshev(double x, std::span<double> value, std::span<double> slope) {
  // T_k and T_k' = k U_{k-1} by their three-term recurrences.
  double t0 = 1, t1 = x, u0 = 0, u1 = 1;
  for (std::size_t k = 0; k < value.size(); ++k) {
    value[k] = k == 0 ? 1 : std::numbers::sqrt2 * t0;
    if (!slope.empty()) slope[k] = k == 0 ? 0 : std::numbers::sqrt2 * double(k) * u0;
    const double t2 = 2 * x * t1 - t0, u2 = 2 * x * u1 - u0;
    t0 = t1;
    t1 = t2;
    u0 = u1;
    u1 = u2;
  }
}

Eigen::MatrixXd basis_matrix(const Eigen::MatrixXi& degrees, const Eigen::MatrixXd& units) {
  expect(degrees.rows() == units.rows(), "points have as many coordinates as the basis");
  const Eigen::Index d = units.rows(), n = units.cols();
  Eigen::MatrixXd a = Eigen::MatrixXd::Ones(n, degrees.cols());
  for (Eigen::Index k = 0; k < d; ++k) {
    const Eigen::Index rows = degrees.row(k).maxCoeff() + 1;
    Eigen::MatrixXd one(rows, n);  // Psi_i of coordinate k at every point
    for (Eigen::Index i = 0; i < n; ++i) chebyshev(2 * units(k, i) - 1, {one.col(i).data(), std::size_t(rows)}, {});
    const Eigen::MatrixXd by_degree = one.transpose();
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      if (degrees(k, j) > 0) a.col(j).array() *= by_degree.col(degrees(k, j)).array();
  }
  return a;
}

Expansion::Expansion(const Eigen::MatrixXi& degrees, const Eigen::VectorXd& coefficients) : highest_(std::size_t(degrees.rows()), 0) {
  expect(degrees.cols() == coefficients.size() && degrees.rows() > 0, "every term has its degrees and its coefficient");
  const std::size_t d = highest_.size();
  for (Eigen::Index j = 0; j < degrees.cols(); ++j) {
    if (coefficients[j] == 0) continue;
    coefficients_.push_back(coefficients[j]);
    for (std::size_t k = 0; k < d; ++k) {
      degrees_.push_back(degrees(Eigen::Index(k), j));
      highest_[k] = std::max(highest_[k], degrees_.back());
    }
    int shared = 0;
    if (const std::size_t now = degrees_.size() - d; now > 0)
      while (std::size_t(shared) < d && degrees_[now + std::size_t(shared)] == degrees_[now - d + std::size_t(shared)]) ++shared;
    shared_.push_back(shared);
  }
}

void Expansion::evaluate(const Eigen::MatrixXd& units, std::span<double> values) const { run<false>(units, values, nullptr); }

void Expansion::evaluate(const Eigen::MatrixXd& units, std::span<double> values, Eigen::MatrixXd& gradients) const {
  gradients.resize(units.rows(), units.cols());
  run<true>(units, values, &gradients);
}

/// Terms in lexicographic order are the leaves of a tree whose level k is the degree in coordinate k. sum[k] gathers all terms that share the
/// degrees before k; when one of those changes, it is multiplied by its polynomial and joins sum[k - 1].
template <bool with_gradient>
void Expansion::run(const Eigen::MatrixXd& units, std::span<double> values, Eigen::MatrixXd* gradients) const {
  const std::size_t d = dimensions(), n = terms();
  expect(std::size_t(units.rows()) == d && std::size_t(units.cols()) == values.size(), "points and values fit the expansion");
  using Lanes = Eigen::Array<double, block, 1>;
  std::vector<std::size_t> first(d);  // where coordinate k begins in the tables
  std::size_t rows = 0;
  for (std::size_t k = 0; k < d; ++k) first[k] = rows, rows += std::size_t(highest_[k]) + 1;
  std::vector<Lanes> psi(rows), slope(with_gradient ? rows : 0), sum(d), by(with_gradient ? d * d : 0);
  std::vector<double> value_1(rows), slope_1(rows);
  for (Eigen::Index at = 0; at < units.cols(); at += block) {
    const Eigen::Index lanes = std::min(block, units.cols() - at);
    for (std::size_t k = 0; k < d; ++k) {
      const std::size_t size = std::size_t(highest_[k]) + 1;
      for (Eigen::Index b = 0; b < block; ++b) {
        const double x = 2 * units(Eigen::Index(k), at + std::min(b, lanes - 1)) - 1;
        chebyshev(x, {value_1.data(), size}, with_gradient ? std::span<double>(slope_1.data(), size) : std::span<double>());
        for (std::size_t i = 0; i < size; ++i) psi[first[k] + i][b] = value_1[i];
        if constexpr (with_gradient)
          for (std::size_t i = 0; i < size; ++i) slope[first[k] + i][b] = 2 * slope_1[i];
      }
    }
    for (auto& s : sum) s.setZero();
    for (auto& s : by) s.setZero();
    // Closes levels down to `level`, which itself remains open; `term` is the last one that was added.
    const auto close = [&](std::size_t term, std::size_t level) {
      for (std::size_t k = d - 1; k > level; --k) {
        const std::size_t p = first[k - 1] + std::size_t(degrees_[term * d + k - 1]);
        if constexpr (with_gradient) {
          by[(k - 1) * d + k - 1] += slope[p] * sum[k];
          for (std::size_t m = k; m < d; ++m) by[(k - 1) * d + m] += psi[p] * by[k * d + m], by[k * d + m].setZero();
        }
        sum[k - 1] += psi[p] * sum[k];
        sum[k].setZero();
      }
    };
    for (std::size_t t = 0; t < n; ++t) {
      if (t > 0 && std::size_t(shared_[t]) + 1 < d) close(t - 1, std::size_t(shared_[t]));
      const std::size_t p = first[d - 1] + std::size_t(degrees_[t * d + d - 1]);
      sum[d - 1] += coefficients_[t] * psi[p];
      if constexpr (with_gradient) by[d * d - 1] += coefficients_[t] * slope[p];
    }
    if (n > 0) close(n - 1, 0);
    for (Eigen::Index b = 0; b < lanes; ++b) {
      values[std::size_t(at + b)] = sum[0][b];
      if constexpr (with_gradient)
        for (std::size_t m = 0; m < d; ++m) (*gradients)(Eigen::Index(m), at + b) = by[m][b];
    }
  }
}

}  // namespace calomel
