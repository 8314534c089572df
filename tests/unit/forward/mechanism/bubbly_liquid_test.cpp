// Bubbly liquid at one point and in a run. Single bubbles and the speed of sound are tested in tests/verification/bubble_test.cpp.
#include "base/random.hpp"
#include "tests/verification/bubbles.hpp"
#include "tests/unit/forward/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

TEST(BubblyLiquid, RemainsAtRest) {
  const BubblyLiquid law(mercury, helium(1.16), 1e-3);
  OnePoint point(law, 1e-7);
  for (int n = 0; n < 1000; ++n) ASSERT_EQ(point.step(0), 0);
  EXPECT_EQ(point.radius(), 1e-4);
}

// Halving the step quarters the difference, because p0 and e_v are linear within a step.
TEST(BubblyLiquid, IsOfSecondOrderInTheStep) {
  const BubblyLiquid law({mercury.bulk_modulus, 1.5e5, 2000}, helium(1.16, 0.47, 0.5), 1e-4);
  const auto run = [&](double dt) {
    OnePoint point(law, dt);
    double p = 0;
    const int steps = int(std::lround(6e-6 / dt));
    for (int n = 0; n <= steps; ++n) {
      const double t = n * dt;
      p = point.step(8e-4 * std::sin(2e5 * t) * std::sin(2e5 * t), 2e7 * std::sin(2e5 * t) * std::sin(2e5 * t));
    }
    return std::pair{point.radius(), p};
  };
  const auto a = run(2e-7), b = run(1e-7), c = run(5e-8), exact = run(2.5e-9);
  const double order = std::log2((b.first - exact.first) / (c.first - exact.first));
  measured("order_of_radius", order);
  measured("radius_error_at_200_ns", a.first / exact.first - 1);
  EXPECT_NEAR(order, 2, 0.35);
}

TEST(BubblyLiquid, TheCutoffHoldsAndViscosityCounts) {
  const BubblyLiquid law({mercury.bulk_modulus, 1.5e5, 2000}, helium(1.16, 0.47, 0.5), 1e-9);
  OnePoint slow(law, 1e-6);
  EXPECT_EQ(slow.step(1e-4), -1.5e5);
  OnePoint fast(law, 1e-6);
  EXPECT_NEAR(fast.step(-1e-6), mercury.bulk_modulus * 1e-6 + 2000 * 1.0, 1);
}

namespace {

/// The result that the kernels must have, point by point: advance_bubble under the pressure of the law.
struct Reference {
  Riemer liquid;
  KellerMiksis bubble;
  double alpha0;
  /// State R, R' at the end of a step; pressure there.
  double step(KellerMiksis::State& s, double before, double strain, double heating_before, double heating, double dt) const {
    const double slope = (strain - before) / dt, heating_slope = (heating - heating_before) / dt,
                 coupling = 3 * alpha0 * liquid.bulk_modulus / (bubble.density * std::pow(bubble.radius, 3));
    const auto pressure = [&](double e_v, double p0, double r) { return liquid.pressure(p0, e_v - alpha0 * std::pow(r / bubble.radius, 3) + alpha0, slope); };
    s = advance_bubble(
        bubble, s, dt, 0.4 / std::sqrt(bubble.natural_squared() + coupling * bubble.radius),
        [&](double t, double r) { return pressure(before + slope * t, heating_before + heating_slope * t, r); }, [&](double r) { return coupling * r; });
    return pressure(strain, heating, s.radius);
  }
};

}  // namespace

// Kernels of every instruction set advance many points at once. Each point is as if it were alone: at rest, in gentle motion and in collapses of 100 sub-steps.
TEST(BubblyLiquid, ManyPointsMoveAsEachAlone) {
  const Reference reference{{mercury.bulk_modulus, 1.5e5, 2000}, helium(1.16, 0.47, 0.5), 1e-4};
  RandomStream random(7, 0);
  for (const auto isa : instruction_sets()) {
    const BubblyLiquid law(reference.liquid, reference.bubble, reference.alpha0, isa);
    double worst = 0;
    for (const std::size_t count : {1u, 3u, 4u, 8u, 13u, 32u}) {
      const double dt = 2e-7, r0 = reference.bubble.radius, scale = reference.bubble.ambient;
      std::vector<double> state(3 * count), strain(count), before(count), heating(count), pressure(count);
      std::vector<KellerMiksis::State> exact;
      for (std::size_t i = 0; i < count; ++i) {
        const bool rest = i % 5 == 4, violent = i % 3 == 1;
        state[i] = rest ? r0 : (violent ? 0.3 : random.uniform(0.5, 3)) * r0;
        state[count + i] = rest ? 0 : violent ? -60 : random.uniform(-5, 5);
        state[2 * count + i] = rest ? 0 : random.uniform(0, 5e5);
        before[i] = rest ? 0 : random.uniform(-1e-5, 1e-4);
        strain[i] = rest ? 0 : before[i] + random.uniform(-1e-5, 1e-5);
        heating[i] = rest ? 0 : state[2 * count + i] + random.uniform(0, 1e5);
        exact.push_back({state[i], state[count + i]});
      }
      std::vector<double> alone;
      for (std::size_t i = 0; i < count; ++i)
        alone.push_back(i % 5 == 4 ? 0 : reference.step(exact[i], before[i], strain[i], state[2 * count + i], heating[i], dt));
      law.advance({count, dt, strain.data(), before.data(), heating.data(), pressure.data(), state.data(), count});
      for (std::size_t i = 0; i < count; ++i) {
        worst = std::max({worst, std::abs(state[i] / exact[i].radius - 1), std::abs(state[count + i] - exact[i].rate) / (1 + std::abs(exact[i].rate)),
                          std::abs(pressure[i] - alone[i]) / (scale + std::abs(alone[i]))});
        EXPECT_TRUE(i % 5 != 4 || pressure[i] == 0);
        EXPECT_EQ(state[2 * count + i], heating[i]);
      }
    }
    measured(std::string("worst_") + name_of(isa), worst);
    EXPECT_LT(worst, 1e-9) << name_of(isa);
  }
  // Control: with sub-steps half as long the collapses end elsewhere, by much more than rounding.
  KellerMiksis::State once{0.3 * reference.bubble.radius, -60}, finer = once;
  once = under(reference.bubble, once, 0, 2e-7);
  finer = under(reference.bubble, finer, 0, 2e-7, 2e-9);
  EXPECT_GT(std::abs(once.radius / finer.radius - 1), 1e-8);
}

