// The line model against exact solutions: Joukowsky's pressure and the period 4L/a at Courant number 1, quasi-steady and unsteady friction, viscoelastic walls,
// vapour cavities, and Pochhammer and Chree's first mode of a bar.
#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <functional>

#include "forward/line/pipe_flow.hpp"
#include "forward/line/pochhammer_chree.hpp"
#include "tests/verification/rows.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

const std::string item = "Line";

/// Water in 40 m of pipe without friction, and a valve that closes at once: rho a V = 625 kPa.
PipeSetup pipe(int cells = 64) {
  return {.length = 40, .diameter = 0.02, .wave_speed = 1250, .density = 1000, .velocity = 0.5, .reservoir_pressure = 200e3, .cells = cells};
}

/// Complex rate s of the slowest wave exp(s t) of a pipe closed at one end, s^2 law(s) = -(pi a / 2L)^2, by Newton from the undamped one.
std::complex<double> slowest_rate(const PipeSetup& p, const std::function<std::complex<double>(std::complex<double>)>& law) {
  const double w = M_PI * p.wave_speed / (2 * p.length), h = 1e-5 * w;
  std::complex<double> s(0, w);
  const auto g = [&](std::complex<double> z) { return z * z * law(z) + w * w; };
  for (int i = 0; i < 50; ++i) s -= g(s) / ((g(s + h) - g(s - h)) / (2 * h));
  return s;
}

/// Decay rate of the wave at the valve between its third and ninth period, from projections through Hann's windows of three periods [1/s].
double decay(const PipeSetup& s, double frequency) {
  const double period = 2 * M_PI / frequency;
  PipeFlow flow(s, 12 * period);
  std::complex<double> a, b;
  while (flow.time() < 12 * period) {
    flow.step();
    for (auto [sum, n] : {std::pair(&a, 3), std::pair(&b, 9)}) {
      const double x = (flow.time() / period - n) / 3;
      if (x >= 0 && x <= 1)
        *sum += (1 - std::cos(2 * M_PI * x)) * (flow.pressure(std::size_t(s.cells)) - s.reservoir_pressure) *
                std::exp(std::complex<double>(0, -frequency * flow.time()));
    }
  }
  return -std::log(std::abs(b / a)) / (6 * period);
}

/// Volume of liquid that the pressure has pressed into a level pipe, A/(rho a^2) int p dx: half of what the characteristics carry that leave into each cell,
/// which the scheme conserves [m^3].
double stored(const PipeFlow& flow, const PipeSetup& s) {
  const double impedance = s.density * s.wave_speed;
  double sum = 0;
  for (std::size_t i = 0; i + 1 < flow.nodes(); ++i)
    sum += 0.5 * (flow.pressure(i) + impedance * flow.downstream()[i] + flow.pressure(i + 1) - impedance * flow.upstream()[i + 1]);
  return sum * flow.area() * s.length / s.cells / (impedance * s.wave_speed);
}

}  // namespace

TEST(LinePipe, ShowsJoukowskysPressureAndThePeriodExactly) {
  const PipeSetup s = pipe();
  PipeFlow flow(s, 1);
  flow.step();
  const double rise = flow.pressure(64) - 200e3;
  std::vector<double> falls;
  double before = flow.pressure(64);
  while (falls.size() < 3) {
    flow.step();
    if (flow.pressure(64) < before - 1e3) falls.push_back(flow.time());
    before = flow.pressure(64);
  }
  verify({.item = item,
          .quantity = "pipe: pressure of a closed valve",
          .unit = "Pa",
          .reference = 1000 * 1250 * 0.5,
          .source = "Joukowsky, rho a V",
          .measured = rise,
          .tolerance = 1e-3,
          .control = "rho a (V + 1e-6 m/s)",
          .control_value = 1250e3 * 0.500001});
  verify({.item = item,
          .quantity = "pipe: period",
          .unit = "s",
          .reference = 4 * 40.0 / 1250,
          .source = "4 L / a",
          .measured = falls[1] - falls[0],
          .tolerance = 1e-9,
          .control = "one step more",
          .control_value = falls[1] - falls[0] + flow.time_step()});
}

TEST(LinePipe, LosesWhatLaminarFrictionTakes) {
  PipeSetup s = pipe();
  s.viscosity = 0.02;
  s.velocity = 0.1;
  const double rate = 16 * s.viscosity / s.density / (s.diameter * s.diameter);
  const auto exact = slowest_rate(s, [&](std::complex<double> z) { return 1.0 + 2 * rate / z; });
  PipeSetup none = s;
  none.viscosity = 0;
  verify({.item = item,
          .quantity = "pipe: decay by laminar friction",
          .unit = "1/s",
          .reference = rate,
          .source = "16 nu / D^2",
          .measured = decay(s, exact.imag()),
          .tolerance = 0.002 * rate,
          .control = "no viscosity",
          .control_value = decay(none, exact.imag())});
}

