#include "uq/diagnosis/first_order.hpp"

#include <algorithm>
#include <cmath>

#include "base/log_sum.hpp"
#include "inverse/posterior/error_density.hpp"

namespace calomel {

namespace {

constexpr double of_the_box = 3;  ///< inverse variance of a coordinate that is uniform on [-1, 1]

Eigen::VectorXd joined(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd out(a.size() + b.size());
  out << a, b;
  return out;
}

/// b^T A^-1 b.
double quadratic(const Cholesky& a, const Eigen::VectorXd& b) { return a.solve_lower(b).squaredNorm(); }

}  // namespace

Eigen::VectorXd numbers_beside(const LogPosterior& posterior, const LogPosterior::Point& at, const AddedDirections& directions, std::size_t j) {
  const Eigen::MatrixXd d = posterior.whiten(Eigen::MatrixXd(directions.by_number * directions.prior_sd.asDiagonal()), at, j);
  const Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(d.cols(), d.cols()) + d.transpose() * d;
  return directions.prior_sd.cwiseProduct(Cholesky(normal).solve(Eigen::VectorXd(d.transpose() * posterior.whitened_residual(at, j))));
}

FirstOrderModel::FirstOrderModel(const LogPosterior& posterior, const LocalMode& mode) : posterior_(posterior), mode_(mode) {
  const Eigen::MatrixXd jacobian = posterior.jacobian(mode.at);
  const auto log_terms = posterior.density(mode.at).log_terms;
  const auto values = double(posterior.values());
  for (std::size_t i = 0; i < posterior.hypotheses(); ++i) {
    Errors e{.log_norm = log_terms[i],
             .freedom = posterior.freedom(i),
             .jacobian = posterior.whiten(jacobian, mode.at, i),
             .residual = posterior.whitened_residual(mode.at, i),
             .factor = {}};
    e.log_norm += penalty_of_errors(e.residual.squaredNorm(), e.freedom, values);
    errors_.push_back(std::move(e));
  }
  const Errors& likeliest = errors_[posterior.likeliest(mode.at)];
  const Eigen::MatrixXd left = inverse_symmetric(mode.covariance) - likeliest.jacobian.transpose() * likeliest.jacobian;
  const SymmetricEigen eigen = symmetric_eigen(0.5 * (left + left.transpose()));
  curvature_ = eigen.vectors * eigen.values.cwiseMax(of_the_box).asDiagonal() * eigen.vectors.transpose();
  gradient_ = -likeliest.jacobian.transpose() * likeliest.residual;
  // Noise of the first hypothesis under another: the trace of its covariance in the other's units.
  const Eigen::Index size = posterior.values();
  const Eigen::MatrixXd root = inverse(posterior.whiten(Eigen::MatrixXd::Identity(size, size), mode.at, 0));
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    Errors& e = errors_[i];
    e.noise = posterior.whiten(root, mode.at, i).squaredNorm();
    e.factor = Cholesky(curvature_ + e.jacobian.transpose() * e.jacobian);
  }
}

FirstOrderModel::Block FirstOrderModel::block(const AddedDirections& directions) const {
  const Eigen::Index n = directions.by_number.cols(), k = posterior_.dimension();
  expect(directions.prior_sd.size() == n && (directions.prior_sd.array() > 0).all(), "every number has a prior");
  const Eigen::MatrixXd by_prior = directions.by_number * directions.prior_sd.asDiagonal();
  Block out;
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    const Eigen::MatrixXd& j = errors_[i].jacobian;
    Eigen::MatrixXd d = posterior_.whiten(by_prior, mode_.at, i), a = Eigen::MatrixXd::Identity(k + n, k + n);
    a.topLeftCorner(k, k) = curvature_ + j.transpose() * j;
    a.bottomRightCorner(n, n) += d.transpose() * d;
    a.bottomLeftCorner(n, k) = d.transpose() * j;
    out.errors.push_back({std::move(d), Cholesky(a)});
    expect(out.errors.back().factor.positive_definite(), "a curvature is positive");
  }
  return out;
}

FirstOrderEstimate FirstOrderModel::estimate(const AddedDirections& directions) const {
  const Block with_block = block(directions);
  const Eigen::Index n = directions.by_number.cols(), k = posterior_.dimension();
  const auto values = double(posterior_.values());
  std::vector<double> with, without;
  std::size_t best = 0;
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    const Errors& e = errors_[i];
    const auto& [d, factor] = with_block.errors[i];
    const double chi2 = e.residual.squaredNorm();
    const Eigen::VectorXd b = e.jacobian.transpose() * e.residual + gradient_;
    without.push_back(e.log_norm - penalty_of_errors(chi2 - quadratic(e.factor, b), e.freedom, values) - e.factor.half_log_determinant());
    with.push_back(e.log_norm - penalty_of_errors(chi2 - quadratic(factor, joined(b, d.transpose() * e.residual)), e.freedom, values) -
                   factor.half_log_determinant());
    if (with[i] > with[best]) best = i;
  }
  const Errors& e = errors_[best];
  const auto& [d, factor] = with_block.errors[best];
  const Eigen::VectorXd at = factor.solve(joined(e.jacobian.transpose() * e.residual + gradient_, d.transpose() * e.residual));
  const Eigen::VectorXd variance = factor.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(k + n, k + n))).diagonal();
  return {.log_bayes_factor = log_sum(with) - log_sum(without),
          .value = directions.prior_sd.cwiseProduct(at.tail(n)),
          .sd = directions.prior_sd.cwiseProduct(variance.tail(n).cwiseSqrt()),
          .shift = at.head(k)};
}

FirstOrderModel::Expected FirstOrderModel::expected(const Block& concealed, Eigen::Index k, const Block& block) const {
  Expected out;
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    const Errors& e = errors_[i];
    const auto& [d, factor] = block.errors[i];
    const Eigen::VectorXd r = concealed.errors[i].d.col(k), b = e.jacobian.transpose() * r;
    out.errors_.push_back({.log_norm = e.log_norm,
                           .freedom = e.freedom,
                           .values = double(posterior_.values()),
                           .noise = e.noise,
                           .chi2 = r.squaredNorm(),
                           .with = quadratic(factor, joined(b, d.transpose() * r)),
                           .without = quadratic(e.factor, b),
                           .half_log_det_with = factor.half_log_determinant(),
                           .half_log_det_without = e.factor.half_log_determinant()});
  }
  return out;
}

double FirstOrderModel::Expected::log_bayes_factor(double strength) const {
  std::vector<double> with, without;
  const double square = strength * strength;
  for (const auto& e : errors_) {
    with.push_back(e.log_norm - penalty_of_errors(e.noise + square * (e.chi2 - e.with), e.freedom, e.values) - e.half_log_det_with);
    without.push_back(e.log_norm - penalty_of_errors(e.noise + square * (e.chi2 - e.without), e.freedom, e.values) - e.half_log_det_without);
  }
  return log_sum(with) - log_sum(without);
}

}  // namespace calomel
