// Single bubbles, and sound in a bubbly liquid (physics.md section 4).
#include <fmt/format.h>

#include "tests/verification/bubbles.hpp"
#include "tests/verification/rows.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// Time in which an empty cavity vanishes under the pressure p, to 1e-4 of `expected`.
double empties(const KellerMiksis& cavity, double p, double expected) {
  const double interval = expected / 10000.7;
  KellerMiksis::State s{cavity.radius, 0};
  double t = 0;
  try {
    for (; t < 2 * expected; t += interval) s = under(cavity, s, p, interval);
  } catch (const NumericsError&) {  // the cavity vanishes within this interval
  }
  return t;
}

/// Speed of slow sound, from the law under a slow strain of 1e-5 alpha0.
double slow_speed(const KellerMiksis& bubble, double alpha0) {
  const double e = 1e-5 * alpha0, rise = 4e-3;
  const BubblyLiquid law(mercury, bubble, alpha0);
  OnePoint point(law, 1e-6);
  double p = 0;
  for (double t = 0; t < rise + 2e-4; t += 1e-6) p = point.step(e * soft(t, rise));
  return std::sqrt(-p / (e * mercury_density));
}

void verify_size(const std::string& quantity, const std::string& unit, double reference, double measured, double tolerance, const std::string& source,
                 const std::string& control, double control_value) {
  verify({.item = "Bubble collapse",
          .quantity = quantity,
          .unit = unit,
          .reference = reference,
          .source = source,
          .measured = measured,
          .tolerance = tolerance * reference,
          .control = control,
          .control_value = control_value});
}

}  // namespace

TEST(Bubble, AnEmptyCavityCollapsesInRayleighsTime) {
  const KellerMiksis empty{.density = 998, .sound_speed = unbounded, .radius = 1e-4, .ambient = 0, .polytropic = 1.4, .surface_tension = 0, .viscosity = 0};
  const double p = 1e6, expected = 0.91468 * empty.radius * std::sqrt(empty.density / p), got = empties(empty, p, expected);
  verify_size("empty cavity in water, 1 MPa", "us", 1e6 * expected, 1e6 * got, 1e-3, "0.91468 R0 sqrt(rho / p) (Rayleigh 1917)", "pressure +1 %",
              1e6 * empties(empty, 1.01 * p, expected));
}

// Collapse time, least radius and rebound are compared with an independent computation, for the law's own sub-steps and for finer ones, with
// ten thousand samples.
TEST(Bubble, CollapsesAndReboundsAccordingToKellerAndMiksis) {
  struct Case {
    std::string name;
    KellerMiksis bubble;
    double pressure;  ///< absolute
    Collapse expected;
  };
  const KellerMiksis air{.density = 998, .sound_speed = 1481, .radius = 1e-4, .ambient = 1e5, .polytropic = 1.4, .surface_tension = 0, .viscosity = 0};
  for (const auto& [name, bubble, pressure, expected] : {Case{"air in water, 0.1 to 10 MPa", air, 10e6, {0.96846e-6, 0.10462, 0.514}},
                                                         Case{"helium in mercury, 0.3 to 30 MPa", helium(1.667), 30e6, {2.0181e-6, 0.15990, 0.707}},
                                                         Case{"helium in mercury, 0.3 to 5 MPa", helium(1.667), 5e6, {5.1650e-6, 0.30878, 0.934}}}) {
    const double p = pressure - bubble.ambient, interval = expected.time / 10000.7;
    const auto got = collapse(bubble, p, interval), fine = collapse(bubble, p, interval, 0.3 * interval);
    EXPECT_NEAR(got.least, fine.least, 1e-3 * fine.least);
    EXPECT_NEAR(got.rebound, fine.rebound, 2e-3 * fine.rebound);
    KellerMiksis incompressible = bubble, lighter = bubble;
    incompressible.sound_speed = unbounded;
    lighter.density *= 0.98;
    const std::string source = "independent integration (physics.md)", light = "density -2 %", rigid = "incompressible liquid";
    const auto of_lighter = collapse(lighter, p, interval), of_incompressible = collapse(incompressible, p, interval);
    verify_size("time, " + name, "us", 1e6 * expected.time, 1e6 * got.time, 2e-3, source, light, 1e6 * of_lighter.time);
    verify_size("least R / R0, " + name, "", expected.least, got.least, 2e-3, source, rigid, of_incompressible.least);
    verify_size("rebound R / R0, " + name, "", expected.rebound, got.rebound, 3e-3, source, rigid, of_incompressible.rebound);
  }
}

