#include "inverse/posterior_mode.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Whitened residuals of the data by x.
class DataCost final : public ceres::CostFunction {
 public:
  DataCost(const PosteriorMode& mode, const Eigen::VectorXd& half_widths) : mode_(mode), steps_(half_widths.asDiagonal()) {
    set_num_residuals(int(mode.likelihood().data().size()));
    mutable_parameter_block_sizes()->push_back(int(half_widths.size()));
  }
  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], steps_.rows());
    Eigen::Map<Eigen::VectorXd> r(residuals, num_residuals());
    if (!jacobians || !jacobians[0]) {
      const PosteriorPoint p = mode_.at(x);
      if (p.history.empty()) return false;
      r = mode_.likelihood().errors().whiten(mode_.likelihood().residual(p.theta, p.history));
      return r.allFinite();
    }
    const auto l = mode_.linearise(x, steps_);
    if (!l) return false;
    r = l->residual;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], num_residuals(), steps_.rows()) = l->jacobian;
    return true;
  }

 private:
  const PosteriorMode& mode_;
  Eigen::MatrixXd steps_;
};

class PriorCost final : public ceres::CostFunction {
 public:
  explicit PriorCost(const SearchSpace& space) : space_(space) {
    set_num_residuals(int(space.size()));
    mutable_parameter_block_sizes()->push_back(int(space.size()));
  }
  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(parameters[0], space_.size());
    Eigen::Map<Eigen::VectorXd>(residuals, space_.size()) = space_.prior_residuals(x);
    if (jacobians && jacobians[0])
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], space_.size(), space_.size()) =
          space_.prior_jacobian(x);
    return true;
  }

 private:
  const SearchSpace& space_;
};

/// rho(s) = (nu + p) log(1 + s / nu): minus twice the log density of the multivariate t as a function of chi-squared.
class StudentLoss final : public ceres::LossFunction {
 public:
  StudentLoss(double nu, double p) : nu_(nu), p_(p) {}
  void Evaluate(double s, double rho[3]) const override {
    rho[0] = (nu_ + p_) * std::log1p(s / nu_);
    rho[1] = (nu_ + p_) / (nu_ + s);
    rho[2] = -(nu_ + p_) / ((nu_ + s) * (nu_ + s));
  }

 private:
  double nu_, p_;
};

}  // namespace

SearchSpace::SearchSpace(std::vector<Parameter> parameters) : parameters_(std::move(parameters)), priors_(priors_of(parameters_)) {
  const auto n = Eigen::Index(parameters_.size());
  low_.resize(n), high_.resize(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Parameter& p = parameters_[std::size_t(k)];
    const Prior& prior = priors_[std::size_t(k)];
    const double low = std::max(p.min, prior.low()), high = std::min(p.max, prior.high());
    if (!(low < high)) throw InputError({.problem = "the prior of " + p.name + " has no weight between its bounds", .key = "parameter." + p.name + ".prior"});
    log_.push_back(low > 0 || prior.kind() == "lognormal");
    // A logarithm needs a lower end; a millionth of the upper one is beyond anything that a record tells.
    low_[k] = log_.back() ? std::log(std::max(low, 1e-6 * high)) : low;
    high_[k] = log_.back() ? std::log(high) : high;
    double top = 0;
    if (prior.kind() == "beta") {
      top = -infinity;
      for (int i = 1; i < 1000; ++i) top = std::max(top, prior.log_density(prior.quantile(i / 1000.0)));
      top += 1;
    }
    prior_top_.push_back(top);
  }
}

Eigen::VectorXd SearchSpace::from(std::span<const double> theta) const {
  Eigen::VectorXd x(size());
  for (Eigen::Index k = 0; k < size(); ++k) {
    const double t = theta[std::size_t(k)];
    x[k] = std::clamp(log_[std::size_t(k)] ? std::log(std::max(t, std::exp(low_[k]))) : t, low_[k], high_[k]);
  }
  return x;
}