// The error names the first point that cannot be followed, whatever the other points do.
TEST(BubblyLiquid, ThePointThatFailsIsNamed) {
  const KellerMiksis bubble = helium(1.16, 0.47, 0.5);
  for (const auto isa : instruction_sets()) {
    const BubblyLiquid law({mercury.bulk_modulus, unbounded, 0}, bubble, 1e-4, isa);
    for (const std::size_t bad : {0u, 5u, 10u}) {
      std::vector<double> state(33, 0), zero(11, 0), strain(11, 1e-6), pressure(11);
      for (std::size_t i = 0; i < 11; ++i) state[i] = i == bad ? 12e-4 : 1e-4;
      try {
        law.advance({11, 1e-7, strain.data(), zero.data(), zero.data(), pressure.data(), state.data(), 11});
        FAIL() << "it should have been refused";
      } catch (const LiquidPointError& e) {
        EXPECT_EQ(e.point(), bad);
        EXPECT_THAT(e.what(), HasSubstr("the bubbles fill 0.1"));
      }
      state[bad] = 0;
      try {
        law.advance({11, 1e-7, strain.data(), zero.data(), zero.data(), pressure.data(), state.data(), 11});
        FAIL() << "it should have been refused";
      } catch (const LiquidPointError& e) {
        EXPECT_EQ(e.point(), bad);
        EXPECT_THAT(e.what(), HasSubstr("collapses to nothing"));
      }
    }
  }
}

TEST(BubblyLiquid, TooMuchGasStopsTheRunWithPlaceAndTime) {
  const Mesh mesh = column(8, 0.008, Region::mercury);
  for (const auto& energies : {std::vector<double>{1.0}, std::vector<double>{0.5, 1.0}}) {
    RunSetup s = linear_setup(2e-4, 1e-6);
    s.liquid.tensile_cutoff = 10e5;
    s.energies = energies;
    s.initial_velocity = field(mesh, [](const Vec3& x) { return Vec3{x[0] > 0.0045 ? 20.0 : 0, 0, 0}; });
    s.liquid_law = std::make_shared<BubblyLiquid>(s.liquid, helium(1.16, 0.47, 0.5), 1e-2);
    try {
      (void)ExplicitSolver(mesh, steel()).solve(s, {}, {});
      FAIL() << "it should not have come to the end";
    } catch (const NumericsError& e) {
      EXPECT_THAT(e.what(), HasSubstr("the bubbles fill 0.1"));
      EXPECT_THAT(e.what(), HasSubstr("in mercury element 4 at (0.0045,"));
      EXPECT_THAT(e.what(), HasSubstr("at step"));
    }
  }
}

// In a column a precursor at the liquid's own speed is small; the wave itself comes at Wood's speed, the low-frequency one.
TEST(BubblyLiquid, AWaveInAColumnIsSlowed) {
  const double length = 0.6, alpha0 = 1e-4;
  const Mesh mesh = column(300, length, Region::mercury);
  RunSetup s = linear_setup(1.2e-3, 2e-6);
  const KellerMiksis bubble = helium(1, 0.47, 0.5);
  s.liquid_law = std::make_shared<BubblyLiquid>(s.liquid, bubble, alpha0);
  // The first tenth is pushed slowly compared with the period of the bubbles.
  s.p0.assign(mesh.elements.size(), 0);
  for (std::size_t e = 0; e < 100; ++e) s.p0[e] = 1e3 * std::pow(std::cos(M_PI * (double(e) + 0.5) / 200), 2);
  s.pulse_length = 1e-4;
  const std::vector<ObservationRow> rows{component(nearest(mesh, {0.3, 0, 0}), 0), component(nearest(mesh, {0.4, 0, 0}), 0)};
  const auto out = ExplicitSolver(mesh, steel()).solve(s, rows, {});
  const auto arrival = [&](std::size_t row) {
    const auto u = row_of(out, row);
    const double half = 0.5 * *std::max_element(u.begin(), u.end());
    std::size_t i = 1;
    while (u[i] < half) ++i;
    return out.times[i - 1] + (half - u[i - 1]) / (u[i] - u[i - 1]) * 2e-6;
  };
  const double speed = 0.1 / (arrival(1) - arrival(0)), expected = commander_prosperetti(bubble, alpha0, 100);
  measured("speed_in_the_column", speed);
  EXPECT_NEAR(speed, expected, 0.04 * expected);
}
