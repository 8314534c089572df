#include "inverse/likelihood/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace calomel {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Block of one observation in a matrix of all values.
auto block(Eigen::MatrixXd& m, const Decimation& grid, std::size_t i) {
  const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
  return m.block(at, at, n, n);
}

auto part(const Eigen::VectorXd& v, const Decimation& grid, std::size_t i) {
  return v.segment(Eigen::Index(grid.offset(i)), Eigen::Index(grid.windows(i).size()));
}

/// Noise of the mean: falls with the pulses, but for the coherent share; and the baseline.
Eigen::MatrixXd mean_noise(const ReplicateNoise& noise, const Decimation& grid, const LikelihoodOptions& options) {
  const auto p = Eigen::Index(grid.size());
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(p, p);
  const double drift = std::max(1.0, noise.split_half);
  for (std::size_t i = 0; i < noise.series.size(); ++i) {
    const SeriesNoise& s = noise.series[i];
    if (s.given)
      block(c, grid, i) = s.pulse / double(s.pulses);
    else
      block(c, grid, i) = s.pulse * (drift / double(s.pulses) + options.coherent_noise * options.coherent_noise);
  }
  return c;
}

Eigen::MatrixXd baselines(const ReplicateNoise& noise, const Decimation& grid, const LikelihoodOptions& options) {
  const auto p = Eigen::Index(grid.size());
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t i = 0; i < noise.series.size(); ++i)
    if (!noise.series[i].given) block(c, grid, i).array() += std::pow(options.baseline * noise.series[i].sd(), 2);
  return c;
}

/// Variances of model values as a process along each record whose correlation is a sum of two exponentials: most of what a jitter changes is forgotten
/// within microseconds, the rest rings on with the structure.
Eigen::MatrixXd along_records(const Eigen::VectorXd& variance, const Decimation& grid, const LikelihoodOptions& options) {
  const auto p = Eigen::Index(grid.size());
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(p, p);
  const Eigen::VectorXd sd = grid.apply(variance).col(0).cwiseMax(0.0).cwiseSqrt();
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const Eigen::VectorXd m = part(sd, grid, i);
    const auto with = [&](double time) { return filtered_covariance(grid.windows(i), grid.record_time(), time, 0); };
    const double slow = options.floor_slow_share;
    block(c, grid, i) = m.asDiagonal() * ((1 - slow) * with(options.floor_time) + slow * with(options.floor_slow_time)) * m.asDiagonal();
  }
  return c;
}

}  // namespace

ErrorDistribution::ErrorDistribution(const Eigen::MatrixXd& covariance, double freedom) : variance_(covariance.diagonal()), freedom_(freedom) {
  expect(covariance.rows() > 0 && covariance.rows() == covariance.cols() && freedom > 0, "a covariance is square");
  if (!(variance_.minCoeff() > 0)) throw NumericsError("the covariance of the data has a variance that is not positive");
  factor_ = Cholesky(covariance);
  if (!factor_.positive_definite()) throw NumericsError("the covariance of the data is not positive definite");
  const Eigen::VectorXd inverse = variance_.cwiseSqrt().cwiseInverse();
  const double p = double(size());
  effective_data_ = p * p / (inverse.asDiagonal() * covariance * inverse.asDiagonal()).squaredNorm();
  const double half_log_det = factor_.half_log_determinant();
  log_norm_ = std::isinf(freedom) ? -0.5 * p * std::log(2 * std::numbers::pi) - half_log_det
                                  : std::lgamma((freedom + p) / 2) - std::lgamma(freedom / 2) - 0.5 * p * std::log(freedom * std::numbers::pi) - half_log_det;
}

double ErrorDistribution::log_density_at(double chi2) const {
  if (std::isinf(freedom_)) return log_norm_ - 0.5 * chi2;
  return log_norm_ - 0.5 * (freedom_ + double(size())) * std::log1p(chi2 / freedom_);
}

double ErrorDistribution::weight(double chi2) const { return std::isinf(freedom_) ? 1 : (freedom_ + double(size())) / (freedom_ + chi2); }

Eigen::VectorXd ErrorDistribution::gradient(const Eigen::VectorXd& residual) const { return -weight(chi2(residual)) * factor_.solve(residual); }

double ErrorDistribution::effective_chi2(const Eigen::VectorXd& residual) const {
  return effective_data_ * (residual.array().square() / variance_.array()).mean();
}