// The value with heat conduction shows the accuracy of the default kappa, which has three digits: 0.005 of kappa are 0.22 %.
TEST(Bubble, SwingsAtMinnaertsFrequency) {
  for (const auto& [kappa, published] : {std::pair{1.0, 13.13}, {5.0 / 3, 16.99}, {1.16, 14.13}}) {
    const auto f = [&, kappa = kappa](double surface_tension) { return std::sqrt(helium(kappa, surface_tension).natural_squared()) / (2e3 * M_PI); };
    const bool heat = kappa == 1.16;
    const std::string source = heat ? "with conduction of heat, He at 330 K" : "Minnaert with surface tension";
    verify({.item = "Bubbly dispersion",
            .quantity = fmt::format("f0, kappa {:.4g}", kappa),
            .unit = "kHz",
            .reference = published,
            .source = source,
            .measured = f(0.47),
            .tolerance = (heat ? 2.2e-3 : 1e-3) * published,
            .control = "ten times the surface tension",
            .control_value = f(4.7)});
  }
}

// Under slow strain a light gas has 1/K + alpha0/p_a, isothermal at 0.3 MPa.
TEST(BubblyLiquid, SlowSoundIsWoods) {
  for (const auto& [alpha0, published] : {std::pair{1e-5, 1042.}, {1e-4, 448.}, {1e-3, 148.}, {1e-2, 47.}})
    verify({.item = "Bubbly dispersion",
            .quantity = fmt::format("slow sound, alpha {:.0e}", alpha0),
            .unit = "m/s",
            .reference = published,
            .source = "Wood 1930, isothermal, 0.3 MPa",
            .measured = slow_speed(helium(1, 0, 0.5), alpha0),
            .tolerance = 0.01 * published,
            .control = "kappa = 1.16",
            .control_value = slow_speed(helium(1.16, 0, 0.5), alpha0)});
}

TEST(BubblyLiquid, DispersionIsCommanderAndProsperettis) {
  for (const auto& [kappa, slow, fast] : {std::tuple{1.0, 451.5, 302.0}, {5.0 / 3, 566.6, 471.2}}) {
    const KellerMiksis bubble = helium(kappa);
    const BubblyLiquid law(mercury, bubble, 1e-4), fewer(mercury, bubble, 0.97e-4);
    for (const auto& [f, published] : {std::pair{1e3, slow}, {10e3, fast}}) {
      const double c = phase_speed(law, f, 1e-9);
      EXPECT_NEAR(c, commander_prosperetti(bubble, 1e-4, f), 0.003 * c);
      verify({.item = "Bubbly dispersion",
              .quantity = fmt::format("speed at {:.0f} kHz, kappa {:.3g}", f / 1e3, kappa),
              .unit = "m/s",
              .reference = published,
              .source = "Commander and Prosperetti 1989",
              .measured = c,
              .tolerance = 0.005 * published,
              .control = "alpha -3 %",
              .control_value = phase_speed(fewer, f, 1e-9)});
    }
    // Without bubbles the speed of sound is that of the liquid.
    EXPECT_NEAR(phase_speed(BubblyLiquid(mercury, bubble, 1e-12), 1e3, 1e-9), mercury_speed, 1e-3);
  }
}

// One kappa and one thermal viscosity represent heat conduction, which gives 451.9 and 348.7 m/s. Chosen at resonance, they are closer to that at
// 10 kHz than either limit is. Slow sound is isothermal, which they miss.
TEST(BubblyLiquid, TheDefaultsRepresentConductionOfHeatNearResonanceOnly) {
  const double alpha0 = 1e-4, at_1_khz = 451.9, at_10_khz = 348.7;
  const BubblyLiquid law(mercury, helium(1.16, 0.47, 0.5 + 1.3e-3), alpha0), isothermal(mercury, helium(1), alpha0),
      adiabatic(mercury, helium(5.0 / 3), alpha0);
  const auto miss = [](const BubblyLiquid& l, double f, double with_heat) { return std::abs(phase_speed(l, f, 1e-9) / with_heat - 1); };
  measured("error_at_10_kHz", miss(law, 10e3, at_10_khz));
  measured("error_at_1_kHz", miss(law, 1e3, at_1_khz));
  EXPECT_LT(miss(law, 10e3, at_10_khz), 0.3 * std::min(miss(isothermal, 10e3, at_10_khz), miss(adiabatic, 10e3, at_10_khz)));
  EXPECT_GT(miss(law, 1e3, at_1_khz), 5 * miss(isothermal, 1e3, at_1_khz));
}
