#include "inverse/data/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "base/median.hpp"
#include "base/not_finite.hpp"

namespace calomel {

namespace {

constexpr double narrow_share = 0.01;
constexpr double noise_alone = 3;        ///< a mean square below so much of what noise leaves shows nothing
constexpr double quiet = 0.1;            ///< of the root mean square of the middle gauge
constexpr std::size_t long_enough = 10;  ///< samples of a record by which a gauge is called dead

/// Weights of the derivative at x[i] of the parabola through three neighbours (Lagrange), exact for quadratics.
void add_slope(std::span<const double> x, std::size_t i, double factor, std::size_t first, std::array<double, 4>& weight) {
  if (x.size() == 2) {
    weight[0] -= factor / (x[1] - x[0]);
    weight[1] += factor / (x[1] - x[0]);
    return;
  }
  const std::size_t b = std::clamp<std::size_t>(i, 1, x.size() - 2) - 1;
  for (std::size_t j = b; j < b + 3; ++j) {
    double above = 0, below = 1;
    for (std::size_t k = b; k < b + 3; ++k) {
      if (k == j) continue;
      below *= x[j] - x[k];
      for (std::size_t m = b; m < b + 3; ++m)
        if (m != j && m != k) above += x[i] - x[m];
    }
    weight[j - first] += factor * above / below;
  }
}

/// Cubic Hermite interpolation at t with three-point slopes (Catmull and Rom 1974 on even steps).
Stencil stencil_at(std::span<const double> x, double t) {
  Stencil s;
  if (x.size() == 1) {
    s.weight[0] = 1;
    return s;
  }
  const auto above = std::upper_bound(x.begin(), x.end(), t);
  const std::size_t k = std::clamp<std::size_t>(std::size_t(above - x.begin()), 1, x.size() - 1) - 1;
  const std::size_t first = x.size() <= 4 ? 0 : std::clamp<std::size_t>(k, 1, x.size() - 3) - 1;
  const double h = x[k + 1] - x[k];
  const double u = std::clamp((t - x[k]) / h, 0.0, 1.0);
  for (std::size_t j = 0; j < 4; ++j) s.index[j] = std::uint32_t(std::min(first + j, x.size() - 1));
  if (u < 1e-6 || u > 1 - 1e-6) {
    s.weight[k + (u > 0.5) - first] = 1;
    return s;
  }
  s.weight[k - first] += (1 + 2 * u) * (1 - u) * (1 - u);
  s.weight[k + 1 - first] += u * u * (3 - 2 * u);
  add_slope(x, k, h * u * (1 - u) * (1 - u), first, s.weight);
  add_slope(x, k + 1, h * u * u * (u - 1), first, s.weight);
  return s;
}

std::size_t find_condition(const ModelShape& shape, const Recordings& r, std::size_t c) {
  const auto it = std::find(shape.conditions.begin(), shape.conditions.end(), r.conditions[c]);
  if (it != shape.conditions.end()) return std::size_t(it - shape.conditions.begin());
  if (shape.conditions.size() == 1 && r.conditions.size() == 1 && (r.conditions[0] == "default" || shape.conditions[0] == "default")) return 0;
  throw InputError(
      {.problem = "the condition is recorded but not declared",
       .value = "condition \"" + r.conditions[c] + '"',
       .range = join(shape.conditions),
       .suggestion = "declare it with [[condition]]; of a bar under a measured stress, or a line, put each condition into a file and a case of its own",
       .file = r.source});
}

Observation observe(const Recordings& r, std::size_t c, std::size_t s, std::size_t begin, std::size_t end, const RecordingOptions& options) {
  Observation o;
  for (std::size_t p = 0; p < r.pulses.size(); ++p) o.pulses += r.recorded(c, s, p);
  const auto noise = r.noise_of(r.sensors[s], options);
  if (o.pulses == 1 && !noise)
    throw InputError({.problem = fmt::format("sensor {} has a single pulse, so that its scatter is not known", r.sensors[s]),
                      .key = "recordings.noise",
                      .suggestion = "give the sd of the noise in the data's unit, recordings.noise = ... (one number, or a table by sensor)"});
  const std::size_t n = end - begin;
  o.mean.assign(n, nan), o.low.assign(n, nan), o.high.assign(n, nan);
  o.compared.assign(n, 0), o.banded.assign(n, 0);
  std::vector<double> factor(std::size_t(o.pulses) + 1, nan);
  for (int k = 2; k <= o.pulses; ++k) factor[std::size_t(k)] = band_factor(k, options.band == "mean");
  for (std::size_t t = 0; t < n; ++t) {
    double sum = 0, squares = 0;
    int count = 0;
    for (std::size_t p = 0; p < r.pulses.size(); ++p)
      if (const double v = r.values[r.at(c, s, p, begin + t)]; std::isfinite(v)) sum += v, ++count;
    if (count == 0) continue;
    const double mean = sum / count;
    for (std::size_t p = 0; p < r.pulses.size(); ++p)
      if (const double v = r.values[r.at(c, s, p, begin + t)]; std::isfinite(v)) squares += (v - mean) * (v - mean);
    o.mean[t] = mean;
    o.compared[t] = 1;
    o.peak = std::max(o.peak, std::abs(mean));
    o.mean_square += mean * mean;
    if (count >= 2) {
      const double variance = squares / (count - 1), half = factor[std::size_t(count)] * std::sqrt(variance);
      o.low[t] = mean - half;
      o.high[t] = mean + half;
      o.noise_square += variance / count;
    } else if (noise) {
      o.low[t] = mean - 1.96 * *noise;
      o.high[t] = mean + 1.96 * *noise;
      o.noise_square += *noise * *noise;
    }
  }
  for (std::size_t t = 0; t < n; ++t) {
    if (!o.compared[t]) continue;
    ++o.samples;
    const double width = o.high[t] - o.low[t];
    if (std::isnan(width)) {
      ++o.bandless;
    } else if (width < narrow_share * o.peak || width <= 0) {
      ++o.narrow;
    } else {
      o.banded[t] = 1;
      ++o.banded_samples;
    }
  }
  if (o.samples > 0) {
    o.mean_square /= double(o.samples);
    o.noise_square /= double(o.samples);
  }
  o.mean_f.assign(n, 0), o.weight_f.assign(n, 0), o.low_f.assign(n, 0), o.high_f.assign(n, 0), o.inverse_width_f.assign(n, 0);
  for (std::size_t t = 0; t < n; ++t) {
    if (o.compared[t]) {
      o.mean_f[t] = float(o.mean[t]);
      o.weight_f[t] = 1;
    }
    if (o.banded[t]) {
      o.low_f[t] = float(o.low[t]);
      o.high_f[t] = float(o.high[t]);
      o.inverse_width_f[t] = float(1 / (o.high[t] - o.low[t]));
    }
  }
  return o;
}

/// Two mean records that are equal at every sample, and not 0.
bool same_records(const Observation& a, const Observation& b) {
  return a.peak > 0 && a.samples >= long_enough && a.compared == b.compared && a.mean_f == b.mean_f && a.mean_square == b.mean_square;
}

/// The numbers of two pulses of a gauge that are equal at every sample, and not 0 throughout; none where there are no such two.
std::optional<std::pair<int, int>> equal_pulses(const Recordings& r, std::size_t c, std::size_t s) {
  const std::size_t n = r.time.size();
  if (n < long_enough) return {};
  for (std::size_t p = 0; p < r.pulses.size(); ++p)
    for (std::size_t q = 0; q < p; ++q) {
      const double *a = &r.values[r.at(c, s, p, 0)], *b = &r.values[r.at(c, s, q, 0)];
      if (std::equal(a, a + n, b) && std::any_of(a, a + n, [](double v) { return v != 0; })) return std::pair(r.pulses[q], r.pulses[p]);
    }
  return {};
}

/// The same value at every sample.
bool constant(const Observation& o) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t t = 0; t < o.mean.size(); ++t)
    if (o.compared[t]) {
      low = std::min(low, o.mean[t]);
      high = std::max(high, o.mean[t]);
    }
  return low == high;
}