std::vector<double> SearchSpace::theta(const Eigen::VectorXd& x) const {
  std::vector<double> t;
  for (Eigen::Index k = 0; k < size(); ++k) {
    const Parameter& p = parameters_[std::size_t(k)];
    t.push_back(log_[std::size_t(k)] ? std::clamp(std::exp(x[k]), p.min, p.max) : x[k]);
  }
  return t;
}

Eigen::VectorXd SearchSpace::slope(const Eigen::VectorXd& x) const {
  Eigen::VectorXd s(size());
  for (Eigen::Index k = 0; k < size(); ++k) s[k] = log_[std::size_t(k)] ? std::exp(x[k]) : 1;
  return s;
}

Eigen::VectorXd SearchSpace::mode_slope(const Eigen::VectorXd& x) const {
  Eigen::VectorXd s = slope(x);
  for (Eigen::Index k = 0; k < size(); ++k)
    if (priors_[std::size_t(k)].kind() == "lognormal") s[k] = 1;
  return s;
}

double SearchSpace::log_prior(std::span<const double> theta) const {
  double sum = 0;
  for (std::size_t k = 0; k < priors_.size(); ++k) {
    sum += priors_[k].log_density(theta[k]);
    if (priors_[k].kind() == "lognormal") sum += std::log(theta[k]);
  }
  return sum;
}

Eigen::VectorXd SearchSpace::prior_residuals(const Eigen::VectorXd& x) const {
  const auto t = theta(x);
  Eigen::VectorXd r = Eigen::VectorXd::Zero(size());
  for (Eigen::Index k = 0; k < size(); ++k) {
    const Parameter& p = parameters_[std::size_t(k)];
    const double v = t[std::size_t(k)];
    if (p.prior == "normal" || p.prior == "truncated_normal") r[k] = (v - *p.mean) / *p.sd;
    if (p.prior == "lognormal") r[k] = (x[k] - *p.mu) / *p.sigma;
    if (p.prior == "half_cauchy") r[k] = std::sqrt(2 * std::log1p(v * v / (*p.scale * *p.scale)));
    if (p.prior == "beta") r[k] = std::sqrt(std::max(1e-6, 2 * (prior_top_[std::size_t(k)] - priors_[std::size_t(k)].log_density(v))));
  }
  return r;
}

Eigen::MatrixXd SearchSpace::prior_jacobian(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd by_x = slope(x), r = prior_residuals(x);
  const auto t = theta(x);
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(size(), size());
  for (Eigen::Index k = 0; k < size(); ++k) {
    const Parameter& p = parameters_[std::size_t(k)];
    const double v = t[std::size_t(k)];
    if (p.prior == "normal" || p.prior == "truncated_normal") j(k, k) = by_x[k] / *p.sd;
    if (p.prior == "lognormal") j(k, k) = 1 / *p.sigma;
    if (p.prior == "half_cauchy") j(k, k) = r[k] > 1e-8 ? -priors_[std::size_t(k)].log_density_slope(v) / r[k] * by_x[k] : std::sqrt(2.0) / *p.scale * by_x[k];
    if (p.prior == "beta") j(k, k) = -priors_[std::size_t(k)].log_density_slope(v) / r[k] * by_x[k];
  }
  return j;
}

Eigen::VectorXd SearchSpace::prior_sd(const Eigen::VectorXd& x) const {
  Eigen::VectorXd sd(size());
  const Eigen::VectorXd by_x = slope(x);
  for (Eigen::Index k = 0; k < size(); ++k) {
    const Prior& prior = priors_[std::size_t(k)];
    const double box = (high_[k] - low_[k]) / std::sqrt(12.0);
    if (prior.kind() == "uniform")
      sd[k] = box;
    else if (prior.kind() == "lognormal")
      sd[k] = *parameters_[std::size_t(k)].sigma;
    else
      sd[k] = std::min(box, prior.scale() / by_x[k]);
  }
  return sd;
}

