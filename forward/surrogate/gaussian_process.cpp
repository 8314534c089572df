#include "forward/surrogate/gaussian_process.hpp"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>
#include <limits>

#include "base/errors.hpp"
#include "forward/surrogate/matern_kernel.hpp"

namespace calomel {
namespace {

constexpr double sqrt5 = 2.23606797749978969641;

/// Squared distances between the columns of a (features, n) and b (features, m): (n, m).
Eigen::ArrayXXd squared_distances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::ArrayXXd d = Eigen::ArrayXXd::Zero(a.cols(), b.cols());
  for (Eigen::Index f = 0; f < a.rows(); ++f)
    for (Eigen::Index c = 0; c < b.cols(); ++c) d.col(c) += (a.row(f).transpose().array() - b(f, c)).square();
  return d;
}

Eigen::ArrayXXd matern(const Eigen::ArrayXXd& r2) {
  const Eigen::ArrayXXd r = sqrt5 * r2.sqrt();
  return (1 + r + r.square() / 3) * (-r).exp();
}

/// dk / d(r^2) = -5/6 (1 + sqrt5 r) exp(-sqrt5 r)
Eigen::ArrayXXd matern_slope(const Eigen::ArrayXXd& r2) {
  const Eigen::ArrayXXd r = sqrt5 * r2.sqrt();
  return (-5.0 / 6.0) * (1 + r) * (-r).exp();
}

struct NormalPrior {
  double mean, sd;
};
constexpr NormalPrior log_length_prior{0, 1.5}, log_nugget_prior{-8, 4};
constexpr double kappa_sd = 2;

class Posterior final : public ceres::FirstOrderFunction {
 public:
  Posterior(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, const Eigen::VectorXd& kappa0) : x_(x), z_(z), kappa0_(kappa0) {}
  bool Evaluate(const double* p, double* cost, double* gradient) const override {
    Eigen::VectorXd g;
    *cost = negative_log_posterior(x_, z_, kappa0_, Eigen::Map<const Eigen::VectorXd>(p, NumParameters()), gradient ? &g : nullptr);
    if (!std::isfinite(*cost)) return false;
    if (gradient) Eigen::Map<Eigen::VectorXd>(gradient, NumParameters()) = g;
    return true;
  }
  int NumParameters() const override { return int(2 * x_.rows() + 1); }

 private:
  const Eigen::MatrixXd& x_;
  const Eigen::VectorXd &z_, &kappa0_;
};

}  // namespace

Eigen::VectorXd GaussianProcessHyperparameters::packed() const {
  Eigen::VectorXd p(log_length.size() + kappa.size() + 1);
  p << log_length, kappa, log_nugget;
  return p;
}

GaussianProcessHyperparameters GaussianProcessHyperparameters::unpacked(const Eigen::VectorXd& p) {
  const Eigen::Index n = (p.size() - 1) / 2;
  return {p.head(n), p.segment(n, n), p[2 * n]};
}

Warp warp(double x, double kappa) {
  if (std::abs(kappa) < 1e-4) {
    // Series to second order: w = x + kappa x (1 - x) / 2 + kappa^2 (x - 3 x^2 + 2 x^3) / 12.
    const double q = x * (1 - x) / 2, c = (x - 3 * x * x + 2 * x * x * x) / 12;
    return {x + kappa * q + kappa * kappa * c, 1 + kappa * (1 - 2 * x) / 2 + kappa * kappa * (1 - 6 * x + 6 * x * x) / 12, q + 2 * kappa * c};
  }
  const double top = -std::expm1(-kappa * x), bottom = -std::expm1(-kappa), e = std::exp(-kappa * x);
  return {top / bottom, kappa * e / bottom, (x * e - top / bottom * std::exp(-kappa)) / bottom};
}

double negative_log_posterior(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, const Eigen::VectorXd& kappa0, const Eigen::VectorXd& packed,
                              Eigen::VectorXd* gradient) {
  const Eigen::Index features = x.rows(), n = x.cols();
  const auto h = GaussianProcessHyperparameters::unpacked(packed);
  if (!packed.allFinite() || packed.cwiseAbs().maxCoeff() > 30) return std::numeric_limits<double>::infinity();
  Eigen::MatrixXd w(features, n), by_kappa(features, n);
  for (Eigen::Index f = 0; f < features; ++f) {
    const double inverse = std::exp(-h.log_length[f]);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Warp v = warp(x(f, i), h.kappa[f]);
      w(f, i) = v.value * inverse;
      by_kappa(f, i) = v.by_kappa * inverse;
    }
  }
  const Eigen::ArrayXXd r2 = squared_distances(w, w);
  Eigen::MatrixXd R = matern(r2).matrix();
  const double nugget = std::exp(h.log_nugget) + 1e-9;
  R.diagonal().array() += nugget;
  const Cholesky factor(R);
  if (!factor.positive_definite()) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd alpha = factor.solve(z);
  const double variance = z.dot(alpha) / double(n);
  if (!(variance > 0)) return std::numeric_limits<double>::infinity();
  double cost = 0.5 * double(n) * std::log(variance) + factor.half_log_determinant();
  const Eigen::ArrayXd dl = (h.log_length.array() - log_length_prior.mean) / log_length_prior.sd;
  const Eigen::ArrayXd dk = (h.kappa - kappa0).array() / kappa_sd;
  const double dn = (h.log_nugget - log_nugget_prior.mean) / log_nugget_prior.sd;
  cost += 0.5 * (dl.square().sum() + dk.square().sum() + dn * dn);
  if (gradient) {
    // d cost / d p = 1/2 tr((R^-1 - alpha alpha' / variance) dR/dp)
    Eigen::MatrixXd G = factor.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
    G -= alpha * alpha.transpose() / variance;
    const Eigen::ArrayXXd weighted = G.array() * matern_slope(r2);  // symmetric
    gradient->resize(packed.size());
    for (Eigen::Index f = 0; f < features; ++f) {
      double by_length = 0, by_warp = 0;
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::ArrayXd d = w.row(f).transpose().array() - w(f, i);
        by_length += (weighted.col(i) * d.square()).sum();
        by_warp += (weighted.col(i) * d * (by_kappa.row(f).transpose().array() - by_kappa(f, i))).sum();
      }
      (*gradient)[f] = -by_length + dl[f] / log_length_prior.sd;
      (*gradient)[features + f] = by_warp + dk[f] / kappa_sd;
    }
    (*gradient)[2 * features] = 0.5 * G.trace() * std::exp(h.log_nugget) + dn / log_nugget_prior.sd;
  }
  return cost;
}

