#include "forward/mechanism/liquid_viscosity.hpp"

#include "tests/unit/forward/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;

// A plane wave decays along its path as w^2 (zeta + eta) / (2 rho c^3); a standing wave decays in time c times as fast.
TEST(LiquidViscosity, AttenuatesWithTheSquareOfTheFrequency) {
  const double length = 0.1;
  const Mesh mesh = column(100, length, Region::mercury);
  const auto entry = liquid_viscosity();
  double first = 0;
  for (const int half_waves : {4, 8}) {
    const double k = half_waves * M_PI / length, w = mercury_speed * k;
    RunSetup s = linear_setup(0, 0);
    s.liquid.viscosity = 500;
    entry.setup(values_of(entry, {{"zeta", 1500}}), s);
    EXPECT_EQ(s.liquid.viscosity, 2000);
    const auto got = decay(mesh, s, k, w, 3);
    const double theory = w * w * 2000 / (2 * mercury_density * mercury_speed * mercury_speed);
    measured("attenuation_over_theory_" + std::to_string(half_waves), got.rate / theory);
    EXPECT_NEAR(got.rate, theory, 0.02 * theory);
    if (half_waves == 4)
      first = got.rate;
    else
      EXPECT_NEAR(got.rate / first, 4, 0.1);
    EXPECT_LT(got.energy_error, 1e-6);
  }
}
