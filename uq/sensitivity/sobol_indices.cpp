#include "uq/sensitivity/sobol_indices.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/not_finite.hpp"
#include "base/random.hpp"
#include "forward/campaign/design.hpp"
#include "uq/convergence/diagnostics.hpp"

namespace calomel {

namespace {

constexpr double outside = 0.025;        ///< share of the bootstrap's draws on either side of the interval
constexpr Eigen::Index fewest_rows = 8;  ///< least number of rows for a bootstrap

void put_interval(SensitivityIndex& index, const std::vector<double>& resampled) {
  index.low = quantile(resampled, outside);
  index.high = quantile(resampled, 1 - outside);
}

}  // namespace

SobolIndices sobol_indices(const SobolRows& rows, std::uint64_t seed, int resamples) {
  const Eigen::Index n = rows.variance.size();
  const Eigen::Index d = rows.alone.cols();
  expect(rows.alone.rows() == n && rows.total.rows() == n && rows.total.cols() == d, "rows of one design");
  SobolIndices out;
  out.variance = n ? rows.variance.mean() : 0;
  out.first_order.assign(std::size_t(d), {nan, nan, nan});
  out.total_order = out.first_order;
  if (!(out.variance > 0)) return out;
  for (Eigen::Index k = 0; k < d; ++k) {
    out.first_order[std::size_t(k)].value = 1 - rows.alone.col(k).mean() / out.variance;
    out.total_order[std::size_t(k)].value = rows.total.col(k).mean() / out.variance;
  }
  if (n < fewest_rows) return out;
  // All parameters share the resampled rows.
  RandomStream random(seed, 0x50b0);
  std::vector<std::vector<double>> first(static_cast<std::size_t>(d));
  std::vector<std::vector<double>> total(static_cast<std::size_t>(d));
  for (int r = 0; r < resamples; ++r) {
    double v = 0;
    Eigen::VectorXd a = Eigen::VectorXd::Zero(d);
    Eigen::VectorXd t = a;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = std::min(n - 1, Eigen::Index(random.uniform() * double(n)));
      v += rows.variance[k];
      a += rows.alone.row(k).transpose();
      t += rows.total.row(k).transpose();
    }
    if (!(v > 0)) continue;
    for (Eigen::Index k = 0; k < d; ++k) {
      first[std::size_t(k)].push_back(1 - a[k] / v);
      total[std::size_t(k)].push_back(t[k] / v);
    }
  }
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (first[k].empty()) continue;
    put_interval(out.first_order[k], first[k]);
    put_interval(out.total_order[k], total[k]);
  }
  return out;
}

Eigen::MatrixXd sobol_rows_design(std::size_t dimensions, std::size_t n, std::uint64_t seed) {
  const auto d = Eigen::Index(dimensions);
  const Eigen::MatrixXd both = space_filling_points(2 * dimensions, n, seed);
  Eigen::MatrixXd out(d, Eigen::Index(n) * (d + 2));
  for (Eigen::Index i = 0; i < Eigen::Index(n); ++i) {
    const Eigen::Index at = i * (d + 2);
    out.col(at) = both.col(i).head(d);
    out.col(at + 1) = both.col(i).tail(d);
    for (Eigen::Index k = 0; k < d; ++k) {
      out.col(at + 2 + k) = both.col(i).head(d);
      out(k, at + 2 + k) = both(d + k, i);
    }
  }
  return out;
}

SobolCurves::SobolCurves(Eigen::Index values, Eigen::Index dimensions)
    : variance_(Eigen::VectorXd::Zero(values)), alone_(Eigen::MatrixXd::Zero(values, dimensions)), total_(Eigen::MatrixXd::Zero(values, dimensions)) {}

void SobolCurves::add(const Eigen::MatrixXd& f) {
  if (!f.allFinite()) return;
  ++rows_;
  variance_ += 0.5 * (f.col(0) - f.col(1)).cwiseAbs2();
  for (Eigen::Index k = 0; k < alone_.cols(); ++k) {
    alone_.col(k) += 0.5 * (f.col(1) - f.col(2 + k)).cwiseAbs2();
    total_.col(k) += 0.5 * (f.col(0) - f.col(2 + k)).cwiseAbs2();
  }
}

Eigen::MatrixXd SobolCurves::first_order() const { return 1 - (alone_.array().colwise() / variance_.array()); }
Eigen::MatrixXd SobolCurves::total_order() const { return total_.array().colwise() / variance_.array(); }

}  // namespace calomel
