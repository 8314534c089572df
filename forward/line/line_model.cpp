#include "forward/line/line_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "forward/line/bar_wave.hpp"

namespace calomel {

namespace {

/// Calls f(mechanism) for every one that is not off.
template <class F>
void for_active(const LineCase& c, F&& f) {
  for (const auto& m : c.mechanisms)
    if (!m.off()) f(m);
}

bool is_offered(const LineCase& c, const LineMechanism& m) {
  const bool chosen = std::any_of(c.mechanisms.begin(), c.mechanisms.end(), [](const auto& each) { return each.listed && !each.enabled; });
  return !m.enabled && (m.listed || !chosen) && c.has_what_it_needs(m);
}

}  // namespace

PipeSetup pipe_setup(const LineCase& at) {
  const auto& p = at.pipe;
  PipeSetup s{.length = p.length,
              .diameter = p.diameter,
              .wave_speed = p.wave_speed,
              .density = p.density,
              .viscosity = p.viscosity,
              .friction_factor = at.friction_factor(),
              .velocity = p.velocity,
              .reservoir_pressure = p.reservoir_pressure,
              .rise = p.rise,
              .outlet_pressure = p.outlet_pressure,
              .closure_begin = p.closure_begin,
              .closure_time = p.closure_time,
              .closure_exponent = p.closure_exponent,
              .cells = p.cells};
  for_active(at, [&](const LineMechanism& m) {
    if (m.entry->pipe) m.entry->pipe(m.values, s);
  });
  return s;
}

LineModel::LineModel(LineCase line_case) : case_(std::move(line_case)) {
  shape_.parameters = case_.parameters;
  shape_.conditions = {"default"};
  for (const auto& s : case_.stations) shape_.sensors.push_back(s.name);
  for (std::size_t i = 0; i < case_.time.samples(); ++i) shape_.times.push_back(double(i) * case_.time.output_interval);
  shape_.unit = case_.unit;
}

std::vector<double> LineModel::bar_histories(const LineCase& at) const {
  if (!(at.bar.wave_speed > 0)) throw NumericsError("the wave speed must be above 0, it is " + number_text(at.bar.wave_speed));
  double longest = 0;
  for (const auto& s : at.stations) longest = std::max(longest, s.distance / at.bar.wave_speed + std::abs(s.delay));
  if (!(longest < 1e3 * (case_.record.end() - case_.record.begin)))
    throw NumericsError(fmt::format("the wave takes {:.4g} s to a station, far beyond the record", longest));
  const BarWave wave(case_.record, std::max(longest, case_.time.end - case_.record.end()));
  std::vector<std::complex<double>> wavenumber;
  for (const double w : wave.omega()) wavenumber.emplace_back(w / at.bar.wave_speed);
  for_active(at, [&](const LineMechanism& m) {
    if (m.entry->wavenumber) m.entry->wavenumber(m.values, at.bar, wave.omega(), wavenumber);
  });
  std::vector<double> out;
  for (const auto& s : at.stations) {
    const auto there = wave.at(s.distance, wavenumber, s.delay);
    for (const double u : resampled(case_.record.begin, case_.record.interval, there, shape_.times)) out.push_back(s.gain * u + s.offset);
  }
  return out;
}

std::vector<double> LineModel::pipe_histories(const LineCase& at) const {
  const std::size_t times = shape_.times.size(), stations = at.stations.size();
  double end = at.time.end;
  for (const auto& s : at.stations) end = std::max(end, at.time.end - s.delay);
  PipeFlow flow(pipe_setup(at), end);
  const auto steps = std::size_t(std::ceil(end / flow.time_step() * (1 - 1e-12)));
  if (double(steps) * double(flow.nodes()) > 1e10) throw NumericsError(fmt::format("{} steps of {} nodes are too many", steps, flow.nodes()));
  std::vector<std::vector<double>> pressure(stations);
  const auto keep = [&] {
    for (std::size_t k = 0; k < stations; ++k) pressure[k].push_back(flow.pressure_at(at.stations[k].distance));
  };
  keep();
  for (std::size_t i = 0; i < steps; ++i) flow.step(), keep();
  std::vector<double> out(stations * times);
  for (std::size_t k = 0; k < stations; ++k) {
    const auto& s = at.stations[k];
    const auto& p = pressure[k];
    for (std::size_t i = 0; i < times; ++i) {
      const double x = std::clamp((shape_.times[i] - s.delay) / flow.time_step(), 0.0, double(steps));
      auto j = std::size_t(x);
      double w = x - double(j);
      if (w > 1 - 1e-9) {
        ++j;
        w = 0;
      }
      const double value = w < 1e-9 ? p[j] : (1 - w) * p[j] + w * p[j + 1];
      out[k * times + i] = s.gain * value / at.pascals_per_unit + s.offset;
    }
  }
  return out;
}

std::vector<double> LineModel::histories(const LineCase& at) const {
  for_active(at, [&](const LineMechanism& m) {
    if (!at.has_what_it_needs(m))
      throw InputError({.problem = "this mechanism needs " + m.entry->needs, .key = "mechanism." + m.name, .suggestion = "set " + m.entry->needs});
  });
  std::vector<double> out = at.kind == "bar" ? bar_histories(at) : pipe_histories(at);
  const std::size_t times = shape_.times.size();
  for_active(at, [&](const LineMechanism& m) {
    if (!m.entry->channel) return;
    for (std::size_t k = 0; k < at.stations.size(); ++k)
      m.entry->channel(m.values, at.stations[k].name, at.time.output_interval, {out.data() + k * times, times});
  });
  for (const double x : out)
    if (!std::isfinite(x)) throw NumericsError("the history is not a number");
  return out;
}

Prediction LineModel::evaluate(std::span<const double> theta) const { return evaluate(theta, {}); }

Prediction LineModel::evaluate(std::span<const double> theta, const std::map<std::string, double>& numbers) const {
  LineCase at = case_.at(theta);
  for (const auto& [key, value] : numbers) at.set_number(key, value);
  try {
    return {.mean = histories(at)};
  } catch (const NumericsError& e) {
    return {.ok = false, .message = e.what()};
  }
}

std::vector<OfferedMechanism> LineModel::offered() const {
  std::vector<OfferedMechanism> all;
  for (const auto& m : case_.mechanisms)
    if (is_offered(case_, m)) all.push_back({m.name, m.entry->law, m.entry->keys, m.entry->per_station, m.entry->plain, m.entry->check});
  return all;
}

LineDescription LineModel::describe() const {
  LineDescription d;
  if (case_.kind == "bar") {
    double longest = std::max(0.0, case_.time.end - case_.record.end());
    for (const auto& s : case_.stations) longest = std::max(longest, s.distance / case_.bar.wave_speed + std::abs(s.delay));
    const BarWave wave(case_.record, longest);
    d.cells = wave.omega().size();
    d.nodes = wave.samples();
    d.steps = 1;
    d.time_step = case_.record.interval;
  } else {
    const PipeFlow flow(pipe_setup(case_), case_.time.end);
    d.cells = std::size_t(case_.pipe.cells);
    d.nodes = flow.nodes();
    d.time_step = flow.time_step();
    d.steps = std::size_t(std::ceil(case_.time.end / d.time_step * (1 - 1e-12)));
    d.friction_factor = case_.friction_factor();
    d.steady_pressure = flow.pressure(d.nodes - 1);
    if (case_.time.output_interval < d.time_step)
      d.notes.push_back(fmt::format("a step of the grid, {:.4g} s, is longer than output_interval: histories are linear in between; more cells make it shorter",
                                    d.time_step));
  }
  for (const auto& m : case_.mechanisms) {
    if (m.enabled)
      d.active.push_back(m.name + (m.off() ? " (at its off values)" : ""));
    else if (is_offered(case_, m))
      d.offered.push_back(m.name);
    else if (!case_.has_what_it_needs(m))
      d.notes.push_back("mechanism." + m.name + ": not offered, it needs " + m.entry->needs);
  }
  return d;
}

}  // namespace calomel