Eigen::VectorXd SearchSpace::secant_widths(const Eigen::VectorXd& x, const Eigen::VectorXd& sds, double factor) const {
  Eigen::VectorXd widths = sds;
  const Eigen::VectorXd by_x = slope(x);
  const auto t = theta(x);
  for (Eigen::Index k = 0; k < size(); ++k) {
    const double scale = secant_scale(parameters_[std::size_t(k)]) * t[std::size_t(k)] / by_x[k], box = high_[k] - low_[k];
    widths[k] = std::clamp(std::max(widths[k], factor * scale), 1e-7 * box, 0.15 * box);
  }
  return widths;
}

Eigen::MatrixXf PosteriorMode::run(const Eigen::MatrixXd& thetas) const {
  evaluations_ += std::size_t(thetas.cols());
  return model_.means(thetas, threads_);
}

Eigen::VectorXd PosteriorMode::log_posteriors(const Eigen::MatrixXd& thetas) const {
  return log_posteriors_of(thetas, likelihood_.residuals(thetas, run(thetas)));
}

Eigen::VectorXd PosteriorMode::log_posteriors_of(const Eigen::MatrixXd& thetas, const Eigen::MatrixXd& r) const {
  Eigen::VectorXd l(thetas.cols());
  for (Eigen::Index i = 0; i < l.size(); ++i) {
    l[i] = -infinity;
    if (!r.col(i).allFinite()) continue;
    l[i] = likelihood_.errors().log_density(r.col(i)) + space_.log_prior({thetas.col(i).data(), std::size_t(thetas.rows())});
    if (std::isnan(l[i])) l[i] = -infinity;
  }
  return l;
}

PosteriorPoint PosteriorMode::at(const Eigen::VectorXd& x) const {
  PosteriorPoint p{.theta = space_.theta(x), .log_posterior = -infinity};
  const Eigen::MatrixXf y = run(Eigen::Map<const Eigen::VectorXd>(p.theta.data(), Eigen::Index(p.theta.size())));
  if (!y.allFinite()) return p;
  p.history.assign(y.data(), y.data() + y.size());
  p.log_posterior = likelihood_.log_likelihood(p.theta, p.history) + space_.log_prior(p.theta);
  return p;
}

std::optional<Linearisation> PosteriorMode::linearise(const Eigen::VectorXd& x, const Eigen::MatrixXd& steps) const {
  const Eigen::Index n = x.size();
  // Each side is shortened on its own, to a twentieth of the step at least on one of them.
  Eigen::MatrixXd points(n, 2 * n + 1);
  Eigen::VectorXd reach(2 * n);
  points.col(2 * n) = x;
  for (Eigen::Index k = 0; k < 2 * n; ++k) {
    const Eigen::VectorXd step = (k % 2 == 0 ? 1.0 : -1.0) * steps.col(k / 2);
    double a = 1;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (step[j] > 0) a = std::min(a, (space_.high()[j] - x[j]) / step[j]);
      if (step[j] < 0) a = std::min(a, (space_.low()[j] - x[j]) / step[j]);
    }
    reach[k] = a > 0.05 ? a : 0;
    points.col(k) = x + reach[k] * step;
  }
  Eigen::MatrixXd thetas(n, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto t = space_.theta(points.col(i));
    thetas.col(i) = Eigen::Map<const Eigen::VectorXd>(t.data(), n);
  }
  const Eigen::MatrixXd r = likelihood_.residuals(thetas, run(thetas));
  if (!r.col(2 * n).allFinite()) return std::nullopt;
  const auto& errors = likelihood_.errors();
  Linearisation l{.x = x, .points = points, .residual = errors.whiten(r.col(2 * n))};
  l.chi2 = l.residual.squaredNorm();
  l.log_posteriors = log_posteriors_of(thetas, r);
  Eigen::MatrixXd along(r.rows(), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    double up = reach[2 * k], down = reach[2 * k + 1];
    if (!r.col(2 * k).allFinite()) up = 0;
    if (!r.col(2 * k + 1).allFinite()) down = 0;
    if (up + down == 0) return std::nullopt;
    along.col(k) = ((up > 0 ? r.col(2 * k) : r.col(2 * n)) - (down > 0 ? r.col(2 * k + 1) : r.col(2 * n))) / (up + down);
  }
  l.jacobian = errors.whiten(along) * inverse(steps);
  return l;
}