Likelihood::Likelihood(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const LikelihoodOptions& options,
                       const ModelError& e)
    : grid_(problem, std::size_t(options.values), options.band), mesh_(e.mesh) {
  const Eigen::VectorXd slope = e.energy_slope.size() ? Eigen::VectorXd(grid_.apply(e.energy_slope)) : Eigen::VectorXd();
  noise_ = learn_noise(problem, grid_, recordings, recording_options, slope);
  const auto p = Eigen::Index(grid_.size());
  data_.resize(p);
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    auto y = data_.segment(Eigen::Index(grid_.offset(i)), Eigen::Index(grid_.windows(i).size()));
    y = grid_.apply_record(i, problem.observations[i].mean);
    y /= noise_.series[i].mean_energy;  // strain about proportional to energy: a correction of the order of 0.1 %
  }
  covariance_ = Eigen::MatrixXd::Zero(p, p);
  const auto add = [&](const char* source, const Eigen::MatrixXd& term) {
    covariance_ += term;
    shares_.emplace_back(source, term.trace());
  };
  add("noise", mean_noise(noise_, grid_, options));
  noise_trace_ = shares_[0].second;
  add("baseline", baselines(noise_, grid_, options));

  // Nuisances of the gauges that have repeats: absolute energy (all at once), gain (each).
  Eigen::VectorXd energy = Eigen::VectorXd::Zero(p);
  Eigen::MatrixXd gain = Eigen::MatrixXd::Zero(p, p);
  bool alone = false;
  for (std::size_t i = 0; i < noise_.series.size(); ++i) {
    if (noise_.series[i].given) {
      alone = true;
      continue;
    }
    const auto y = part(data_, grid_, i);
    block(gain, grid_, i) = options.gain_sd * options.gain_sd * y * y.transpose();
    energy.segment(Eigen::Index(grid_.offset(i)), y.size()) = options.energy_scale_sd * y;
  }
  add("energy scale", energy * energy.transpose());
  add("gain", gain);
  if (alone && recording_options.energy_sd) {
    // A single pulse has its own energy; the gauges of a condition saw the same one.
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(p, Eigen::Index(problem.shape.conditions.size()));
    for (std::size_t i = 0; i < noise_.series.size(); ++i)
      if (noise_.series[i].given) {
        const auto y = part(slope.size() ? slope : data_, grid_, i);
        own.col(Eigen::Index(problem.observations[i].condition)).segment(Eigen::Index(grid_.offset(i)), y.size()) =
            *recording_options.energy_sd / std::sqrt(double(noise_.series[i].pulses)) * y;
      }
    add("pulse energy", own * own.transpose());
  }
  if (e.floor_variance.size() && options.floor > 0)
    add("repeatability floor", options.floor * options.floor * along_records(e.floor_variance, grid_, options));
  if (e.surrogate_variance.size()) add("surrogate", along_records(e.surrogate_variance, grid_, options));
  if (e.unknowns.size()) {
    const Eigen::MatrixXd moved = grid_.apply(e.unknowns);
    add("unknowns", moved * moved.transpose());
  }
  if (e.mesh_known.size()) {
    const Eigen::MatrixXd spread = grid_.apply(e.mesh_known);
    add("mesh", spread * spread.transpose());
  }
  for (const auto& s : noise_.series) noise_freedom_ += s.freedom;
  const double total = covariance_.trace();
  for (auto& [source, share] : shares_) share /= total;
  distribute();
}

Likelihood Likelihood::with(const std::string& source, const Eigen::MatrixXd& extra) const {
  Likelihood out = *this;
  const double before = covariance_.trace(), own = extra.trace();
  for (auto& [name, share] : out.shares_) share *= before / (before + own);
  out.shares_.emplace_back(source, own / (before + own));
  out.covariance_ += extra;
  out.distribute();
  return out;
}

Likelihood Likelihood::mean_with(const Likelihood& other) const {
  expect(data_.size() == other.data_.size() && (data_ - other.data_).norm() <= 1e-3 * data_.norm(), "two explanations of the same data");
  Likelihood out = *this;
  const double own = covariance_.trace(), its = other.covariance_.trace();
  for (auto& [name, share] : out.shares_) share *= own / (own + its);
  for (const auto& [name, share] : other.shares_) {
    const auto same = std::find_if(out.shares_.begin(), out.shares_.end(), [&](const auto& s) { return s.first == name; });
    if (same == out.shares_.end())
      out.shares_.emplace_back(name, share * its / (own + its));
    else
      same->second += share * its / (own + its);
  }
  out.covariance_ = 0.5 * (covariance_ + other.covariance_);
  out.noise_trace_ = 0.5 * (noise_trace_ + other.noise_trace_);
  out.distribute();
  return out;
}

Likelihood Likelihood::moved(const Eigen::VectorXd& by) const {
  Likelihood out = *this;
  out.data_ += by;
  return out;
}

Likelihood Likelihood::without_shift() const {
  Likelihood out = *this;
  out.mesh_ = {};
  return out;
}

void Likelihood::distribute() {
  // Only the noise's scale was learnt from repeats: its freedom is diluted by what is known otherwise (Satterthwaite 1946).
  const double share = noise_trace_ / covariance_.trace();
  const double freedom = std::isinf(noise_freedom_) ? infinity : noise_freedom_ / (share * share);
  errors_.emplace(covariance_, freedom > 1e8 ? infinity : freedom);
}

Eigen::VectorXd Likelihood::residual(std::span<const double> theta, std::span<const double> history) const {
  Eigen::VectorXd f = Eigen::Map<const Eigen::VectorXd>(history.data(), Eigen::Index(history.size()));
  if (!mesh_.empty()) f += mesh_.shift(theta);
  return data_ - grid_.apply(f);
}

Eigen::MatrixXd Likelihood::residuals(const Eigen::MatrixXd& thetas, const Eigen::MatrixXf& histories) const {
  Eigen::MatrixXd r(data_.size(), thetas.cols());
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) {
    const Eigen::VectorXd f = histories.col(i).cast<double>();
    r.col(i) = residual({thetas.col(i).data(), std::size_t(thetas.rows())}, {f.data(), std::size_t(f.size())});
  }
  return r;
}

double Likelihood::log_likelihood(std::span<const double> theta, std::span<const double> history) const {
  return errors_->log_density(residual(theta, history));
}

Eigen::VectorXd Likelihood::gradient(std::span<const double> theta, std::span<const double> history) const {
  return grid_.pull_back(-errors_->gradient(residual(theta, history)));
}

}  // namespace calomel