/// Takes out the dead gauges and lists them. Errors: InputError if all are dead.
void leave_out_dead(Problem& p, const Recordings& recordings) {
  if (p.observations.empty()) return;
  std::vector<double> squares;
  for (const auto& o : p.observations) squares.push_back(o.mean_square);
  const double small = quiet * quiet * upper_median(std::move(squares));
  const bool some_change = !std::ranges::all_of(p.observations, constant);
  const auto dead = [&](const Observation& o) {
    if (o.peak == 0) return true;
    if (o.samples < long_enough) return false;
    return (some_change && constant(o)) || (o.mean_square < noise_alone * o.noise_square && o.mean_square < small);
  };
  for (const auto& o : p.observations)
    if (dead(o)) p.dead.push_back(p.label(o));
  std::erase_if(p.observations, dead);
  if (p.dead.empty()) return;
  if (p.observations.empty())
    throw InputError({.problem = "no sensor records anything: every mean record is 0 throughout",
                      .key = "recordings.file",
                      .suggestion = "see whether the columns are those of the gauges",
                      .file = recordings.source});
}

}  // namespace

double band_factor(int n, bool of_the_mean) {
  expect(n >= 2, "a scatter needs two values");
  const double t = boost::math::quantile(boost::math::students_t(n - 1), 0.975);
  return of_the_mean ? t / std::sqrt(double(n)) : t;
}

