#include "forward/surrogate/lasso.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/errors.hpp"
#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

double soft(double x, double threshold) { return x > threshold ? x - threshold : x < -threshold ? x + threshold : 0.0; }

constexpr int most_rounds = 2000;

}  // namespace

/// The columns met so far, their Gram matrix, and the coefficients on them.
class Lasso::Workspace {
 public:
  explicit Workspace(const Lasso& problem) : A_(problem.A_), b_(problem.b_), place_(std::size_t(A_.cols()), -1), kept_(A_.rows(), 0) {}

  void add(std::span<const Eigen::Index> columns) {
    const Eigen::Index before = Eigen::Index(columns_.size()), now = before + Eigen::Index(columns.size());
    if (now > gram_.rows()) {
      const Eigen::Index room = std::max<Eigen::Index>(now, 2 * gram_.rows());
      gram_.conservativeResize(room, room);
      kept_.conservativeResize(A_.rows(), room);
    }
    for (const auto c : columns) {
      place_[std::size_t(c)] = Eigen::Index(columns_.size());
      kept_.col(Eigen::Index(columns_.size())) = A_.col(c);
      columns_.push_back(c);
    }
    const auto added = kept_.middleCols(before, now - before);
    gram_.block(0, before, now, now - before).noalias() = kept_.leftCols(now).transpose() * added;
    gram_.block(before, 0, now - before, before) = gram_.block(0, before, before, now - before).transpose();
    z_.conservativeResize(now);
    q_.conservativeResize(now);
    z_.tail(now - before).setZero();
    q_.tail(now - before).noalias() = added.transpose() * b_;
  }
  [[nodiscard]] bool holds(Eigen::Index column) const { return place_[std::size_t(column)] >= 0; }
  [[nodiscard]] Eigen::VectorXd residual() const { return b_ - kept_.leftCols(z_.size()) * z_; }
  [[nodiscard]] const std::vector<Eigen::Index>& columns() const { return columns_; }
  [[nodiscard]] const Eigen::VectorXd& z() const { return z_; }

  /// Minimises over the columns met so far, half = lambda / 2.
  void minimise(double half) {
    const Eigen::Index n = z_.size();
    const auto gram = gram_.topLeftCorner(n, n);
    for (int turn = 0; turn < 100; ++turn) {
      Eigen::VectorXd g = q_ - gram * z_;  // A^T r
      for (int sweep = 0; sweep < 10; ++sweep) {
        double change = 0;
        for (Eigen::Index j = 0; j < n; ++j) {
          const double c = gram(j, j);
          if (c <= 0) continue;
          const double next = soft(g[j] + c * z_[j], half) / c, step = next - z_[j];
          if (step == 0) continue;
          z_[j] = next;
          g.noalias() -= step * gram.col(j);
          change = std::max(change, c * step * step);
        }
        if (change < 1e-26 * std::max(b_.squaredNorm(), 1e-300)) break;
      }
      newton(half);
      g = q_ - gram * z_;
      double off = 0;  // how far the optimality conditions are from holding
      for (Eigen::Index j = 0; j < n; ++j) off = std::max(off, z_[j] != 0 ? std::abs(g[j] - std::copysign(half, z_[j])) : std::max(0.0, std::abs(g[j]) - half));
      if (off < 1e-9 * half) return;
    }
  }

 private:
  /// Goes to the minimum of the smooth piece that z lies in, leaving columns where their coefficient reaches 0.
  void newton(double half) {
    std::vector<Eigen::Index> support;
    for (Eigen::Index j = 0; j < z_.size(); ++j)
      if (z_[j] != 0) support.push_back(j);
    while (!support.empty()) {
      const Eigen::Index s = Eigen::Index(support.size());
      Eigen::MatrixXd h(s, s);
      Eigen::VectorXd zs(s), downhill(s);
      for (Eigen::Index i = 0; i < s; ++i) zs[i] = z_[support[std::size_t(i)]];
      for (Eigen::Index k = 0; k < s; ++k)
        for (Eigen::Index i = 0; i < s; ++i) h(i, k) = gram_(support[std::size_t(i)], support[std::size_t(k)]);
      downhill = -(h * zs);
      for (Eigen::Index i = 0; i < s; ++i) downhill[i] += q_[support[std::size_t(i)]] - std::copysign(half, zs[i]);
      h.diagonal().array() += 1e-14 * h.trace() / double(s);
      const Cholesky factor(h);
      if (!factor.positive_definite()) return;
      const Eigen::VectorXd step = factor.solve(downhill);
      if (!step.allFinite()) return;
      double length = 1;
      Eigen::Index leaves = -1;
      for (Eigen::Index i = 0; i < s; ++i)
        if (const double at = -zs[i] / step[i]; at > 0 && at < length) length = at, leaves = i;
      for (Eigen::Index i = 0; i < s; ++i) z_[support[std::size_t(i)]] += length * step[i];
      if (leaves < 0) return;
      z_[support[std::size_t(leaves)]] = 0;
      support.erase(support.begin() + leaves);
    }
  }

