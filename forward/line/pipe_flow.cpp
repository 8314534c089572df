#include "forward/line/pipe_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr double gravity = 9.80665;        ///< standard [m/s^2]
constexpr double laminar_reynolds = 2320;  ///< of the steady flow: below, Vardy and Brown's B is that of laminar flow
constexpr double laminar_b = 210.08;       ///< Vardy and Brown 2003

void expect_number(bool holds, const char* what, double value) {
  if (!holds || !std::isfinite(value)) throw NumericsError(fmt::format("{} = {:.6g}", what, value));
}

}  // namespace

double haaland(double reynolds, double roughness) {
  const double inside = std::pow(roughness / 3.7, 1.11) + (reynolds > 0 ? 6.9 / reynolds : 0);
  return inside > 0 ? 1 / std::pow(1.8 * std::log10(inside), 2) : 0;
}

PipeFlow::PipeFlow(const PipeSetup& setup, double longest) : s_(setup) {
  expect_number(s_.length > 0, "the pipe's length must be above 0, it is", s_.length);
  expect_number(s_.diameter > 0, "the pipe's diameter must be above 0, it is", s_.diameter);
  expect_number(s_.wave_speed > 0, "the wave speed must be above 0, it is", s_.wave_speed);
  expect_number(s_.density > 0, "the density must be above 0, it is", s_.density);
  expect_number(s_.viscosity >= 0, "the viscosity must be at least 0, it is", s_.viscosity);
  expect_number(s_.friction_factor >= 0, "the friction factor must be at least 0, it is", s_.friction_factor);
  expect_number(s_.velocity >= 0, "the steady velocity must be at least 0, it is", s_.velocity);
  expect_number(s_.closure_time >= 0, "the time of closure must be at least 0, it is", s_.closure_time);
  expect_number(s_.retarded_compliance >= 0, "the retarded compliance must be at least 0, it is", s_.retarded_compliance);
  expect(s_.cells >= 2, "a pipe has two cells or more");
  const auto n = std::size_t(s_.cells) + 1;
  dx_ = s_.length / s_.cells;
  dt_ = dx_ / s_.wave_speed;
  area_ = std::numbers::pi / 4 * s_.diameter * s_.diameter;
  impedance_ = s_.density * s_.wave_speed;
  const double loss = resistance(s_.velocity) * s_.velocity;
  for (std::size_t i = 0; i < n; ++i) {
    height_.push_back(s_.density * gravity * s_.rise * double(i) / s_.cells);
    pressure_.push_back(s_.reservoir_pressure - loss * double(i));
    if (pressure(i) < s_.vapour_pressure)
      throw NumericsError(
          fmt::format("the steady pressure {:.4g} Pa at {:.3g} m is below the vapour pressure {:.4g} Pa", pressure(i), dx_ * double(i), s_.vapour_pressure));
  }
  steady_ = pressure_;
  upstream_.assign(n, s_.velocity);
  downstream_ = upstream_;
  valve_drop_ = pressure(n - 1) - s_.outlet_pressure;
  if (s_.velocity > 0 && !(valve_drop_ > 0))
    throw NumericsError(
        fmt::format("the pressure behind the valve, {:.4g} Pa, is not below the steady one before it, {:.4g} Pa", s_.outlet_pressure, pressure(n - 1)));

  cavities_ = std::isfinite(s_.vapour_pressure);
  cavity_.assign(n, 0.0);
  gas_.assign(n, 0.0);
  if (cavities_ && s_.gas_fraction > 0)
    for (std::size_t i = 1; i < n; ++i) {
      cavity_[i] = s_.gas_fraction * area_ * dx_ * (i + 1 == n ? 0.5 : 1);
      gas_[i] = (pressure(i) - s_.vapour_pressure) * cavity_[i];
    }

  wall_ = s_.retarded_compliance > 0;
  if (wall_) {  // q after a step in which P runs linearly: E q + chi (c0 P' before + c1 P' after)
    expect_number(s_.retardation_time > 0, "the retardation time of the wall must be above 0, it is", s_.retardation_time);
    const double tau = s_.retardation_time, decay = std::exp(-dt_ / tau), mean = -std::expm1(-dt_ / tau) * tau / dt_;
    wall_decay_ = decay;
    wall_old_ = s_.retarded_compliance * (mean - decay);
    wall_new_ = s_.retarded_compliance * (1 - mean);
    stiffness_ = 1 + 0.5 * dt_ * (s_.retarded_compliance - wall_new_) / tau;
  }
  retarded_.assign(n, 0.0);
  rate_.assign(n, 0.0);

  unsteady_ = s_.unsteady_friction > 0 && s_.viscosity > 0;
  if (unsteady_) {
    // t^-1/2 = pi^-1/2 int exp(u/2 - t exp u) du by the trapezoidal rule, 0.1 % at this step; rates from a hundredth of the run's to thirty in a step, what is
    // slower in one term and what is faster, and forgotten within a step, in another.
    const double reynolds = s_.density * s_.velocity * s_.diameter / s_.viscosity;
    const double scale = 4 * s_.viscosity / (s_.density * s_.diameter * s_.diameter), tick = scale * dt_;
    const double b = reynolds > laminar_reynolds ? std::pow(reynolds, std::log10(15.29 * std::pow(reynolds, -0.0567))) / 12.86 : laminar_b;
    constexpr double h = 1.2;
    const double begin = std::log(0.01 / (scale * std::max(longest, dt_))), end = std::log(30 / tick);
    const auto add = [&](double weight, double rate) {
      const double step = (rate + b) * tick;
      decay_.push_back(std::exp(-step));
      weight_.push_back(weight / (2 * std::numbers::pi) * -std::expm1(-step) / step);
    };
    add(2 * std::exp((begin - 0.5 * h) / 2), 0);
    double u = begin;
    for (; u < end; u += h) add(h * std::exp(u / 2), std::exp(u));
    decay_.push_back(0);
    weight_.push_back(2 * std::exp(-(u - 0.5 * h) / 2) / tick / (2 * std::numbers::pi));
    const double force = s_.unsteady_friction * 16 * s_.viscosity / (s_.diameter * s_.diameter);
    for (auto& w : weight_) {
      w *= force;
      fresh_ += w;
    }
    past_up_.assign(n * weight_.size(), 0.0);
    past_down_ = past_up_;
  }
}