std::string Problem::label(const Observation& o) const {
  return shape.conditions.size() > 1 ? shape.sensors[o.sensor] + " (" + shape.conditions[o.condition] + ")" : shape.sensors[o.sensor];
}

Problem make_problem(const ModelShape& shape, const Recordings& recordings, const RecordingOptions& options) {
  Problem p;
  p.shape = shape;
  p.unit = recordings.unit;
  p.warnings = recordings.warnings;
  if (shape.unit != recordings.unit && shape.unit == "strain")
    throw InputError(
        {.problem = "the model gives strain, the recordings are in " + recordings.unit,
         .key = "recordings.unit",
         .suggestion = "give every sensor its gain, " + recordings.unit + " per strain, and set sensor_unit = \"" + recordings.unit + "\" under [case]"});
  if (p.unit != "strain") {
    p.mae_scale = 1;
    p.mae_unit = p.unit;
  }
  for (const auto& [name, sd] : options.noise_by_sensor.sd)
    if (std::find(shape.sensors.begin(), shape.sensors.end(), name) == shape.sensors.end())
      throw InputError({.problem = "noise is given for a sensor that is not declared",
                        .key = "recordings.noise." + name,
                        .value = number_text(sd),
                        .range = join(shape.sensors),
                        .suggestion = name_suggestion(name, shape.sensors)});

  // 1. The record times within the simulation's.
  const double step = shape.times.size() > 1 ? (shape.times.back() - shape.times.front()) / double(shape.times.size() - 1) : 0;
  const double slack = 1e-6 * step;
  std::size_t begin = 0, end = recordings.time.size();
  while (begin < end && recordings.time[begin] < shape.times.front() - slack) ++begin;
  while (end > begin && recordings.time[end - 1] > shape.times.back() + slack) --end;
  if (begin == end)
    throw InputError({.problem = fmt::format("the record ({:.6g} to {:.6g} s) and the simulation ({:.6g} to {:.6g} s) do not overlap", recordings.time.front(),
                                             recordings.time.back(), shape.times.front(), shape.times.back()),
                      .key = "recordings.trigger_offset",
                      .suggestion = "check the unit of time and recordings.trigger_offset"});
  if (end - begin == 1 && recordings.time.size() > 1 && shape.times.size() > 1)
    throw InputError({.problem = fmt::format("a single sample of the record ({:.6g} to {:.6g} s) lies within the simulation ({:.6g} to {:.6g} s)",
                                             recordings.time.front(), recordings.time.back(), shape.times.front(), shape.times.back()),
                      .key = "recordings.file",
                      .suggestion = "check the unit of time and recordings.trigger_offset"});
  p.time.assign(recordings.time.begin() + std::ptrdiff_t(begin), recordings.time.begin() + std::ptrdiff_t(end));
  p.outside = recordings.time.size() - p.time.size();
  if (p.outside > 0)
    p.warnings.push_back(fmt::format("{} of {} record times lie outside of the simulation ({:.6g} to {:.6g} s) and are not compared", p.outside,
                                     recordings.time.size(), shape.times.front(), shape.times.back()));
  p.same_grid = true;
  for (std::size_t t = 0; t < p.time.size(); ++t) {
    p.stencils.push_back(stencil_at(shape.times, p.time[t]));
    std::size_t at = shape.times.size();
    for (std::size_t j = 0; j < 4; ++j)
      if (p.stencils[t].weight[j] == 1) at = p.stencils[t].index[j];
    if (t == 0) p.first = at;
    p.same_grid = p.same_grid && at == p.first + t && at < shape.times.size();
  }

  // 2. Mean and band of every recorded sensor, in the model's order.
  for (std::size_t mc = 0; mc < shape.conditions.size(); ++mc)
    for (std::size_t ms = 0; ms < shape.sensors.size(); ++ms)
      for (std::size_t c = 0; c < recordings.conditions.size(); ++c) {
        if (find_condition(shape, recordings, c) != mc) continue;
        const auto it = std::find(recordings.sensors.begin(), recordings.sensors.end(), shape.sensors[ms]);
        if (it == recordings.sensors.end()) continue;
        Observation o = observe(recordings, c, std::size_t(it - recordings.sensors.begin()), begin, end, options);
        o.condition = mc;
        o.sensor = ms;
        if (o.samples == 0) {
          if (recordings.conditions.size() == 1)
            p.warnings.push_back(fmt::format("sensor {} has no sample within the simulation: it is predicted, not compared", p.label(o)));
          continue;
        }
        if (const auto same = equal_pulses(recordings, c, std::size_t(it - recordings.sensors.begin())))
          p.warnings.push_back(
              fmt::format("sensor {}: pulses {} and {} are the same at every sample: is one a copy of the other?", p.label(o), same->first, same->second));
        if (const auto noise = recordings.noise_of(shape.sensors[ms], options); noise && *noise > o.peak)
          p.warnings.push_back(fmt::format("sensor {}: the noise of {:.3g} is larger than its record, {:.3g} at most: is recordings.noise in the data's unit?",
                                           p.label(o), *noise, o.peak));
        if (o.bandless > 0) p.warnings.push_back(fmt::format("sensor {}: {} samples have one pulse left and no band", p.label(o), o.bandless));
        p.observations.push_back(std::move(o));
      }
  for (std::size_t i = 0; i < p.observations.size(); ++i)
    for (std::size_t j = i + 1; j < p.observations.size(); ++j)
      if (same_records(p.observations[i], p.observations[j]))
        p.warnings.push_back(fmt::format("sensors {} and {} have the same record at every sample: is one a copy of the other?", p.label(p.observations[i]),
                                         p.label(p.observations[j])));
  leave_out_dead(p, recordings);
  if (p.observations.empty()) throw InputError({.problem = "no declared sensor is recorded within the simulation", .key = "recordings.file"});
  return p;
}

