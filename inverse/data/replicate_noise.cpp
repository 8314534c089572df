#include "inverse/data/replicate_noise.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <set>

#include "base/linear_algebra.hpp"
#include "base/not_finite.hpp"

namespace calomel {

namespace {

constexpr double smoothing_time = 25e-6;  ///< [s] half width over which the variance may change
constexpr double shrinkage_squares = 10;  ///< squares at which local and mean variance count alike
constexpr double least_white = 0.01;      ///< keeps the covariance regular
constexpr double dropouts = 0.1;          ///< share of a pulse's values that may be absent: the mean record replaces them
constexpr std::array<double, 5> white_shares{least_white, 0.05, 0.15, 0.4, 0.8};

/// The pulses of one observation on the coarse grid.
struct Pulses {
  std::size_t condition = 0;
  std::vector<std::size_t> number;  ///< index into Recordings::pulses
  Eigen::MatrixXd values;           ///< (windows, pulses) of those that are nearly whole, all finite
  Eigen::VectorXd present;          ///< (windows) pulses that have it, those left out of `values` too; at least 1
  Eigen::VectorXd mean;
  Eigen::VectorXd slope;
  bool zeroed = false;
};

std::size_t index_of(const std::vector<std::string>& names, const std::string& name, std::size_t otherwise) {
  const auto it = std::find(names.begin(), names.end(), name);
  return it == names.end() ? otherwise : std::size_t(it - names.begin());
}

/// Where the record times of the problem begin in the recordings.
std::size_t first_record(const Problem& problem, const Recordings& r) {
  return std::size_t(std::lower_bound(r.time.begin(), r.time.end(), problem.time.front() - 1e-12) - r.time.begin());
}

Pulses read_pulses(const Problem& problem, const Decimation& grid, const Recordings& r, std::size_t index) {
  const Observation& o = problem.observations[index];
  Pulses p;
  p.condition = o.condition;
  const std::size_t c = index_of(r.conditions, problem.shape.conditions[o.condition], 0);
  const std::size_t s = index_of(r.sensors, problem.shape.sensors[o.sensor], r.sensors.size());
  expect(s < r.sensors.size(), "the recordings are those of the problem");
  const std::size_t begin = first_record(problem, r), n = problem.time.size();
  const bool from_zero = std::abs(problem.time[0]) < 1e-9 * (1 + problem.time.back());
  p.zeroed = from_zero;
  std::vector<Eigen::VectorXd> columns;
  const auto windows = Eigen::Index(grid.windows(index).size());
  p.present = Eigen::VectorXd::Zero(windows);
  for (std::size_t k = 0; k < r.pulses.size(); ++k) {
    if (!r.recorded(c, s, k)) continue;
    const std::span<const double> record(r.values.data() + r.at(c, s, k, begin), n);
    const Eigen::VectorXd y = grid.apply_record(index, record);
    const Eigen::Array<bool, Eigen::Dynamic, 1> there = y.array().isFinite();
    p.present.array() += there.cast<double>();
    if (double(windows - there.count()) > dropouts * double(windows)) continue;
    p.zeroed = p.zeroed && record[0] == 0;
    p.number.push_back(k);
    columns.push_back(y);
  }
  p.present = p.present.cwiseMax(1);
  p.values.resize(windows, Eigen::Index(columns.size()));
  const Eigen::VectorXd mean_record = grid.apply_record(index, o.mean);  // it has every window, also where each pulse lacks another sample of it
  for (std::size_t k = 0; k < columns.size(); ++k)
    p.values.col(Eigen::Index(k)) = columns[k].array().isFinite().select(columns[k].array(), mean_record.array());
  if (!columns.empty()) p.mean = p.values.rowwise().mean();
  return p;
}

/// a_r - 1 of every pulse of a condition by weighted least squares over the gauges that have it; mean 0. Unknown pulses: 0.
Eigen::VectorXd energies(const std::vector<Pulses>& all, std::size_t condition, std::size_t pulses, const std::vector<double>& precision) {
  Eigen::VectorXd top = Eigen::VectorXd::Zero(Eigen::Index(pulses)), bottom = top;
  // Each gauge sees deviations from the mean of its own pulses: iterate so that gauges with fewer pulses share the scale.
  Eigen::VectorXd a = top;
  for (int sweep = 0; sweep < 20; ++sweep) {
    top.setZero();
    bottom.setZero();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Pulses& p = all[i];
      if (p.condition != condition || p.number.size() < 2) continue;
      double own = 0;
      for (const auto k : p.number) own += a[Eigen::Index(k)] / double(p.number.size());
      const double gg = p.slope.squaredNorm() * precision[i];
      for (std::size_t k = 0; k < p.number.size(); ++k) {
        const double projection = p.slope.dot(p.values.col(Eigen::Index(k)) - p.mean) * precision[i];
        top[Eigen::Index(p.number[k])] += projection + gg * own;
        bottom[Eigen::Index(p.number[k])] += gg;
      }
    }
    double mean = 0, known = 0;
    for (Eigen::Index k = 0; k < a.size(); ++k)
      if (bottom[k] > 0) {
        a[k] = top[k] / bottom[k];
        mean += a[k];
        ++known;
      }
    for (Eigen::Index k = 0; k < a.size(); ++k)
      if (bottom[k] > 0) a[k] -= mean / known;
  }
  return a;
}

Eigen::MatrixXd residuals(const Pulses& p, const Eigen::VectorXd& a) {
  Eigen::MatrixXd e = p.values.colwise() - p.mean;
  double own = 0;
  for (const auto k : p.number) own += a[Eigen::Index(k)] / double(p.number.size());
  for (std::size_t k = 0; k < p.number.size(); ++k) e.col(Eigen::Index(k)) -= (a[Eigen::Index(p.number[k])] - own) * p.slope;
  return e;
}

struct Split {
  std::vector<Eigen::VectorXd> energy;    ///< by condition, a_r - 1
  std::vector<Eigen::MatrixXd> residual;  ///< by observation
  double unexplained = 0;                 ///< sum of log residual variance over observations
};

/// Energies and residuals, the gauges weighted by their residual variance in a second pass.
Split split_energy(const std::vector<Pulses>& all, std::size_t conditions, std::size_t pulses) {
  std::vector<double> precision;
  for (const auto& p : all) precision.push_back(p.number.size() > 1 ? 1 / std::max(1e-300, (p.values.colwise() - p.mean).squaredNorm()) : 0);
  Split s;
  for (int pass = 0; pass < 3; ++pass) {
    s = {};
    for (std::size_t c = 0; c < conditions; ++c) s.energy.push_back(energies(all, c, pulses, precision));
    for (std::size_t i = 0; i < all.size(); ++i) {
      s.residual.push_back(all[i].number.size() > 1 ? residuals(all[i], s.energy[all[i].condition]) : Eigen::MatrixXd());
      if (all[i].number.size() < 2) continue;
      const double squares = std::max(1e-300, s.residual.back().squaredNorm());
      precision[i] = 1 / squares;
      s.unexplained += double(s.residual.back().size()) * std::log(squares);
    }
  }
  return s;
}

/// Local mean square of the residuals over the pulses, smoothed over time and drawn towards the whole record's.
Eigen::VectorXd modulation_of(const Eigen::MatrixXd& e, std::span<const Window> windows, double freedom) {
  const Eigen::VectorXd square = e.rowwise().squaredNorm() / freedom;
  const double mean = square.mean();
  Eigen::VectorXd m(square.size());
  for (Eigen::Index i = 0; i < m.size(); ++i) {
    double sum = 0, weight = 0;
    for (Eigen::Index j = 0; j < m.size(); ++j) {
      const double d = (windows[std::size_t(j)].time - windows[std::size_t(i)].time) / smoothing_time;
      if (std::abs(d) >= 2) continue;
      const double w = std::pow(std::cos(M_PI * d / 4), 2);
      sum += w * square[j];
      weight += w;
    }
    const double squares = weight * freedom, local = squares / (squares + shrinkage_squares);
    m[i] = std::sqrt(std::max(local * sum / weight + (1 - local) * mean, 1e-300));
  }
  return m;
}

double profile_log_likelihood(const Eigen::MatrixXd& u, const Eigen::MatrixXd& covariance) {
  const Cholesky factor(covariance);
  if (!factor.positive_definite()) return -infinity;
  const double n = double(u.rows()), pulses = double(u.cols()) - 1;  // the mean took one pulse's worth
  const double chi2 = factor.solve_lower(u).squaredNorm();
  if (!(chi2 > 0)) return -infinity;
  return -0.5 * n * pulses * std::log(chi2 / (n * pulses)) - pulses * factor.half_log_determinant();
}

Eigen::MatrixXd pulse_covariance(const SeriesNoise& s, std::span<const Window> windows, std::span<const double> record_time, double scale) {
  Eigen::MatrixXd c = scale * filtered_covariance(windows, record_time, s.time, s.white);
  c = s.modulation.asDiagonal() * c * s.modulation.asDiagonal();
  if (!s.zeroed) return c;
  // e(t) - e(0), each with the variance of its own time.
  const Eigen::MatrixXd plain = filtered_covariance(windows, record_time, s.time, s.white);
  const Eigen::MatrixXd zeroed = filtered_covariance(windows, record_time, s.time, s.white, true, record_time[0]);
  const Eigen::MatrixXd difference = plain - zeroed;  // k_i + k_j - 1
  Eigen::VectorXd with_zero = (difference.diagonal().array() + 1) / 2;
  with_zero = scale * s.zero_modulation * s.modulation.cwiseProduct(with_zero);
  c.colwise() -= with_zero;
  c.rowwise() -= with_zero.transpose();
  c.array() += scale * s.zero_modulation * s.zero_modulation;
  return c;
}

/// The first window is a mean over the start, not the start itself; its modulation represents it.
void learn_series(SeriesNoise& s, const Eigen::MatrixXd& e, std::span<const Window> windows, std::span<const double> record_time, double freedom) {
  s.modulation = modulation_of(e, windows, freedom);
  s.zero_modulation = s.modulation[0];
  const Eigen::MatrixXd u = s.modulation.cwiseInverse().asDiagonal() * e;
  const CorrelationFit fit = fit_correlation(u, windows, record_time, s.zeroed, record_time[0]);
  s.time = fit.time;
  s.white = fit.white;
  // The scale: the covariance must give the mean square that was seen.
  const Eigen::MatrixXd unit = filtered_covariance(windows, record_time, s.time, s.white, s.zeroed, record_time[0]);
  s.modulation /= std::sqrt(unit.diagonal().mean());
  s.zero_modulation = s.modulation[0];
  s.pulse = pulse_covariance(s, windows, record_time, 1);
  const double scale = (e.squaredNorm() / freedom) / s.pulse.trace();
  s.pulse *= scale;
  s.modulation *= std::sqrt(scale);
  s.zero_modulation *= std::sqrt(scale);
  const Eigen::VectorXd sd = s.pulse.diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation = sd.cwiseInverse().asDiagonal() * s.pulse * sd.cwiseInverse().asDiagonal();
  s.freedom = freedom * std::pow(double(sd.size()), 2) / correlation.squaredNorm();
}

double split_half_ratio(const std::vector<Pulses>& all, const Split& split) {
  double seen = 0, due = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& e = split.residual[i];
    const Eigen::Index n = e.cols();
    if (n < 4) continue;
    const Eigen::Index half = n / 2;
    const double variance = e.squaredNorm() / double(n - 1);
    const Eigen::VectorXd difference = e.leftCols(half).rowwise().mean() - e.rightCols(n - half).rowwise().mean();
    seen += difference.squaredNorm() / variance;
    due += 1.0 / double(half) + 1.0 / double(n - half);
  }
  return due > 0 ? seen / due : 1;
}

}  // namespace

