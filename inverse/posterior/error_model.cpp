#include "inverse/posterior/error_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "base/errors.hpp"
#include "base/not_finite.hpp"

namespace calomel {

namespace {

// Of a discrepancy.
constexpr double arrival_share = 0.05;                                        ///< of a gauge's greatest value: it begins where the record passes this
constexpr std::array<double, 6> scales_of_prior{0, 0.1, 0.3, 0.6, 1.2, 2.4};  ///< over the scale of its prior

// Of the numerical noise.
constexpr double least_noise = 1e-3;  ///< of its mean square over the gauge, so that the quiet start of a record is not infinitely sure

auto block(Eigen::MatrixXd& m, const Decimation& grid, std::size_t i) {
  const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
  return m.block(at, at, n, n);
}

auto part(const Eigen::VectorXd& v, const Decimation& grid, std::size_t i) {
  return v.segment(Eigen::Index(grid.offset(i)), Eigen::Index(grid.windows(i).size()));
}

/// What a clock that is late by 1 s does to an observation, on the grid; 0 where it is not known.
Eigen::VectorXd late_by_a_second(const Decimation& grid, std::size_t i, const Observation& o) {
  const Eigen::VectorXd change = grid.apply_record(i, change_when_late(o.mean, grid.record_time()));
  return change.array().isFinite().select(change, 0);
}

/// Root mean square of `amplitude` over `local` seconds, (size).
Eigen::VectorXd local_amplitude(const Decimation& grid, const Eigen::VectorXd& amplitude, double local) {
  const Eigen::VectorXd t = grid.times();
  Eigen::VectorXd sd(t.size());
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
    for (Eigen::Index a = at; a < at + n; ++a) {
      const Eigen::ArrayXd w = (-0.5 * ((t.segment(at, n).array() - t[a]) / local).square()).exp();
      sd[a] = std::sqrt((w * amplitude.segment(at, n).array().square()).sum() / w.sum());
    }
  }
  return sd;
}

/// sd_a sd_b share(gauges) kernel(times). positions: (sensors, 3) [m] of gauges that share exp(-their distance / distance); without them each is for itself.
/// Conditions share it like one place.
Eigen::MatrixXd process(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& sd, const TimeKernel& kernel,
                        const Eigen::MatrixXd& positions = {}, double distance = 1) {
  const Eigen::VectorXd t = grid.times();
  std::vector<Eigen::Index> sensor(std::size_t(t.size()));
  for (std::size_t i = 0; i < grid.observations(); ++i)
    std::fill_n(sensor.begin() + std::ptrdiff_t(grid.offset(i)), grid.windows(i).size(), Eigen::Index(problem.observations[i].sensor));
  const auto share = [&](Eigen::Index a, Eigen::Index b) {
    if (a == b) return 1.0;
    return positions.rows() ? std::exp(-(positions.row(a) - positions.row(b)).norm() / distance) : 0.0;
  };
  Eigen::MatrixXd c(t.size(), t.size());
  for (Eigen::Index a = 0; a < t.size(); ++a)
    for (Eigen::Index b = 0; b < t.size(); ++b) c(a, b) = sd[a] * sd[b] * share(sensor[std::size_t(a)], sensor[std::size_t(b)]) * kernel(std::abs(t[a] - t[b]));
  return c;
}

/// What the mean of n pulses keeps of the noise of one, of two times that n and m pulses have: as of the greater of both, where the fewer are among the more.
template <class Share>
Eigen::MatrixXd over_pulses(const Eigen::VectorXd& present, const Share& share) {
  Eigen::MatrixXd c(present.size(), present.size());
  for (Eigen::Index a = 0; a < present.size(); ++a)
    for (Eigen::Index b = 0; b < present.size(); ++b) c(a, b) = share(std::max(present[a], present[b]));
  return c;
}

}  // namespace

