// Bubbles alone, the law at one point, and its place in a run (physics.md sections 3 and 4).
#include "forward/mechanism/bubbly_liquid.hpp"

#include <complex>

#include "tests/unit/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// The bubble in a liquid whose pressure stays at p.
KellerMiksis::State under(const KellerMiksis& b, KellerMiksis::State s, double p, double span, double greatest_step = unbounded) {
  return advance_bubble(b, s, span, greatest_step, [p](double, double) { return p; }, [](double) { return 0.0; });
}

struct Collapse {
  double time, least, rebound;  ///< [s]; over R0
};

/// First minimum of the radius after the pressure has risen to p, and the maximum that follows.
Collapse collapse(const KellerMiksis& b, double p, double interval, double greatest_step = unbounded) {
  KellerMiksis::State s{b.radius, 0};
  Collapse c{0, 1, 0};
  for (double t = 0, before = 0; t < 1; t += interval, before = s.rate) {
    const double radius = s.radius / b.radius;
    if (radius < c.least) c.least = radius, c.time = t;
    s = under(b, s, p, interval, greatest_step);
    if (before > 0 && s.rate <= 0) {
      c.rebound = std::max(radius, s.radius / b.radius);
      return c;
    }
  }
  return c;
}

// Mercury at 333 K, no regularising viscosity, never at its cutoff.
const Riemer mercury{mercury_density * mercury_speed* mercury_speed, unbounded, 0};

/// Helium at 0.3 MPa in mercury, R0 100 um (physics.md section 4).
KellerMiksis helium(double kappa, double surface_tension = 0.47, double viscosity = 1.3e-3) {
  return {.density = mercury_density, .sound_speed = mercury_speed, .radius = 1e-4, .ambient = 3e5, .polytropic = kappa, .surface_tension = surface_tension, .viscosity = viscosity};
}

/// One point of a law, driven by its strain.
class OnePoint {
 public:
  OnePoint(const BubblyLiquid& law, double dt) : law_(law), dt_(dt), state_(law.state_size()) {
    const Vec3 centre{};
    law.initialise({&centre, 1}, state_.data(), 1);
  }
  double step(double strain, double heating = 0) {
    law_.advance({1, dt_, &strain, &before_, &heating, &pressure_, state_.data(), 1});
    before_ = strain;
    return pressure_;
  }
  [[nodiscard]] double radius() const { return state_[0]; }

 private:
  const BubblyLiquid& law_;
  double dt_, before_ = 0, pressure_ = 0;
  std::vector<double> state_;
};

/// Rises smoothly from 0 to 1 over the time `rise`.
double soft(double t, double rise) { return t >= rise ? 1 : 0.5 - 0.5 * std::cos(M_PI * t / rise); }

/// Speed at which sound of frequency f [Hz] runs through the law: p = -K e at e = small sin(w t), K complex, k^2 = rho w^2 / K.
double phase_speed(const BubblyLiquid& law, double f, double small) {
  const double w = 2 * M_PI * f, dt = 2.5e-7, rise = 12 / f + 2e-3, end = rise + 10 / f;
  OnePoint point(law, dt);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (double t = 0; t < end; t += dt) {
    const double p = point.step(small * soft(t, rise) * std::sin(w * t));
    if (t < rise) continue;
    const Eigen::Vector3d a(std::sin(w * t), std::cos(w * t), 1);
    normal += a * a.transpose(), right += p * a;
  }
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  const std::complex<double> modulus(-fit[0] / small, -fit[1] / small);
  return w / (w * std::sqrt(mercury_density / modulus)).real();
}

/// Commander and Prosperetti: k^2 = w^2/c^2 + 4 pi w^2 n R0 / (w0^2 - w^2 + 2 i b w), losses by viscosity and radiation.
double commander_prosperetti(const KellerMiksis& b, double alpha0, double f) {
  const double w = 2 * M_PI * f, damping = 2 * b.viscosity / (b.density * b.radius * b.radius) + w * w * b.radius / (2 * b.sound_speed);
  const std::complex<double> resonance(b.natural_squared() - w * w, 2 * damping * w);
  return w / std::sqrt(w * w / (b.sound_speed * b.sound_speed) + 3 * alpha0 * w * w / (b.radius * b.radius) / resonance).real();
}

}  // namespace

// An empty cavity: 0.91468 R0 sqrt(rho / p) (Rayleigh 1917).
TEST(Bubble, AnEmptyCavityCollapsesInRayleighsTime) {
  const KellerMiksis empty{.density = 998, .sound_speed = unbounded, .radius = 1e-4, .ambient = 0, .polytropic = 1.4, .surface_tension = 0, .viscosity = 0};
  const double p = 1e6, expected = 0.91468 * empty.radius * std::sqrt(empty.density / p), interval = 2e-4 * expected;
  KellerMiksis::State s{empty.radius, 0};
  double t = 0;
  try {
    for (; t < 2 * expected; t += interval) s = under(empty, s, p, interval);
  } catch (const NumericsError&) {  // it vanishes within this interval
  }
  measured("rayleigh_time_over_theory", t / expected);
  EXPECT_NEAR(t, expected, 1e-3 * expected);
}