  const Eigen::MatrixXd& A_;
  const Eigen::VectorXd& b_;
  std::vector<Eigen::Index> place_, columns_;
  Eigen::MatrixXd gram_, kept_;  ///< larger than in use
  Eigen::VectorXd z_, q_;        ///< q = A^T b
};

Lasso::Lasso(Eigen::MatrixXd A, Eigen::VectorXd b, Eigen::Index unpenalised) : A_(std::move(A)), b_(std::move(b)), unpenalised_(unpenalised) {
  expect(A_.rows() == b_.size() && A_.cols() > 0, "A has a row for each value");
  expect(unpenalised >= -1 && unpenalised < A_.cols(), "the unpenalised column is one of A");
  if (unpenalised >= 0) {
    const Eigen::VectorXd one = A_.col(unpenalised);
    const double norm = one.squaredNorm();
    expect(norm > 0, "the unpenalised column is not 0");
    along_ = one.transpose() * A_ / norm;
    b_along_ = one.dot(b_) / norm;
    A_ -= one * along_;
    b_ -= b_along_ * one;
    A_.col(unpenalised).setZero();
  }
  lambda_max_ = 2 * (A_.transpose() * b_).cwiseAbs().maxCoeff();
}

std::vector<LassoFit> Lasso::path(std::span<const double> lambdas, double gap) const {
  Workspace work(*this);
  std::vector<LassoFit> fits;
  double last = std::numeric_limits<double>::infinity();
  for (const double lambda : lambdas) {
    expect(lambda > 0 && lambda <= last, "lambdas are positive and descend");
    last = lambda;
    const double half = lambda / 2;
    LassoFit fit{.lambda = lambda};
    Eigen::VectorXd r, g;
    for (;;) {
      r = work.residual();
      g.noalias() = A_.transpose() * r;
      // The dual point s r with the largest s <= 1 that is feasible; the gap written so that nothing cancels.
      const double s = std::min(1.0, half / std::max(g.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min()));
      double penalty = 0, difference = (1 - s) * (1 - s) * r.squaredNorm();
      for (std::size_t i = 0; i < work.columns().size(); ++i) {
        const double z = work.z()[Eigen::Index(i)];
        penalty += lambda * std::abs(z);
        difference += lambda * std::abs(z) - 2 * s * z * g[work.columns()[i]];
      }
      fit.objective = r.squaredNorm() + penalty;
      fit.gap = fit.objective > 0 ? std::max(0.0, difference) / fit.objective : 0;
      if (fit.gap <= gap) break;
      if (++fit.rounds > most_rounds)
        throw NumericsError("the lasso did not reach its duality gap: " + std::to_string(fit.gap) + " after " + std::to_string(most_rounds) + " rounds");
      // The columns that violate their condition most join, twice as many as the support holds at most.
      std::vector<Eigen::Index> joining;
      for (Eigen::Index j = 0; j < g.size(); ++j)
        if (!work.holds(j) && std::abs(g[j]) > half) joining.push_back(j);
      const std::size_t most = 10 + work.columns().size();
      if (joining.size() > most) {
        std::nth_element(joining.begin(), joining.begin() + std::ptrdiff_t(most), joining.end(),
                         [&](auto i, auto j) { return std::abs(g[i]) > std::abs(g[j]); });
        joining.resize(most);
        std::sort(joining.begin(), joining.end());
      }
      if (!joining.empty()) work.add(joining);
      work.minimise(half);
    }
    fit.z = Eigen::VectorXd::Zero(A_.cols());
    for (std::size_t i = 0; i < work.columns().size(); ++i) fit.z[work.columns()[i]] = work.z()[Eigen::Index(i)];
    fit.nonzero = std::size_t((fit.z.array() != 0).count());
    if (unpenalised_ >= 0) fit.z[unpenalised_] = b_along_ - along_ * fit.z;
    fits.push_back(std::move(fit));
  }
  return fits;
}

std::vector<double> descending(double high, double low, std::size_t n) {
  std::vector<double> out(n, high);
  for (std::size_t i = 1; i < n; ++i) out[i] = high * std::pow(low / high, double(i) / double(n - 1));
  return out;
}

}  // namespace calomel