Eigen::MatrixXd PosteriorMode::curvature(const Linearisation& l) const {
  const Eigen::MatrixXd prior = space_.prior_jacobian(l.x);
  return likelihood_.errors().weight(l.chi2) * l.jacobian.transpose() * l.jacobian + prior.transpose() * prior;
}

std::optional<PosteriorMode::Mode> PosteriorMode::find(const Eigen::VectorXd& start, const Eigen::VectorXd& half_widths) const {
  if (at(start).history.empty()) return std::nullopt;
  FLAGS_minloglevel = google::GLOG_FATAL;  // a failed evaluation is an answer here, not news
  Eigen::VectorXd x = start.cwiseMax(space_.low()).cwiseMin(space_.high());
  ceres::Problem problem;
  const auto& errors = likelihood_.errors();
  problem.AddResidualBlock(new DataCost(*this, half_widths), std::isinf(errors.freedom()) ? nullptr : new StudentLoss(errors.freedom(), double(errors.size())),
                           x.data());
  problem.AddResidualBlock(new PriorCost(space_), nullptr, x.data());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    problem.SetParameterLowerBound(x.data(), int(k), space_.low()[k]);
    problem.SetParameterUpperBound(x.data(), int(k), space_.high()[k]);
  }
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-9;   // |change of cost| / cost
  options.parameter_tolerance = 1e-7;  // |step| / |x|
  options.gradient_tolerance = 1e-8;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!x.allFinite()) return std::nullopt;
  const PosteriorPoint p = at(x);
  if (p.history.empty()) return std::nullopt;
  return Mode{x, p.log_posterior, int(summary.iterations.size()), summary.termination_type == ceres::CONVERGENCE};
}

double seen_curvature(const Eigen::MatrixXd& points, const Eigen::VectorXd& log_posteriors, const Eigen::VectorXd& best, double log_posterior,
                      const Eigen::MatrixXd& covariance, double greatest) {
  const Cholesky factor(covariance);
  double seen = 0, promised = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double drop = log_posterior - log_posteriors[i];
    const double due = 0.5 * factor.solve_lower(Eigen::VectorXd(points.col(i) - best)).squaredNorm();
    if (!(drop < greatest) || !(due > 0.1)) continue;
    seen += std::max(drop, 0.0), promised += due;
  }
  return promised > 0 ? seen / promised : 1;
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& curvature, const SearchSpace& space, const Eigen::VectorXd& x, bool& limited) {
  const Eigen::Index n = curvature.rows();
  const Eigen::VectorXd width = space.high() - space.low(), prior_sd = space.prior_sd(x);
  limited = true;
  // In units of the priors, where 1 is what was known before.
  const Eigen::MatrixXd unit = prior_sd.asDiagonal() * curvature * prior_sd.asDiagonal();
  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(unit);
  if (eigenvalues[0] > 1e-10 * eigenvalues[n - 1]) {
    const Eigen::MatrixXd c = inverse_symmetric(curvature);
    limited = (c.diagonal().array().sqrt() > width.array() / 4).any();
    if (!limited) return c;
  }
  const Eigen::MatrixXd bounded = curvature + Eigen::MatrixXd((12 / width.array().square()).matrix().asDiagonal());
  return inverse_symmetric(bounded);
}

}  // namespace calomel
