#include "uq/sensitivity/chaos_indices.hpp"

#include <cmath>
#include <limits>

#include "base/errors.hpp"
#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr Eigen::Index values_a_term = 3;
constexpr int greatest_order = 8;

/// All exponents of total degree up to p, (terms, d). The constant comes first.
Eigen::MatrixXi degrees_up_to(Eigen::Index d, int p) {
  std::vector<Eigen::VectorXi> all;
  Eigen::VectorXi a = Eigen::VectorXi::Zero(d);
  const auto go = [&](auto&& self, Eigen::Index k, int left) -> void {
    if (k == d) {
      all.push_back(a);
      return;
    }
    for (int e = 0; e <= left; ++e) {
      a[k] = e;
      self(self, k + 1, left - e);
    }
    a[k] = 0;
  };
  go(go, 0, p);
  Eigen::MatrixXi out(Eigen::Index(all.size()), d);
  for (std::size_t i = 0; i < all.size(); ++i) out.row(Eigen::Index(i)) = all[i].transpose();
  return out;
}

double terms_of(Eigen::Index d, int p) {
  double out = 1;
  for (Eigen::Index k = 1; k <= d; ++k) out *= double(p + k) / double(k);
  return out;
}

Eigen::MatrixXd basis_at(const Eigen::MatrixXd& x, const Eigen::MatrixXi& degrees) {
  const int p = degrees.maxCoeff();
  const Eigen::Index n = x.cols();
  const Eigen::Index d = x.rows();
  std::vector<Eigen::MatrixXd> legendre;  // (n, p + 1) for each parameter
  for (Eigen::Index k = 0; k < d; ++k) {
    Eigen::MatrixXd l = Eigen::MatrixXd::Ones(n, p + 1);
    const Eigen::ArrayXd t = x.row(k).transpose();
    if (p > 0) l.col(1) = t;
    for (int e = 2; e <= p; ++e) l.col(e) = ((2.0 * e - 1) * t * l.col(e - 1).array() - (e - 1.0) * l.col(e - 2).array()) / e;
    for (int e = 0; e <= p; ++e) l.col(e) *= std::sqrt(2.0 * e + 1);
    legendre.push_back(std::move(l));
  }
  Eigen::MatrixXd out = Eigen::MatrixXd::Ones(n, degrees.rows());
  for (Eigen::Index j = 0; j < degrees.rows(); ++j)
    for (Eigen::Index k = 0; k < d; ++k)
      if (degrees(j, k) > 0) out.col(j).array() *= legendre[std::size_t(k)].col(degrees(j, k)).array();
  return out;
}

}  // namespace

ChaosIndices indices_of(const LegendreChaos& chaos) {
  const Eigen::Index d = chaos.degrees.cols();
  ChaosIndices out{Eigen::VectorXd::Zero(d), Eigen::VectorXd::Zero(d)};
  double variance = 0;
  for (Eigen::Index j = 0; j < chaos.degrees.rows(); ++j) {
    const double square = chaos.coefficients[j] * chaos.coefficients[j];
    Eigen::Index present = 0;
    Eigen::Index last = 0;
    for (Eigen::Index k = 0; k < d; ++k) {
      if (chaos.degrees(j, k) == 0) continue;
      ++present;
      last = k;
      out.total_order[k] += square;
    }
    if (present == 0) continue;
    variance += square;
    if (present == 1) out.first_order[last] += square;
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double scale = variance > 0 ? 1 / variance : none;
  out.first_order *= scale;
  out.total_order *= scale;
  return out;
}

Eigen::VectorXd values_of(const LegendreChaos& chaos, const Eigen::MatrixXd& x) { return basis_at(x, chaos.degrees) * chaos.coefficients; }

LegendreChaos fit_chaos(const Eigen::MatrixXd& x, const Eigen::VectorXd& values) {
  const Eigen::Index n = values.size();
  const Eigen::Index d = x.rows();
  expect(x.cols() == n, "one value at each point");
  if (double(n) < double(values_a_term) * terms_of(d, 1)) throw NumericsError("too few runs for a polynomial of first order");
  if (!(values.maxCoeff() > values.minCoeff())) return {};  // the rounded mean of equal values would give them a variance
  const double mean = values.mean();
  const double variance = (values.array() - mean).square().mean();
  LegendreChaos best;
  double least = std::numeric_limits<double>::infinity();
  for (int p = 1; p <= greatest_order && double(values_a_term) * terms_of(d, p) <= double(n); ++p) {
    LegendreChaos chaos{.degrees = degrees_up_to(d, p), .coefficients = {}, .left_out_r2 = 0, .order = p};
    const Eigen::MatrixXd basis = basis_at(x, chaos.degrees);
    const Cholesky normal(basis.transpose() * basis);
    if (!normal.positive_definite()) break;
    chaos.coefficients = normal.solve(Eigen::VectorXd(basis.transpose() * values));
    const Eigen::MatrixXd half = normal.solve_lower(Eigen::MatrixXd(basis.transpose()));
    const Eigen::VectorXd leverage = half.colwise().squaredNorm().transpose();
    const Eigen::ArrayXd left_out = (values - basis * chaos.coefficients).array() / (1 - leverage.array()).max(1e-12);
    const double error = left_out.square().mean();
    chaos.left_out_r2 = variance > 0 ? 1 - error / variance : 0;
    if (error < least) {
      least = error;
      best = std::move(chaos);
    }
  }
  return best;
}

}  // namespace calomel
