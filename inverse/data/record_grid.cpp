#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "base/median.hpp"
#include "inverse/data/record_rows.hpp"

namespace calomel {

namespace {

/// Evenly spaced times start + k step.
struct TimeGrid {
  double start = 0, step = 0;
  double residual = 0;  ///< largest distance of a printed time from the grid, in steps
};

InputError at_row(const RecordRows& table, const RecordRow& row, std::string problem, std::string suggestion = "") {
  return InputError({.problem = std::move(problem),
                     .value = fmt::format("sensor {}, pulse {}, time {}", table.sensors[std::size_t(row.sensor)], row.pulse, row.time),
                     .suggestion = std::move(suggestion),
                     .file = table.files[std::size_t(row.file)],
                     .line = row.line});
}

/// Least-squares grid through the times of one series (ascending): the index of each time is the rounded sum of the gaps
/// in units of the median gap, so that missing samples and rounded prints are both met.
TimeGrid fit_grid(const RecordRows& table, const std::vector<const RecordRow*>& series) {
  const std::size_t n = series.size();
  TimeGrid grid{series[0]->time, 0, 0};
  if (n < 2) return grid;
  std::vector<double> gaps(n - 1), k(n, 0);
  for (std::size_t i = 1; i < n; ++i) {
    gaps[i - 1] = series[i]->time - series[i - 1]->time;
    if (gaps[i - 1] <= 0)
      throw at_row(table, *std::max(series[i - 1], series[i], [](auto* a, auto* b) { return a->line < b->line; }), "this sample is given twice",
                   "equal times may come from rounding when the file was printed: write more digits");
  }
  const double median_gap = upper_median(gaps);
  double step = median_gap;
  std::size_t worst = 0;
  for (int pass = 0; pass < 3; ++pass) {  // the fitted step corrects the median of rounded gaps
    double sk = 0, st = 0, skk = 0, skt = 0;
    for (std::size_t i = 1; i < n; ++i) k[i] = k[i - 1] + std::max(1.0, std::round(gaps[i - 1] / step));
    for (std::size_t i = 0; i < n; ++i) {
      const double t = series[i]->time - series[0]->time;
      sk += k[i];
      st += t;
      skk += k[i] * k[i];
      skt += k[i] * t;
    }
    grid.step = (double(n) * skt - sk * st) / (double(n) * skk - sk * sk);
    grid.start = series[0]->time + (st - grid.step * sk) / double(n);
    step = grid.step;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double r = std::abs(series[i]->time - grid.start - k[i] * grid.step) / grid.step;
    if (r > grid.residual) {
      grid.residual = r;
      worst = i;
    }
  }
  // Rounded prints miss the grid throughout a long series; a single uneven sample does not.
  const std::size_t missing_it = std::size_t(std::count_if(k.begin(), k.end(), [&, i = std::size_t{0}](double place) mutable {
    return std::abs(series[i++]->time - grid.start - place * grid.step) > 0.01 * grid.step;
  }));
  if (grid.residual > 0.2 || (grid.residual > 0.01 && (n < 20 || 4 * missing_it < n))) {
    for (std::size_t i = 1; i < n; ++i) {  // name the first uneven gap rather than the largest remainder of the fit
      const double r = gaps[i - 1] / median_gap;
      if (std::abs(r - std::round(r)) > 0.2 || r < 0.5) {
        worst = i;
        break;
      }
    }
    throw at_row(table, *series[worst], fmt::format("irregular time: the samples of this series are not evenly spaced (median step {:.6g} s)", median_gap),
                 "resample the record on even steps");
  }
  return grid;
}

}  // namespace

Recordings assemble(const RecordRows& table) {
  expect(!table.rows.empty(), "a table of samples has rows");
  Recordings out;
  out.conditions = table.conditions;
  out.sensors = table.sensors;
  out.sensor_lines = table.sensor_lines;
  out.warnings = table.warnings;
  out.source = join(table.files);

  // 1. Pulses, and the longest series.
  for (const auto& r : table.rows)
    if (out.pulses.empty() || out.pulses.back() != r.pulse) {
      const auto it = std::lower_bound(out.pulses.begin(), out.pulses.end(), r.pulse);
      if (it == out.pulses.end() || *it != r.pulse) out.pulses.insert(it, r.pulse);
    }
  const auto pulse_index = [&](int number) { return std::size_t(std::lower_bound(out.pulses.begin(), out.pulses.end(), number) - out.pulses.begin()); };
  const std::size_t n_series = out.conditions.size() * out.sensors.size() * out.pulses.size();
  if (n_series > 10'000'000 || n_series > 50 * table.rows.size() + 1000)
    throw InputError({.problem = fmt::format("{} rows belong to {} conditions, {} sensors and {} pulses", table.rows.size(), out.conditions.size(),
                                             out.sensors.size(), out.pulses.size()),
                      .suggestion = "check the columns",
                      .file = table.files[0]});
  const auto series_of = [&](const RecordRow& r) {
    return (std::size_t(r.condition) * out.sensors.size() + std::size_t(r.sensor)) * out.pulses.size() + pulse_index(r.pulse);
  };
  std::vector<std::size_t> size(n_series, 0);
  for (const auto& r : table.rows) ++size[series_of(r)];
  const std::size_t longest = std::size_t(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<const RecordRow*> series;
  for (const auto& r : table.rows)
    if (series_of(r) == longest) series.push_back(&r);
  std::stable_sort(series.begin(), series.end(), [](auto* a, auto* b) { return a->time < b->time; });

  // 2. The grid, and every sample on it.
  const TimeGrid grid = fit_grid(table, series);
  const bool rounded = grid.residual > 0.01;
  const double tolerance = rounded ? 0.3 : 0.02;
  std::vector<long long> place(table.rows.size());
  long long low = std::numeric_limits<long long>::max(), high = std::numeric_limits<long long>::min();
  const long long reach = 20 * (long long)series.size() + 1000;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& r = table.rows[i];
    const double k = grid.step > 0 ? (r.time - grid.start) / grid.step : (r.time == grid.start ? 0 : 0.5);
    if (std::abs(k - std::round(k)) > tolerance || std::abs(k) > double(reach))
      throw at_row(table, r, fmt::format("this time is not on the common time grid of the record ({:.9g} s and steps of {:.6g} s)", grid.start, grid.step),
                   "give all sensors and pulses at the same evenly spaced times");
    place[i] = std::llround(k);
    low = std::min(low, place[i]);
    high = std::max(high, place[i]);
  }
  const std::size_t n = std::size_t(high - low + 1);
  out.time.resize(n);
  for (std::size_t k = 0; k < n; ++k) out.time[k] = grid.start + double(low + (long long)k) * grid.step;
  if (rounded)
    out.warnings.push_back(fmt::format("the printed times of {} are rounded; even steps of {:.6g} s are taken", out.source, grid.step));
  else
    for (std::size_t i = 0; i < table.rows.size(); ++i) out.time[std::size_t(place[i] - low)] = table.rows[i].time;
  if (std::abs(out.time[0]) < 1e-9 * grid.step) out.time[0] = 0;

  // 3. The values.
  if (n_series * n > 50 * table.rows.size() + 10'000'000)
    throw InputError({.problem = fmt::format("{} rows belong to {} series of {} times", table.rows.size(), n_series, n),
                      .suggestion = "check the columns",
                      .file = table.files[0]});
  out.values.assign(n_series * n, std::numeric_limits<double>::quiet_NaN());
  std::vector<char> given(n_series * n, 0);
  std::size_t dropouts = 0, absent = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& r = table.rows[i];
    const std::size_t at = series_of(r) * n + std::size_t(place[i] - low);
    if (given[at]) throw at_row(table, r, "this sample is given twice", "one row for each sensor, pulse and time");
    given[at] = 1;
    out.values[at] = r.value;
    dropouts += std::isnan(r.value);
  }
  for (std::size_t s = 0; s < n_series; ++s)
    if (size[s] > 0) absent += n - size[s];
  if (dropouts > 0) out.warnings.push_back(fmt::format("{} dropouts (NaN or blank) in {}", dropouts, out.source));
  if (absent > 0) out.warnings.push_back(fmt::format("{} samples are missing in {}: not every series has every time of the record", absent, out.source));
  return out;
}

}  // namespace calomel