ErrorModel::ErrorModel(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const ErrorOptions& o,
                       const ErrorDirections& directions)
    : grid_(problem, std::size_t(o.values), o.band) {
  for (std::size_t i = 0; i < grid_.observations(); ++i)
    if (grid_.windows(i).empty())
      throw InputError({.problem = fmt::format("sensor {} has too few samples beside the others to be compared at every {} s",
                                               problem.label(problem.observations[i]), number_text(grid_.half_window())),
                        .key = "recordings.exclude",
                        .suggestion = "leave it out, or bring all records to one step of time"});
  const Eigen::VectorXd slope = directions.energy_slope.size() ? Eigen::VectorXd(grid_.apply(directions.energy_slope)) : Eigen::VectorXd();
  noise_ = learn_noise(problem, grid_, recordings, recording_options, slope);
  const auto p = Eigen::Index(grid_.size());
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(p, p);
  data_.resize(p);
  record_noise_.resize(p);
  for (std::size_t i = 0; i < problem.observations.size(); ++i)
    data_.segment(Eigen::Index(grid_.offset(i)), Eigen::Index(grid_.windows(i).size())) =
        grid_.apply_record(i, problem.observations[i].mean) / noise_.series[i].mean_energy;  // strain about proportional to energy: of the order of 0.1 %

  Eigen::MatrixXd of_mean = zero, baseline = Eigen::MatrixXd::Zero(p, Eigen::Index(noise_.series.size())), gain = baseline;
  Eigen::VectorXd energy = Eigen::VectorXd::Zero(p), late = Eigen::VectorXd::Zero(p);
  std::vector<std::string> labels;
  Eigen::MatrixXd own_energy = Eigen::MatrixXd::Zero(p, Eigen::Index(problem.shape.conditions.size()));
  const Eigen::VectorXd& by_energy = slope.size() ? slope : data_;
  const double drift = std::max(1.0, noise_.split_half);
  for (std::size_t i = 0; i < noise_.series.size(); ++i) {
    const SeriesNoise& s = noise_.series[i];
    const Eigen::VectorXd y = part(data_, grid_, i), g = part(by_energy, grid_, i);
    const auto at = Eigen::Index(grid_.offset(i));
    if (s.given)  // the scatter of repeats has it already
      own_energy.col(Eigen::Index(problem.observations[i].condition)).segment(at, y.size()) =
          recording_options.energy_sd.value_or(directions.energy_sd) / std::sqrt(double(s.pulses)) * g;
    block(of_mean, grid_, i) = s.pulse.cwiseProduct(over_pulses(s.present, [&](double n) { return drift / n + o.coherent_noise * o.coherent_noise; }));
    labels.push_back(problem.label(problem.observations[i]));
    baseline.col(Eigen::Index(i)).segment(at, y.size()).setConstant(o.baseline * s.sd());
    gain.col(Eigen::Index(i)).segment(at, y.size()) = o.gain_sd * y;
    energy.segment(at, y.size()) = o.energy_scale_sd * g;
    if (o.trigger_sd > 0) late.segment(at, y.size()) = o.trigger_sd * late_by_a_second(grid_, i, problem.observations[i]);
    record_noise_.segment(at, y.size()).setConstant(o.record_noise * (s.given ? std::sqrt(double(directions.pulses) / double(s.pulses)) : 1));
  }
  add("noise", std::move(of_mean));
  add("baseline", baseline, labels);
  add("gain", gain, labels);
  add("energy scale", energy, {""});
  add("trigger", late, {""});
  add("pulse energy", own_energy, problem.shape.conditions);
  if (directions.gauge_places.size()) add("gauge places", grid_.apply(directions.gauge_places), problem.shape.sensors);
  if (directions.last_difference.size() && o.beyond_rest > 0) {
    const Eigen::VectorXd last = o.beyond_rest * grid_.apply(directions.last_difference).col(0);
    add(beyond_term, process(problem, grid_, local_amplitude(grid_, last, o.amplitude_time), white_noise(grid_)));
  }
  if (directions.mesh > 0) add(mesh_term, directions.mesh * directions.mesh * discrepancy_shape(problem, grid_, data_, {}, o, white_noise(grid_)));
}

void ErrorModel::add(std::string name, Eigen::MatrixXd covariance) {
  if (covariance.diagonal().maxCoeff() > 0) terms_.push_back({std::move(name), std::move(covariance)});
}

void ErrorModel::add(const std::string& name, const Eigen::MatrixXd& changes, const std::vector<std::string>& gauges) {
  expect(std::size_t(changes.cols()) == gauges.size(), "a label for each number");
  add(name, changes * changes.transpose());
  for (Eigen::Index i = 0; i < changes.cols(); ++i)
    if (changes.col(i).squaredNorm() > 0) directions_.push_back({name, gauges[std::size_t(i)], changes.col(i)});
}