CorrelationFit fit_correlation(const Eigen::MatrixXd& u, std::span<const Window> windows, std::span<const double> record_time, bool zeroed, double zero_time) {
  expect(u.cols() >= 2 && u.rows() == Eigen::Index(windows.size()), "a correlation is learnt from two pulses or more");
  const double step = record_time.size() > 1 ? record_time[1] - record_time[0] : 1, span = record_time.back() - record_time.front();
  const auto at = [&](double log_time, double white) {
    return profile_log_likelihood(
        u, filtered_covariance(windows, record_time, std::exp(log_time), white, zeroed, zero_time) + 1e-9 * Eigen::MatrixXd::Identity(u.rows(), u.rows()));
  };
  CorrelationFit best{
      0, 1,
      profile_log_likelihood(u, filtered_covariance(windows, record_time, 0, 1, zeroed, zero_time) + 1e-9 * Eigen::MatrixXd::Identity(u.rows(), u.rows()))};
  const double low = std::log(0.3 * step), high = std::log(std::max(step, span / 3));
  constexpr int points = 14;
  const double spacing = (high - low) / (points - 1);
  for (const double white : white_shares)
    for (int k = 0; k < points; ++k)
      if (const double l = at(low + k * spacing, white); l > best.log_likelihood) best = {std::exp(low + k * spacing), white, l};
  if (best.time == 0) return best.time_se = infinity, best;
  const double middle = std::log(best.time);
  const auto [log_time, cost] = boost::math::tools::brent_find_minima([&](double x) { return -at(x, best.white); }, std::max(low, middle - spacing),
                                                                      std::min(high, middle + spacing), 16);
  best.time = std::exp(log_time);
  best.log_likelihood = -cost;
  const double h = 0.05, curvature = (at(log_time - h, best.white) + at(log_time + h, best.white) - 2 * at(log_time, best.white)) / (h * h);
  best.time_se = curvature < 0 ? 1 / std::sqrt(-curvature) : infinity;
  return best;
}