GaussianProcessHyperparameters fit_hyperparameters(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, const Eigen::VectorXd& kappa0,
                                                   const GaussianProcessHyperparameters& start, int iterations) {
  const ceres::GradientProblem problem(new Posterior(x, z, kappa0));
  ceres::GradientProblemSolver::Options options;
  options.max_num_iterations = iterations;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-5;
  ceres::GradientProblemSolver::Summary summary;
  Eigen::VectorXd p = start.packed();
  const Eigen::VectorXd before = p;
  ceres::Solve(options, problem, p.data(), &summary);
  // A line search that ran into a singular matrix leaves its last good point; a useless one falls back to the start.
  if (!std::isfinite(negative_log_posterior(x, z, kappa0, p, nullptr))) p = before;
  return GaussianProcessHyperparameters::unpacked(p);
}

GaussianProcess::GaussianProcess(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, GaussianProcessHyperparameters hyperparameters)
    : hyperparameters_(std::move(hyperparameters)), points_(scaled(x)) {
  Eigen::MatrixXd R = matern(squared_distances(points_, points_)).matrix();
  R.diagonal().array() += std::exp(hyperparameters_.log_nugget) + 1e-9;
  factor_ = Cholesky(R);
  if (!factor_.positive_definite())
    throw NumericsError("surrogate: the covariance matrix of a Gaussian process is not positive definite; are two runs at the same point?");
  weights_ = factor_.solve(z);
  variance_ = z.dot(weights_) / double(z.size());
  const Eigen::Index n = x.cols(), padded = (n + matern_padding - 1) / matern_padding * matern_padding;
  padded_points_ = Eigen::MatrixXd::Zero(padded, x.rows());
  padded_weights_ = Eigen::VectorXd::Zero(padded);
  padded_points_.topRows(n) = sqrt5 * points_.transpose();
  padded_weights_.head(n) = weights_;
  stretch_ = sqrt5 * (-hyperparameters_.log_length.array()).exp();
}

Eigen::MatrixXd GaussianProcess::scaled(const Eigen::MatrixXd& x) const {
  Eigen::MatrixXd w(x.rows(), x.cols());
  for (Eigen::Index f = 0; f < x.rows(); ++f) {
    const double inverse = std::exp(-hyperparameters_.log_length[f]);
    for (Eigen::Index i = 0; i < x.cols(); ++i) w(f, i) = warp(x(f, i), hyperparameters_.kappa[f]).value * inverse;
  }
  return w;
}

Eigen::VectorXd GaussianProcess::means(const Eigen::MatrixXd& x, InstructionSet isa) const {
  Eigen::VectorXd out(x.cols());
  std::vector<double> scratch(std::size_t(padded_weights_.size() + x.rows() * matern_padding));
  matern_means(isa)({.points = padded_weights_.size(),
                     .features = x.rows(),
                     .at = padded_points_.data(),
                     .weights = padded_weights_.data(),
                     .kappa = hyperparameters_.kappa.data(),
                     .stretch = stretch_.data()},
                    x.data(), x.cols(), out.data(), scratch.data());
  return out;
}

Eigen::VectorXd GaussianProcess::gradient(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd at = scaled(x);
  const Eigen::ArrayXd slope = matern_slope(squared_distances(points_, at)).col(0) * weights_.array();
  Eigen::VectorXd g(x.size());
  for (Eigen::Index f = 0; f < x.size(); ++f) {
    const double dw = warp(x[f], hyperparameters_.kappa[f]).by_x * std::exp(-hyperparameters_.log_length[f]);
    g[f] = 2 * dw * (slope * (at[f] - points_.row(f).transpose().array())).sum();
  }
  return g;
}

double GaussianProcess::variance(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd k = matern(squared_distances(points_, scaled(x))).matrix().col(0);
  const double own = 1 + std::exp(hyperparameters_.log_nugget) + 1e-9;
  return variance_ * std::max(0.0, own - factor_.solve_lower(k).squaredNorm());
}

}  // namespace calomel