Eigen::MatrixXd ErrorModel::covariance() const {
  const auto p = Eigen::Index(grid_.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(p, p);
  for (const auto& t : terms_) sum += t.covariance;
  return sum;
}

double ErrorModel::freedom() const {
  double of_noise = 0, trace = 0, noise = 0;
  for (const auto& s : noise_.series) of_noise += s.freedom;
  for (const auto& t : terms_) {
    trace += t.covariance.trace();
    noise += t.name == "noise" ? t.covariance.trace() : 0;
  }
  if (std::isinf(of_noise) || !(noise > 0)) return infinity;
  const double freedom = of_noise / std::pow(noise / trace, 2);
  return freedom > 1e8 ? infinity : freedom;
}

ErrorModel ErrorModel::with_record_noise(const Eigen::MatrixXd& noise) const {
  return with({record_noise_term, record_noise_.asDiagonal() * noise * record_noise_.asDiagonal()});
}

ErrorModel ErrorModel::with(ErrorTerm term) const {
  ErrorModel out = *this;
  out.add(std::move(term.name), std::move(term.covariance));
  return out;
}

ErrorModel ErrorModel::less(const Eigen::VectorXd& change) const {
  ErrorModel out = *this;
  out.data_ -= change;
  return out;
}

ErrorModel ErrorModel::without(std::string_view name) const {
  ErrorModel out = *this;
  std::erase_if(out.terms_, [&](const ErrorTerm& t) { return t.name == name; });
  std::erase_if(out.directions_, [&](const MarginalDirection& d) { return d.term == name; });
  return out;
}

std::vector<std::pair<std::string, double>> ErrorModel::shares() const {
  std::vector<std::pair<std::string, double>> out;
  double sum = 0;
  for (const auto& t : terms_) {
    out.emplace_back(t.name, t.covariance.trace());
    sum += out.back().second;
  }
  for (auto& [name, share] : out) share /= sum;
  return out;
}

TimeKernel matern32(double time) {
  return [time](double t) {
    const double r = std::sqrt(3.0) * t / time;
    return (1 + r) * std::exp(-r);
  };
}

TimeKernel white_noise(const Decimation& grid) {
  return [half = grid.half_window()](double t) {
    const double x = t / half, a = std::numbers::pi * x;
    return x < 2 ? ((2 - x) * (1 + 0.5 * std::cos(a)) + 1.5 / std::numbers::pi * std::sin(a)) / 3 : 0;
  };
}

double greatest_amplitude(const Eigen::Ref<const Eigen::VectorXd>& record) {
  const double span = record.maxCoeff() - record.minCoeff();
  return span > 0 ? span : record.cwiseAbs().maxCoeff();
}

Eigen::MatrixXd discrepancy_shape(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& data, const Eigen::MatrixXd& positions,
                                  const ErrorOptions& o, const TimeKernel& kernel) {
  const double share = o.arrival_share.value_or(arrival_share);
  Eigen::VectorXd sd = local_amplitude(grid, data, o.amplitude_time);
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
    sd.segment(at, n) = sd.segment(at, n).cwiseMin(greatest_amplitude(data.segment(at, n)));
    const double peak = data.segment(at, n).cwiseAbs().maxCoeff();
    for (Eigen::Index a = at; a < at + n && std::abs(data[a]) <= share * peak; ++a) sd[a] = 0;
  }
  return process(problem, grid, sd, kernel, positions, o.discrepancy_distance);
}

namespace {

/// Scales of a discrepancy over that of its prior, half-normal by the trapezium rule: (scale, weight), the weights over their sum; 0 first.
std::vector<std::pair<double, double>> weighed_scales() {
  std::vector<std::pair<double, double>> all;
  double total = 0;
  for (std::size_t i = 0; i < scales_of_prior.size(); ++i) {
    const double s = scales_of_prior[i], below = i > 0 ? scales_of_prior[i - 1] : s, above = i + 1 < scales_of_prior.size() ? scales_of_prior[i + 1] : s;
    all.emplace_back(s, std::exp(-0.5 * s * s) * (above - below));
    total += all.back().second;
  }
  for (auto& [scale, weight] : all) weight /= total;
  return all;
}

/// `plain` with a discrepancy of every scale but 0 and every correlation time, each with its weight of all. It shows where `there`, (size), is 1, in this share
/// of the records; as large over all of them.
void add_discrepancies(std::vector<WeightedErrors>& out, const ErrorModel& plain, const Problem& problem, const ErrorOptions& o,
                       const Eigen::MatrixXd& positions, const Eigen::VectorXd& there, double share) {
  std::vector<Eigen::MatrixXd> shapes;
  for (const double time : o.discrepancy_times)
    shapes.push_back(there.asDiagonal() * discrepancy_shape(problem, plain.grid(), plain.data(), positions, o, matern32(time)) * there.asDiagonal());
  for (const auto& [s, weight] : weighed_scales()) {
    if (s == 0) continue;
    const double scale = s * o.discrepancy;
    for (const auto& shape : shapes)
      out.push_back({plain.with({"discrepancy", scale * scale / share * shape}), std::log(weight / double(shapes.size())), scale});
  }
}

}  // namespace