// Collapse time, least radius and rebound, computed independently (physics.md section 4).
TEST(Bubble, KellerMiksisRows) {
  struct Row {
    KellerMiksis bubble;
    double pressure;  ///< absolute
    Collapse expected;
  };
  const KellerMiksis air{.density = 998, .sound_speed = 1481, .radius = 1e-4, .ambient = 1e5, .polytropic = 1.4, .surface_tension = 0, .viscosity = 0};
  for (const auto& [bubble, pressure, expected] :
       {Row{air, 10e6, {0.96846e-6, 0.10462, 0.514}}, Row{helium(1.667), 30e6, {2.0181e-6, 0.15990, 0.707}}, Row{helium(1.667), 5e6, {5.1650e-6, 0.30878, 0.934}}}) {
    // The law's own sub-steps, then twenty times finer.
    for (const double share : {1.0, 0.05}) {
      const auto got = collapse(bubble, pressure - bubble.ambient, 1e-3 * expected.time, share == 1 ? unbounded : 1e-3 * share * expected.time);
      const std::string name = std::to_string(int(pressure / 1e6)) + "MPa" + (share < 1 ? "_fine" : "");
      measured("time_error_" + name, got.time / expected.time - 1);
      measured("radius_error_" + name, got.least / expected.least - 1);
      measured("rebound_error_" + name, got.rebound / expected.rebound - 1);
      EXPECT_NEAR(got.time, expected.time, 0.002 * expected.time);
      EXPECT_NEAR(got.least, expected.least, 0.002 * expected.least);
      EXPECT_NEAR(got.rebound, expected.rebound, 0.003 * expected.rebound);
    }
    // Control: without the liquid's compressibility the rebound is higher.
    KellerMiksis incompressible = bubble;
    incompressible.sound_speed = unbounded;
    EXPECT_GT(collapse(incompressible, pressure - bubble.ambient, 1e-3 * expected.time).rebound, 1.02 * expected.rebound);
  }
}

TEST(Bubble, ItsNaturalFrequencyIsMinnaertsWithSurfaceTension) {
  EXPECT_NEAR(std::sqrt(helium(1).natural_squared()) / (2 * M_PI), 13.13e3, 0.01e3);
  EXPECT_NEAR(std::sqrt(helium(5.0 / 3).natural_squared()) / (2 * M_PI), 16.99e3, 0.01e3);
}

TEST(BubblyLiquid, StaysAtRest) {
  const BubblyLiquid law(mercury, helium(1.16), 1e-3);
  OnePoint point(law, 1e-7);
  for (int n = 0; n < 1000; ++n) ASSERT_EQ(point.step(0), 0);
  EXPECT_EQ(point.radius(), 1e-4);
}

// Slow strain of a light gas: 1/K + alpha0/p_a (Wood 1930), isothermal at 0.3 MPa.
TEST(BubblyLiquid, SlowSoundIsWoods) {
  for (const auto& [alpha0, published] : {std::pair{1e-5, 1042.}, {1e-4, 448.}, {1e-3, 148.}, {1e-2, 47.}}) {
    const double e = 1e-5 * alpha0, rise = 4e-3;
    const BubblyLiquid law(mercury, helium(1, 0, 0.5), alpha0);
    OnePoint point(law, 1e-6);
    double p = 0;
    for (double t = 0; t < rise + 2e-4; t += 1e-6) p = point.step(e * soft(t, rise));
    const double speed = std::sqrt(-p / (e * mercury_density));
    measured("wood_at_" + std::to_string(alpha0), speed);
    EXPECT_NEAR(speed, published, 0.01 * published);
  }
}

TEST(BubblyLiquid, DispersionIsCommanderAndProsperettis) {
  struct Row {
    double kappa, at_1_khz, at_10_khz;
  };
  for (const auto& [kappa, slow, fast] : {Row{1, 451.5, 302.0}, Row{5.0 / 3, 566.6, 471.2}}) {
    const KellerMiksis bubble = helium(kappa);
    const BubblyLiquid law(mercury, bubble, 1e-4);
    for (const auto& [f, published] : {std::pair{1e3, slow}, {10e3, fast}}) {
      const double c = phase_speed(law, f, 1e-9), formula = commander_prosperetti(bubble, 1e-4, f);
      measured("speed_" + std::to_string(int(f)) + "_Hz_kappa_" + std::to_string(kappa), c);
      EXPECT_NEAR(c, published, 0.005 * published);
      EXPECT_NEAR(c, formula, 0.003 * formula);
    }
    // Control: without bubbles sound keeps the speed of the liquid.
    EXPECT_NEAR(phase_speed(BubblyLiquid(mercury, bubble, 1e-12), 1e3, 1e-9), mercury_speed, 1e-3);
  }
}

// Halving the step quarters the difference: p0 and e_v are linear within a step.
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
  measured("order_of_radius", order), measured("radius_error_at_200_ns", a.first / exact.first - 1);
  EXPECT_NEAR(order, 2, 0.35);
}

TEST(BubblyLiquid, TheCutoffHoldsAndViscosityCounts) {
  const BubblyLiquid law({mercury.bulk_modulus, 1.5e5, 2000}, helium(1.16, 0.47, 0.5), 1e-9);
  OnePoint slow(law, 1e-6);
  EXPECT_EQ(slow.step(1e-4), -1.5e5);
  OnePoint fast(law, 1e-6);
  EXPECT_NEAR(fast.step(-1e-6), mercury.bulk_modulus * 1e-6 + 2000 * 1.0, 1);
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

// In a column: a precursor at the liquid's own speed is small, the wave itself comes at Wood's (here the low-frequency) speed.
TEST(BubblyLiquid, AWaveInAColumnIsSlowed) {
  const double length = 0.6, alpha0 = 1e-4;
  const Mesh mesh = column(300, length, Region::mercury);
  RunSetup s = linear_setup(1.2e-3, 2e-6);
  const KellerMiksis bubble = helium(1, 0.47, 0.5);
  s.liquid_law = std::make_shared<BubblyLiquid>(s.liquid, bubble, alpha0);
  // A push on the first tenth, slow against the bubbles.
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