std::vector<double> on_record_times(const Problem& problem, std::span<const double> history) {
  std::vector<double> y(problem.time.size());
  for (std::size_t t = 0; t < y.size(); ++t) {
    const auto& s = problem.stencils[t];
    for (std::size_t j = 0; j < 4; ++j)
      if (s.weight[j] != 0) y[t] += s.weight[j] * history[s.index[j]];
  }
  return y;
}

Score score(const Problem& problem, std::span<const double> values) {
  expect(values.size() == problem.shape.values(), "a score is of a model's whole output");
  Score total{.ok = true};
  for (const auto& o : problem.observations) {
    SensorScore s{problem.shape.conditions[o.condition], problem.shape.sensors[o.sensor]};
    const auto y = on_record_times(problem, values.subspan(problem.shape.at(o.condition, o.sensor, 0), problem.shape.times.size()));
    double absolute = 0, squares = 0, norm = 0, over = 0, under = 0;
    std::size_t inside = 0;
    for (std::size_t t = 0; t < y.size(); ++t) {
      if (!o.compared[t]) continue;
      const double d = y[t] - o.mean[t];
      absolute += std::abs(d);
      squares += d * d;
      norm += o.mean[t] * o.mean[t];
      if (!o.banded[t]) continue;
      const double width = o.high[t] - o.low[t];
      inside += y[t] > o.low[t] && y[t] < o.high[t];
      over = std::max(over, (y[t] - o.high[t]) / width);
      under = std::max(under, (o.low[t] - y[t]) / width);
    }
    s.samples = o.samples;
    s.banded = o.banded_samples;
    s.accuracy = o.banded_samples > 0 ? 100.0 * double(inside) / double(o.banded_samples) : nan;
    s.mae = problem.mae_scale * absolute / double(o.samples);
    s.rrmse = std::sqrt(squares / norm);
    s.excess = over + under;
    if (!std::isfinite(absolute)) total.ok = false;
    if (s.banded > 0) {
      total.accuracy += s.accuracy;
      ++total.banded_sensors;
    }
    total.mae += s.mae;
    total.delta1 += s.rrmse;
    total.delta2 += s.excess;
    total.sensors.push_back(std::move(s));
  }
  const double n = double(problem.observations.size());
  if (total.banded_sensors > 0) total.accuracy /= double(total.banded_sensors);
  total.mae /= n;
  total.nrmse = total.delta1 / n;
  return total;
}

BandArrays band_arrays(const Problem& problem) {
  const std::size_t n = problem.shape.conditions.size() * problem.shape.sensors.size() * problem.time.size();
  BandArrays out{std::vector<double>(n, nan), std::vector<double>(n, nan), std::vector<double>(n, nan)};
  for (const auto& o : problem.observations) {
    const auto at = std::ptrdiff_t((o.condition * problem.shape.sensors.size() + o.sensor) * problem.time.size());
    std::copy(o.mean.begin(), o.mean.end(), out.mean.begin() + at);
    std::copy(o.low.begin(), o.low.end(), out.low.begin() + at);
    std::copy(o.high.begin(), o.high.end(), out.high.begin() + at);
  }
  return out;
}

}  // namespace calomel