std::vector<WeightedErrors> with_discrepancy(const ErrorModel& plain, const Problem& problem, const ErrorOptions& o, const Eigen::MatrixXd& positions) {
  if (!(o.discrepancy > 0)) return {{plain}};
  std::vector<WeightedErrors> out{{plain, std::log(weighed_scales()[0].second)}};
  add_discrepancies(out, plain, problem, o, positions, Eigen::VectorXd::Ones(plain.data().size()), 1);
  return out;
}

std::vector<std::vector<std::size_t>> places_of_discrepancy(const Problem& problem, const Eigen::MatrixXd& positions) {
  std::set<std::size_t> sensors;
  for (const auto& o : problem.observations) sensors.insert(o.sensor);
  if (positions.rows() == 0 || sensors.size() < 3) return {};
  std::set<std::vector<std::size_t>> all;
  for (const std::size_t i : sensors) {
    const auto distance = [&](std::size_t j) {
      return j == i ? std::numeric_limits<double>::infinity() : (positions.row(Eigen::Index(j)) - positions.row(Eigen::Index(i))).norm();
    };
    const auto nearest = *std::min_element(sensors.begin(), sensors.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
    all.insert({i});
    all.insert({std::min(i, nearest), std::max(i, nearest)});
  }
  return {all.begin(), all.end()};
}

std::vector<WeightedErrors> with_local_discrepancy(const ErrorModel& plain, const Problem& problem, const ErrorOptions& o, const Eigen::MatrixXd& positions,
                                                   const std::vector<std::size_t>& place) {
  const Decimation& grid = plain.grid();
  Eigen::VectorXd there = Eigen::VectorXd::Zero(plain.data().size());
  std::size_t records = 0;
  for (std::size_t i = 0; i < grid.observations(); ++i)
    if (std::find(place.begin(), place.end(), problem.observations[i].sensor) != place.end()) {
      there.segment(Eigen::Index(grid.offset(i)), Eigen::Index(grid.windows(i).size())).setOnes();
      ++records;
    }
  expect(records > 0 && o.discrepancy > 0, "a place with a record, and a discrepancy");
  std::vector<WeightedErrors> out;
  add_discrepancies(out, plain, problem, o, positions, there, double(records) / double(grid.observations()));
  for (auto& w : out) w.log_weight -= std::log1p(-weighed_scales()[0].second);
  return out;
}

Eigen::MatrixXd numerical_noise(const Decimation& grid, const Eigen::MatrixXd& residuals, double freedom, double local) {
  expect(std::size_t(residuals.rows()) == grid.size() && freedom > 0, "residuals on the grid, and squares left in them");
  Eigen::MatrixXd c = 0.5 / freedom * residuals * residuals.transpose();
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const auto windows = grid.windows(i);
    const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(windows.size());
    const Eigen::MatrixXd own = residuals.middleRows(at, n);
    const Eigen::VectorXd square = own.rowwise().squaredNorm() / freedom;
    Eigen::VectorXd sd(n);
    for (Eigen::Index a = 0; a < n; ++a) {
      double sum = 0, weight = 0;
      for (Eigen::Index b = 0; b < n; ++b) {
        const double w = std::exp(-0.5 * std::pow((windows[std::size_t(b)].time - windows[std::size_t(a)].time) / local, 2));
        sum += w * square[b];
        weight += w;
      }
      sd[a] = std::sqrt(sum / weight + least_noise * square.mean());
    }
    if (!(sd.minCoeff() > 0)) continue;
    // Autocorrelation over runs and times with the biased divisor, which keeps it positive definite.
    const Eigen::MatrixXd unit = sd.cwiseInverse().asDiagonal() * own;
    Eigen::VectorXd correlation(n);
    for (Eigen::Index lag = 0; lag < n; ++lag) correlation[lag] = unit.topRows(n - lag).cwiseProduct(unit.bottomRows(n - lag)).sum();
    correlation /= correlation[0];
    auto own_block = c.block(at, at, n, n);
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < n; ++b) own_block(a, b) += 0.5 * sd[a] * sd[b] * correlation[std::abs(a - b)];
  }
  return c;
}

}  // namespace calomel