TEST(LinePipe, LosesWhatUnsteadyFrictionTakes) {
  PipeSetup s = pipe(128);
  s.viscosity = 0.01;
  s.velocity = 0.1;
  s.unsteady_friction = 1;
  const double nu = s.viscosity / s.density, T = s.diameter * s.diameter / (4 * nu), steady = 32 * nu / (s.diameter * s.diameter);
  const auto exact = slowest_rate(s, [&](std::complex<double> z) { return 1.0 + steady / z + 2.0 / std::sqrt(z * T + 210.08); });
  PipeSetup quasi_steady = s;
  quasi_steady.unsteady_friction = 0;
  verify({.item = item,
          .quantity = "pipe: decay by unsteady friction",
          .unit = "1/s",
          .reference = -exact.real(),
          .source = "linear theory of Vardy and Brown's weighting function",
          .measured = decay(s, exact.imag()),
          .tolerance = 0.005 * -exact.real(),
          .control = "quasi-steady",
          .control_value = decay(quasi_steady, exact.imag())});
}

TEST(LinePipe, LosesWhatARetardedWallTakes) {
  PipeSetup s = pipe(128);
  s.retarded_compliance = 0.05;
  for (const double tau : {0.005, 0.02, 0.1}) {
    s.retardation_time = tau;
    const auto exact = slowest_rate(s, [&](std::complex<double> z) { return 1.0 + s.retarded_compliance / (1.0 + z * tau); });
    PipeSetup slower = s;
    slower.retardation_time = 1.2 * tau;
    slower.retarded_compliance *= 1.2;
    verify({.item = item,
            .quantity = fmt::format("pipe: decay by a retarded wall, time {:g} s", tau),
            .unit = "1/s",
            .reference = -exact.real(),
            .source = "linear theory of a Kelvin-Voigt element",
            .measured = decay(s, exact.imag()),
            .tolerance = 0.005 * -exact.real(),
            .control = "time and compliance +20 %",
            .control_value = decay(slower, exact.imag())});
  }
}

// In the n-th period 2L/a of a frictionless pipe the liquid leaves the valve at V0 - (2n + 1) d, d = (p_R - p_v)/(rho a). This is exact where grid nodes lie
// on all changes.
TEST(LinePipe, CavityAtTheValveIsThatOfTheExactSolution) {
  PipeSetup s = pipe(32);
  s.vapour_pressure = -100e3;
  PipeFlow flow(s, 1), elastic(pipe(32), 1);
  const double d = 300e3 / 1250e3, period = 2 * s.length / s.wave_speed;
  double greatest = 0, least = 0, least_elastic = 0, flown = 0, worst = 0, most = 0;
  const double steady = stored(flow, s);
  while (flow.time() < 6 * period) {
    flow.step();
    elastic.step();
    greatest = std::max(greatest, flow.cavity()[32]);
    double cavities = 0;
    for (std::size_t i = 0; i < flow.nodes(); ++i) {
      least = std::min(least, flow.pressure(i));
      least_elastic = std::min(least_elastic, elastic.pressure(i));
      cavities += flow.cavity()[i];
    }
    flown += flow.time_step() * flow.area() * (flow.downstream()[0] - flow.downstream()[32]);
    most = std::max(most, cavities);
    worst = std::max(worst, std::abs(stored(flow, s) - steady - cavities - flown));
  }
  const double exact = flow.area() * (s.velocity - d) * period;
  verify({.item = item,
          .quantity = "pipe: greatest cavity at the valve",
          .unit = "m^3",
          .reference = exact,
          .source = "exact, one cavity without friction",
          .measured = greatest,
          .tolerance = 1e-9 * exact,
          .control = "vapour pressure 1 Pa lower",
          .control_value = exact * (1 - 1 / 1250e3 / (s.velocity - d))});
  verify({.item = item,
          .quantity = "pipe: pressure below the vapour's",
          .unit = "Pa",
          .reference = 0,
          .source = "p >= p_v",
          .measured = least + 100e3,
          .tolerance = 1e-6,
          .control = "elastic line",
          .control_value = least_elastic + 100e3});
  verify({.item = item,
          .quantity = "pipe: liquid stored less what flowed in, over the greatest cavity",
          .reference = 0,
          .source = "mass",
          .measured = worst / most,
          .tolerance = 1e-9,
          .control = "cavities left out",
          .control_value = worst / most + 1});
}

TEST(LineBar, DispersesAsPochhammerAndChreeHaveIt) {
  const PochhammerChreeMode mode(0.29, 2);
  for (const auto& [Omega, tabulated] :
       {std::pair(.26, .9986), {.50, .9944}, {.74, .9869}, {.98, .9747}, {1.22, .9545}, {1.46, .9196}, {1.70, .8547}, {1.94, .7594}})
    verify({.item = item,
            .quantity = fmt::format("bar: c/c0 at {:.2f}", Omega),
            .reference = tabulated,
            .source = "Pochhammer and Chree's first mode, tabulated for nu = 0.29",
            .measured = mode.speed(Omega),
            .tolerance = 2e-4,
            .control = "Poisson's ratio 0.40",
            .control_value = PochhammerChreeMode(0.40, 2).speed(Omega)});
}