ReplicateNoise learn_noise(const Problem& problem, const Decimation& grid, const Recordings& recordings, const RecordingOptions& options,
                           const Eigen::VectorXd& energy_slope) {
  ReplicateNoise out;
  out.pulses = recordings.pulses;
  const std::size_t conditions = problem.shape.conditions.size(), pulses = recordings.pulses.size();
  std::vector<Pulses> all;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    all.push_back(read_pulses(problem, grid, recordings, i));
    all.back().slope = all.back().mean;
  }
  Split split = split_energy(all, conditions, pulses);
  if (energy_slope.size() > 0) {
    for (std::size_t i = 0; i < all.size(); ++i) all[i].slope = energy_slope.segment(Eigen::Index(grid.offset(i)), Eigen::Index(grid.windows(i).size()));
    if (Split other = split_energy(all, conditions, pulses); other.unexplained < split.unexplained) split = std::move(other);
  }
  out.energy = Eigen::MatrixXd::Ones(Eigen::Index(conditions), Eigen::Index(pulses));
  for (std::size_t c = 0; c < conditions; ++c) out.energy.row(Eigen::Index(c)) += split.energy[c].transpose();
  double freedom = 0;  // a condition's known energies have mean 1
  for (std::size_t c = 0; c < conditions; ++c) {
    std::set<std::size_t> known;
    for (const auto& p : all)
      if (p.condition == c && p.number.size() > 1) known.insert(p.number.begin(), p.number.end());
    if (!known.empty()) freedom += double(known.size() - 1);
  }
  if (freedom > 0) out.energy_sd = std::sqrt((out.energy.array() - 1).square().sum() / freedom);
  out.split_half = split_half_ratio(all, split);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Observation& o = problem.observations[i];
    const auto windows = grid.windows(i);
    SeriesNoise s;
    s.pulses = int(all[i].number.size());
    s.present = all[i].present;
    if (s.pulses >= 2 && split.residual[i].squaredNorm() > 0) {
      s.zeroed = all[i].zeroed;
      s.mean_energy = 1;
      for (const auto k : all[i].number) s.mean_energy += split.energy[o.condition][Eigen::Index(k)] / double(s.pulses);
      // The mean took one pulse; the energies took one number a pulse, shared by the gauges.
      learn_series(s, split.residual[i], windows, grid.record_time(), double(s.pulses - 1));
    } else {
      const auto sd = recordings.noise_of(problem.shape.sensors[o.sensor], options);
      if (!sd)
        throw InputError({.problem = "sensor " + problem.label(o) + " has no two whole pulses that differ, so that its noise is not known",
                          .key = "recordings.noise",
                          .suggestion = "give the sd of the noise in the data's unit"});
      s.pulses = std::max(1, o.pulses);
      s.given = true;
      s.freedom = infinity;
      s.modulation = Eigen::VectorXd::Constant(Eigen::Index(windows.size()), *sd);
      if (options.noise_time > 0) {
        s.time = options.noise_time;
        s.white = least_white;
      }
      s.pulse = *sd * *sd * filtered_covariance(windows, grid.record_time(), s.time, s.white);
    }
    out.series.push_back(std::move(s));
  }
  return out;
}

}  // namespace calomel