/// Loss of quasi-steady friction over a cell, per velocity [Pa s/m]: rho dx f |V| / 2D.
double PipeFlow::resistance(double velocity) const {
  return dx_ / (2 * s_.diameter) * std::max(64 * s_.viscosity / s_.diameter, s_.density * s_.friction_factor * std::abs(velocity));
}

double PipeFlow::opening(double time) const {
  const double since = time - s_.closure_begin;
  if (since <= 0 && s_.closure_time > 0) return 1;
  if (since < 0) return 1;
  if (since >= s_.closure_time) return 0;
  return std::pow(1 - since / s_.closure_time, s_.closure_exponent);
}

double PipeFlow::pressure_at(double distance) const {
  const double at = std::clamp(distance / dx_, 0.0, double(s_.cells));
  const auto i = std::min(std::size_t(at), std::size_t(s_.cells) - 1);
  const double w = at - double(i);
  return w == 0 ? pressure(i) : (1 - w) * pressure(i) + w * pressure(i + 1);
}

/// Sum of what a node remembers of its velocity [Pa/m]: F.
double PipeFlow::friction_now(std::span<const double> past, std::size_t node) const {
  double sum = 0;
  for (std::size_t j = 0; j < weight_.size(); ++j) sum += past[node * weight_.size() + j];
  return sum;
}

void PipeFlow::remember(std::vector<double>& past, const std::vector<double>& before, const std::vector<double>& now) const {
  for (std::size_t i = 0; i < before.size(); ++i)
    for (std::size_t j = 0; j < weight_.size(); ++j) {
      auto& y = past[i * weight_.size() + j];
      y = decay_[j] * y + weight_[j] * (now[i] - before[i]);
    }
}

PipeFlow::Characteristic PipeFlow::arriving(std::size_t from, std::size_t to, double sign, const std::vector<double>& there, const std::vector<double>& here,
                                            std::span<const double> past_there, std::span<const double> past_here) const {
  const double r = 0.5 * resistance(there[from]);
  Characteristic c{.impedance = impedance_ + r, .constant = pressure_[from] + sign * (impedance_ - r) * there[from]};
  if (unsteady_) {
    double kept = 0;
    for (std::size_t j = 0; j < weight_.size(); ++j) kept += decay_[j] * past_here[to * weight_.size() + j];
    c.impedance += 0.5 * dx_ * fresh_;
    c.constant -= sign * 0.5 * dx_ * (friction_now(past_there, from) + kept - fresh_ * here[to]);
  }
  if (wall_) {  // dq/dt at `to` after the step is (chi P' - q)/tau, of which P' is unknown
    const double before = pressure_[to] - steady_[to];
    const double known = (wall_decay_ * retarded_[to] + wall_old_ * before) / s_.retardation_time;
    c.constant -= 0.5 * dt_ * (rate_[from] - known) - (stiffness_ - 1) * steady_[to];
  }
  return c;
}

