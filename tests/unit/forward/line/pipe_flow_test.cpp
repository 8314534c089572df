#include "forward/line/pipe_flow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/errors.hpp"

namespace calomel {
namespace {

/// Water in 40 m of pipe, no friction, a valve that closes at once; rho a V = 625 kPa above 200 kPa.
PipeSetup pipe() { return {.length = 40, .diameter = 0.02, .wave_speed = 1250, .density = 1000, .velocity = 0.5, .reservoir_pressure = 200e3, .cells = 32}; }

TEST(PipeFlow, IsSteadyWhileTheValveIsOpen) {
  PipeSetup s = pipe();
  s.viscosity = 1e-3;
  s.friction_factor = 0.03;
  s.rise = 2;
  s.closure_begin = 1;
  PipeFlow flow(s, 0.5);
  const double valve = flow.pressure(32);
  EXPECT_NEAR(valve, 200e3 - 0.03 * 40 / 0.02 * 500 * 0.25 - 1000 * 9.80665 * 2, 1e-6);
  while (flow.time() < 0.5) flow.step();
  EXPECT_NEAR(flow.pressure(32), valve, 1e-5);
  EXPECT_NEAR(flow.upstream()[7], 0.5, 1e-12);
}

TEST(PipeFlow, RefusesAStateThatIsNotSteady) {
  PipeSetup s = pipe();
  s.outlet_pressure = 300e3;
  EXPECT_THROW(PipeFlow(s, 1), NumericsError);
  s = pipe();
  s.vapour_pressure = 250e3;
  EXPECT_THROW(PipeFlow(s, 1), NumericsError);
  s = pipe();
  s.wave_speed = 0;
  EXPECT_THROW(PipeFlow(s, 1), NumericsError);
}

TEST(PipeFlow, ValveFollowsItsLawWhileItCloses) {
  PipeSetup s = pipe();
  s.closure_time = 0.02;
  s.closure_exponent = 1.5;
  PipeFlow flow(s, 0.02);
  for (int i = 0; i < 15; ++i) {  // before anything has come back: p = p0 + rho a (V0 - V)
    flow.step();
    const double V = flow.upstream()[32], open = std::pow(1 - flow.time() / 0.02, 1.5);
    EXPECT_NEAR(flow.pressure(32), 200e3 + 1250e3 * (0.5 - V), 1e-6);
    EXPECT_NEAR(V * V, 0.25 * open * open * flow.pressure(32) / 200e3, 1e-12);
  }
}

// A single cavity at the valve of a frictionless pipe: its wall of liquid moves at V = -(V0 - (2n + 1) d) in the n-th period 2L/a, d = (p_R - p_v)/(rho a). All
// is linear between multiples of 2L/a, on which the grid has its nodes, so the volume is exact.
TEST(PipeFlow, CavityAtTheValveGrowsAndClosesAsTheExactSolutionHasIt) {
  PipeSetup s = pipe();
  s.vapour_pressure = -100e3;
  PipeFlow flow(s, 1);
  const double d = 300e3 / 1250e3, period = 2 * s.length / s.wave_speed;
  ASSERT_GT(s.velocity, d);
  std::vector<double> volume;
  double least = 1e9, greatest = 0;
  double exact = 0, time_closed = 0;
  for (int i = 0; i < 64 * 6; ++i) {
    flow.step();
    const double t = flow.time();
    if (t > period * 1.000001 && time_closed == 0) {  // the first period stands under Joukowsky's pressure
      const double n = std::floor((t - period) / period * (1 - 1e-9));
      exact += flow.area() * flow.time_step() * (s.velocity - (2 * n + 1) * d);
      if (exact < -1e-15) time_closed = t;
      EXPECT_NEAR(flow.cavity()[32], std::max(0.0, exact), 1e-12) << t;
    }
    greatest = std::max(greatest, flow.cavity()[32]);
    for (std::size_t k = 1; k < flow.nodes(); ++k) least = std::min(least, flow.pressure(k));
  }
  EXPECT_GE(least, -100e3);
  EXPECT_NEAR(greatest, flow.area() * (s.velocity - d) * period, 1e-12);
  EXPECT_GT(time_closed, 0);
}

/// Volume of liquid that the pressure has pressed into the pipe, less the cavities, A/(rho a^2) int p dx: half of what the characteristics carry that leave
/// into each cell, which is what the scheme keeps without friction [m^3].
double stored(const PipeFlow& flow, const PipeSetup& s) {
  const double impedance = s.density * s.wave_speed;
  double sum = 0, cavities = 0;
  for (std::size_t i = 0; i + 1 < flow.nodes(); ++i)
    sum += 0.5 * (flow.pressure(i) + impedance * flow.downstream()[i] + flow.pressure(i + 1) - impedance * flow.upstream()[i + 1]);
  for (const double v : flow.cavity()) cavities += v;
  return sum * flow.area() * s.length / s.cells / (impedance * s.wave_speed) - cavities;
}

/// Greatest error of the balance of liquid over the greatest volume of the cavities, in a second of column separation.
double balance_error(PipeSetup s) {
  s.vapour_pressure = -100e3;
  s.velocity = 1.4;
  s.closure_time = 0.009;
  s.rise = 2;
  PipeFlow flow(s, 1);
  const double begin = stored(flow, s);
  double flown = 0, most = 0, worst = 0;
  while (flow.time() < 1) {
    flow.step();
    flown += flow.time_step() * flow.area() * (flow.downstream()[0] - flow.downstream()[flow.nodes() - 1]);
    double cavity = 0;
    for (const double v : flow.cavity()) {
      EXPECT_GE(v, 0);
      cavity += v;
    }
    for (std::size_t i = 1; i < flow.nodes(); ++i) EXPECT_GE(flow.pressure(i), -100e3 - 1e-9);
    most = std::max(most, cavity);
    worst = std::max(worst, std::abs(stored(flow, s) - begin - flown));
  }
  EXPECT_GT(most, 1e-6);
  return worst / most;
}

TEST(PipeFlow, KeepsTheLiquidWhileCavitiesOpenAndClose) {
  PipeSetup s = pipe();
  EXPECT_LT(balance_error(s), 1e-10);
  s.gas_fraction = 1e-7;
  EXPECT_LT(balance_error(s), 1e-3);  // the gas that is there from the beginning
  // friction takes from a characteristic where it leaves and where it arrives: to first order in the step
  s.gas_fraction = 0;
  s.viscosity = 1e-3;
  s.friction_factor = 0.024;
  const double coarse = balance_error(s);
  s.cells = 128;
  EXPECT_LT(coarse, 1e-3);
  EXPECT_LT(balance_error(s), 0.5 * coarse);
}

TEST(PipeFlow, GasCavitiesFollowBoylesLaw) {
  PipeSetup s = pipe();
  s.vapour_pressure = -100e3;
  s.gas_fraction = 1e-6;
  s.velocity = 1.0;
  PipeFlow flow(s, 0.5);
  const double gas = flow.cavity()[9] * (flow.pressure(9) + 100e3);
  double least = 1e9, greatest = -1e9;
  for (int i = 0; i < 500; ++i) {
    flow.step();
    EXPECT_NEAR(flow.cavity()[9] * (flow.pressure(9) + 100e3) / gas, 1, 1e-6);
    EXPECT_GT(flow.pressure(9), -100e3);
    least = std::min(least, flow.pressure(9));
    greatest = std::max(greatest, flow.pressure(9));
  }
  EXPECT_LT(least, -95e3);
  EXPECT_GT(greatest, 500e3);
}

/// Complex rate s of the slowest wave, exp(s t), of a pipe closed at one end: s^2 f(s) g(s) = -(pi a / 2L)^2, by Newton from the undamped one.
template <class F>
std::complex<double> slowest_rate(const PipeSetup& p, F&& f) {
  const double w = M_PI * p.wave_speed / (2 * p.length);
  std::complex<double> s(0, w);
  for (int i = 0; i < 50; ++i) {
    const auto g = [&](std::complex<double> z) { return z * z * f(z) + w * w; };
    const std::complex<double> h(1e-5 * w, 0), slope = (g(s + h) - g(s - h)) / (2.0 * h);
    s -= g(s) / slope;
  }
  return s;
}

/// Decay rate [1/s] and frequency [rad/s] of the valve's slowest wave between periods `first` and `last`, from its projections through Hann's windows of three
/// periods, which leave out the higher waves.
std::complex<double> measured_rate(const PipeSetup& s, double frequency, int first, int last) {
  const double period = 2 * M_PI / frequency;
  PipeFlow flow(s, period * (last + 3));
  std::complex<double> a, b;
  while (flow.time() < period * (last + 3)) {
    flow.step();
    for (auto [sum, n] : {std::pair(&a, first), std::pair(&b, last)}) {
      const double x = (flow.time() / period - n) / 3;
      if (x < 0 || x > 1) continue;
      *sum += (1 - std::cos(2 * M_PI * x)) * (flow.pressure(std::size_t(s.cells)) - s.reservoir_pressure) *
              std::exp(std::complex<double>(0, -frequency * flow.time()));
    }
  }
  return std::log(b / a) / (period * (last - first)) + std::complex<double>(0, frequency);
}

TEST(PipeFlow, LaminarFrictionDampsAtSixteenNuOverDSquared) {
  PipeSetup s = pipe();
  s.viscosity = 0.02;
  s.velocity = 0.1;
  s.cells = 64;
  const double rate = 16 * s.viscosity / s.density / (s.diameter * s.diameter);
  const auto exact = slowest_rate(s, [&](std::complex<double> z) { return 1.0 + 2 * rate / z; });
  EXPECT_NEAR(exact.real(), -rate, 1e-6);
  const auto got = measured_rate(s, exact.imag(), 1, 6);
  EXPECT_NEAR(got.real(), exact.real(), 0.002 * rate);
  EXPECT_NEAR(got.imag(), exact.imag(), 1e-4 * exact.imag());
}

TEST(PipeFlow, UnsteadyFrictionDampsAsItsLinearTheory) {
  // rho V_t (1 + 2 (s T + B)^-1/2) with T = D^2 / 4 nu: the Laplace transform of the weighting function; with quasi-steady laminar friction beside it.
  PipeSetup s = pipe();
  s.viscosity = 0.01;
  s.velocity = 0.1;
  s.cells = 128;
  s.unsteady_friction = 1;
  const double nu = s.viscosity / s.density, T = s.diameter * s.diameter / (4 * nu), steady = 32 * nu / (s.diameter * s.diameter);
  const auto law = [&](double share) { return [=](std::complex<double> z) { return 1.0 + steady / z + share * 2.0 / std::sqrt(z * T + 210.08); }; };
  const auto exact = slowest_rate(s, law(1)), without = slowest_rate(s, law(0));
  const auto got = measured_rate(s, exact.imag(), 3, 9);
  EXPECT_NEAR(got.real(), exact.real(), 0.005 * std::abs(exact.real() - without.real()));
  EXPECT_NEAR(got.imag(), exact.imag(), 0.005 * std::abs(exact.imag() - without.imag()));
}

TEST(PipeFlow, RetardedWallDampsAsItsLinearTheory) {
  PipeSetup s = pipe();
  s.retarded_compliance = 0.05;
  s.cells = 128;
  for (const double tau : {0.005, 0.02, 0.1}) {
    s.retardation_time = tau;
    const auto exact = slowest_rate(s, [&](std::complex<double> z) { return 1.0 + s.retarded_compliance / (1.0 + z * tau); });
    const auto got = measured_rate(s, exact.imag(), 3, 9);
    EXPECT_NEAR(got.real(), exact.real(), 0.01 * std::abs(exact.real())) << tau;
    EXPECT_NEAR(got.imag(), exact.imag(), 0.01 * (M_PI * s.wave_speed / (2 * s.length) - exact.imag()) + 1e-3) << tau;
  }
}

TEST(Haaland, IsColebrooksWithinTwoPerCent) {
  EXPECT_NEAR(haaland(1e5, 0), 0.01799, 0.02 * 0.01799);  // Colebrook's, within the 2 % that Haaland gives
  EXPECT_NEAR(haaland(1e5, 1e-3), 0.02217, 0.02 * 0.02217);
  EXPECT_GT(std::abs(haaland(1e5, 0) - 0.02217), 0.02 * 0.02217);
  EXPECT_EQ(haaland(0, 0), 0);
}

}  // namespace
}  // namespace calomel
