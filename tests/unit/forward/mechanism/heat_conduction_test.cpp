// Heat conduction in a bubble, represented by one polytropic exponent and one thermal viscosity: the source of the defaults and of the table in
// docs/theory/mechanisms.md.
#include "tests/verification/bubbles.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// Helium at 330 K.
constexpr double ratio_of_heats = 5.0 / 3, conductivity = 0.166, heat_capacity = 5193, gas_constant = 2077;  // W/(m K), J/(kg K)

/// Polytropic exponent and thermal viscosity of a bubble that oscillates at w: kappa = Re Phi / 3 and mu_th = p_e Im Phi / 4w (Commander and Prosperetti 1989),
/// p_e the pressure of the gas at rest.
struct Conduction {
  double polytropic, viscosity;  ///< [-], [Pa s]
};
Conduction conduction(double w, double radius, double ambient, double conducts = conductivity) {
  using namespace std::complex_literals;
  const double pressure = ambient + 2 * 0.47 / radius, density = pressure / (gas_constant * 330);
  const double chi = conducts / (density * heat_capacity) / (w * radius * radius);
  const std::complex<double> z = std::sqrt(1i / chi);
  const std::complex<double> phi = 3 * ratio_of_heats / (1.0 - 3 * (ratio_of_heats - 1) * 1i * chi * (z / std::tanh(z) - 1.0));
  return {phi.real() / 3, pressure * phi.imag() / (4 * w)};
}

KellerMiksis bubble(double radius, double ambient, const Conduction& heat) {
  KellerMiksis b = helium(heat.polytropic, 0.47, heat.viscosity + 1.3e-3);
  b.radius = radius;
  b.ambient = ambient;
  return b;
}

/// The same at the natural frequency of the bubble, which depends on them.
Conduction at_resonance(double radius, double ambient) {
  Conduction heat{1.2, 0};
  for (int i = 0; i < 100; ++i) heat = conduction(std::sqrt(bubble(radius, ambient, heat).natural_squared()), radius, ambient);
  return heat;
}

double speed_with_heat(double f, double conducts = conductivity) {
  return commander_prosperetti(bubble(1e-4, 3e5, conduction(2 * M_PI * f, 1e-4, 3e5, conducts)), 1e-4, f);
}

}  // namespace

TEST(HeatConduction, HasThePublishedSpeedsAndTheDefaultsAtItsResonance) {
  EXPECT_NEAR(speed_with_heat(1e3), 451.9, 0.005 * 451.9);
  EXPECT_NEAR(speed_with_heat(1e4), 348.7, 0.005 * 348.7);
  EXPECT_GT(std::abs(speed_with_heat(1e4, 0.5 * conductivity) / 348.7 - 1), 0.02);  // control: half the conductivity
  const Conduction heat = at_resonance(1e-4, 3e5);
  EXPECT_NEAR(heat.polytropic, 1.16, 0.01);
  EXPECT_NEAR(heat.viscosity, 0.5, 0.02);
}

TEST(HeatConduction, IsIsothermalWhenSlowAndAdiabaticWhenFast) {
  EXPECT_NEAR(conduction(2 * M_PI, 1e-4, 1e5).polytropic, 1, 1e-5);
  EXPECT_NEAR(conduction(1e11, 1e-4, 1e5).polytropic, ratio_of_heats, 0.002);
}

TEST(HeatConduction, AgreesWithTheTableOfTheTheoryPage) {
  struct Row {
    double radius, ambient, kilohertz, polytropic, viscosity;
  };
  for (const Row& r : {Row{1e-5, 1e5, 95.7, 1.00, 0.0034},
                       {3e-5, 1e5, 27.5, 1.00, 0.014},
                       {1e-4, 1e5, 7.8, 1.01, 0.11},
                       {3e-4, 1e5, 2.6, 1.07, 0.70},
                       {5e-4, 1e5, 1.6, 1.14, 1.4},
                       {1e-5, 3e5, 143, 1.00, 0.014},
                       {3e-5, 3e5, 45.4, 1.03, 0.084},
                       {1e-4, 3e5, 14.1, 1.15, 0.51},
                       {3e-4, 3e5, 5.0, 1.33, 1.4},
                       {5e-4, 3e5, 3.1, 1.40, 2.0}}) {
    const Conduction heat = at_resonance(r.radius, r.ambient);
    EXPECT_NEAR(std::sqrt(bubble(r.radius, r.ambient, heat).natural_squared()) / (2e3 * M_PI), r.kilohertz, 0.01 * r.kilohertz);
    EXPECT_NEAR(heat.polytropic, r.polytropic, 0.006);
    EXPECT_NEAR(heat.viscosity, r.viscosity, 0.04 * r.viscosity);
  }
}