/// The pressure at node i when the velocity beyond it is outflow_constant + outflow_slope P: with the cavity's new volume b + m x of x = p - p_v >= 0,
/// x (b + m x) is the gas constant.
void PipeFlow::cavity_node(std::size_t i, const Characteristic& plus, double outflow_constant, double outflow_slope) {
  const double floor = s_.vapour_pressure + height_[i], swept = dt_ * area_;
  const double inflow = (plus.constant - stiffness_ * floor) / plus.impedance, outflow = outflow_constant + outflow_slope * floor;
  const double b = cavity_[i] + swept * (outflow - inflow), m = swept * (outflow_slope + stiffness_ / plus.impedance);
  const double root = std::sqrt(b * b + 4 * m * gas_[i]);
  const double x = b > 0 ? (gas_[i] > 0 ? 2 * gas_[i] / (b + root) : 0) : (root - b) / (2 * m);
  pressure_[i] = floor + x;
  cavity_[i] = b > 0 ? 0.5 * (b + root) : (gas_[i] > 0 ? 2 * m * gas_[i] / (root - b) : 0);
  upstream_[i] = (plus.constant - stiffness_ * pressure_[i]) / plus.impedance;
  downstream_[i] = outflow_constant + outflow_slope * pressure_[i];
}

void PipeFlow::step() {
  const std::size_t n = pressure_.size(), last = n - 1;
  ++steps_;
  std::vector<Characteristic> plus(n), minus(n);
  for (std::size_t i = 1; i < n; ++i) plus[i] = arriving(i - 1, i, +1, downstream_, upstream_, past_down_, past_up_);
  for (std::size_t i = 0; i < last; ++i) minus[i] = arriving(i + 1, i, -1, upstream_, downstream_, past_up_, past_down_);
  const std::vector<double> up = upstream_, down = downstream_, before = pressure_;

  // The reservoir keeps its pressure.
  pressure_[0] = steady_[0];
  downstream_[0] = upstream_[0] = (stiffness_ * pressure_[0] - minus[0].constant) / minus[0].impedance;

  for (std::size_t i = 1; i < last; ++i) {
    const auto &p = plus[i], &m = minus[i];
    if (cavities_) {
      cavity_node(i, p, -m.constant / m.impedance, stiffness_ / m.impedance);
    } else {
      upstream_[i] = downstream_[i] = (p.constant - m.constant) / (p.impedance + m.impedance);
      pressure_[i] = (p.constant * m.impedance + m.constant * p.impedance) / (p.impedance + m.impedance) / stiffness_;
    }
  }

  // The valve: V|V| = k (P - P_out) on the line stiffness P + Z V = constant.
  const auto& p = plus[last];
  const double open = opening(time()), out = s_.outlet_pressure + height_[last];
  double valve = 0;
  if (open > 0 && s_.velocity > 0) {
    const double k = s_.velocity * s_.velocity * open * open / valve_drop_, excess = p.constant / stiffness_ - out, z = k * p.impedance / stiffness_;
    valve = 2 * k * excess / (z + std::sqrt(z * z + 4 * k * std::abs(excess)));
  }
  if (cavities_) {
    cavity_node(last, p, valve, 0);
  } else {
    upstream_[last] = downstream_[last] = valve;
    pressure_[last] = (p.constant - p.impedance * valve) / stiffness_;
  }

  if (wall_)
    for (std::size_t i = 0; i < n; ++i) {
      retarded_[i] = wall_decay_ * retarded_[i] + wall_old_ * (before[i] - steady_[i]) + wall_new_ * (pressure_[i] - steady_[i]);
      rate_[i] = (s_.retarded_compliance * (pressure_[i] - steady_[i]) - retarded_[i]) / s_.retardation_time;
    }
  if (unsteady_) remember(past_up_, up, upstream_), remember(past_down_, down, downstream_);
  if (!std::isfinite(pressure_[last])) throw NumericsError(fmt::format("the pressure at the valve is not a number in step {}", steps_));
}

}  // namespace calomel
