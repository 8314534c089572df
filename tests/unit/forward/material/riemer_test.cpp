#include "forward/material/riemer.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "base/random.hpp"

using namespace calomel;
using ::testing::HasSubstr;

namespace {

const Riemer mercury{28.4e9, 1.5e5, 2000};
const double p0 = 1e6;

/// Work done on a unit volume by the pressure along a path of volumetric strains at equal time steps (trapezoidal rule, as in the energy balance
/// of the solver), and the part of it that viscosity dissipates.
struct Drive {
  double work = 0, dissipated = 0;
};
template <class Path>
Drive drive(const Riemer& law, Path strain, double end, int steps) {
  Drive d;
  double before = strain(0.0), p_before = law.pressure(p0, before, 0), q_before = law.elastic_pressure(p0, before);
  for (int i = 1; i <= steps; ++i) {
    const double e = strain(end * i / steps), rate = (e - before) * steps / end;
    const double p = law.pressure(p0, e, rate), q = law.elastic_pressure(p0, e);
    d.work -= 0.5 * (p + p_before) * (e - before);
    d.dissipated -= 0.5 * ((p - q) + (p_before - q_before)) * (e - before);
    before = e;
    p_before = p;
    q_before = q;
  }
  return d;
}

}  // namespace

TEST(Riemer, IsTheEquationOfStateAboveTheCutoffAndMinusTheCutoffBelow) {
  EXPECT_DOUBLE_EQ(mercury.pressure(p0, 0, 0), p0);
  EXPECT_DOUBLE_EQ(mercury.pressure(p0, 2e-5, 0), p0 - 28.4e9 * 2e-5);
  EXPECT_DOUBLE_EQ(mercury.pressure(p0, 2e-5, 10), p0 - 28.4e9 * 2e-5 - 2e4);
  EXPECT_DOUBLE_EQ(mercury.pressure(p0, 1e-3, 0), -1.5e5);
  EXPECT_DOUBLE_EQ(mercury.pressure(p0, 1e-3, 1e3), -1.5e5);  // viscosity does not pull the pressure below the cutoff
  // The law is reversible: when the strain returns, the equation of state holds again.
  EXPECT_DOUBLE_EQ(mercury.pressure(p0, 2e-5, 0), p0 - 28.4e9 * 2e-5);
}

TEST(Riemer, IsMonotoneInStrainAndRate) {
  RandomStream random(3, 0);
  int falls = 0;
  for (int i = 0; i < 2000; ++i) {
    const double e = random.uniform(-2e-4, 2e-4), rate = random.uniform(-100, 100), more = random.uniform(0, 1e-4), faster = random.uniform(0, 100);
    EXPECT_LE(mercury.pressure(p0, e + more, rate), mercury.pressure(p0, e, rate));
    EXPECT_LE(mercury.pressure(p0, e, rate + faster), mercury.pressure(p0, e, rate));
    falls += mercury.pressure(p0, e + more, rate) < mercury.pressure(p0, e, rate);
    // Viscosity opposes the strain rate: its part of the pressure never has the sign of the rate.
    EXPECT_LE((mercury.pressure(p0, e, rate) - mercury.elastic_pressure(p0, e)) * rate, 0);
  }
  EXPECT_GT(falls, 1000);
}

TEST(Riemer, StoredEnergyHasMinusThePressureAsItsDerivative) {
  for (const double e : {-2e-4, -1e-6, 3e-5, 3.9e-5, 4.1e-5, 2e-4}) {
    const double h = 1e-10, slope = (mercury.stored_energy(p0, e + h) - mercury.stored_energy(p0, e - h)) / (2 * h);
    EXPECT_NEAR(slope, -mercury.elastic_pressure(p0, e), 1e-5 * p0) << e;
  }
  const double corner = (p0 + mercury.tensile_cutoff) / mercury.bulk_modulus;  // the pressure is continuous where the cutoff begins
  EXPECT_NEAR(mercury.stored_energy(p0, corner * (1 + 1e-12)), mercury.stored_energy(p0, corner * (1 - 1e-12)), 1e-9);
  EXPECT_GE(mercury.stored_energy(p0, corner), 0);
}

TEST(Riemer, AClosedPathReturnsItsEnergyButForWhatViscosityTakes) {
  const auto swing = [](double t) { return 1e-4 * std::sin(2 * M_PI * t / 1e-4); };
  Riemer inviscid = mercury;
  inviscid.viscosity = 0;
  const double stored = inviscid.stored_energy(p0, 1e-4);
  EXPECT_LT(std::abs(drive(inviscid, swing, 1e-4, 20000).work), 1e-6 * stored);
  const Drive d = drive(mercury, swing, 1e-4, 20000);
  EXPECT_GT(d.dissipated, 1e-3 * stored);
  EXPECT_NEAR(d.work, d.dissipated, 1e-5 * stored);
  // Without the cutoff a cycle dissipates pi eta omega a^2 (Kelvin and Voigt).
  Riemer linear = mercury;
  linear.tensile_cutoff = std::numeric_limits<double>::infinity();
  const double loss = M_PI * 2000 * (2 * M_PI / 1e-4) * 1e-8;
  EXPECT_NEAR(drive(linear, swing, 1e-4, 20000).dissipated, loss, 1e-3 * loss);
  EXPECT_LT(d.dissipated, 0.9 * loss);  // a cavitating liquid dissipates nothing
}

TEST(LiquidLaws, MakeTheLawFromItsOptions) {
  MercuryOptions o;
  const Riemer riemer = liquid_laws().get("riemer")(o, 2500);
  EXPECT_DOUBLE_EQ(riemer.bulk_modulus, 13500. * 1450 * 1450);
  EXPECT_DOUBLE_EQ(riemer.tensile_cutoff, 1.5e5);
  EXPECT_DOUBLE_EQ(riemer.viscosity, 2500);
  const Riemer linear = liquid_laws().get("linear")(o, 0);
  EXPECT_TRUE(std::isinf(linear.tensile_cutoff));
  EXPECT_LT(linear.pressure(0, 1e-2, 0), -1e8);
}

TEST(LiquidLaws, RefuseAnUnknownNameWithTheKnownOnes) {
  try {
    (void)liquid_laws().get("reimer", "material.mercury.law");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("material.mercury.law = \"reimer\""));
    EXPECT_THAT(e.what(), HasSubstr("riemer, linear"));
    EXPECT_THAT(e.what(), HasSubstr("did you mean \"riemer\""));
  }
}
