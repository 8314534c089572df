#include "forward/mechanism/cavitation_kinetics.hpp"

#include "forward/target/built_in_model.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/unit/forward/mechanism/column.hpp"
#include "tests/verification/one_point.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double k = mercury_density * mercury_speed * mercury_speed, cutoff = 1.5e5;
const Riemer riemer{k, cutoff, 2000};

/// A drive that opens and closes several times.
double strain_at(double t) { return 4e-4 * std::sin(2.1e5 * t) * std::sin(3e4 * t) + 1e-4 * std::sin(0.9e5 * t); }

}  // namespace

// With both times 0 the law is Riemer's, viscosity and heat included. With either of them it is not.
TEST(CavitationKinetics, WithoutTimesItIsRiemersLaw) {
  const double dt = 2e-7;
  const KineticLiquid at_once(riemer, 0, 0), slow(riemer, 5e-6, 0), slow_back(riemer, 0, 5e-6);
  DrivenPoint a(at_once, dt), b(slow, dt), c(slow_back, dt);
  double growing = 0, closing = 0;
  int open = 0;
  for (int n = 1; n < 2000; ++n) {
    const double t = n * dt, e = strain_at(t), p0 = 5e6 * std::min(1.0, t / 7e-7), exact = riemer.pressure(p0, e, (e - strain_at(t - dt)) / dt);
    const double scale = k * 5e-4;
    EXPECT_NEAR(a.step(e, p0), exact, 1e-12 * scale);
    growing = std::max(growing, std::abs(b.step(e, p0) - exact) / scale);
    closing = std::max(closing, std::abs(c.step(e, p0) - exact) / scale);
    open += exact == -cutoff;
  }
  EXPECT_GT(open, 100);
  EXPECT_GT(growing, 0.1);
  EXPECT_GT(closing, 0.1);
}

// Mercury that is stretched at once and held relaxes with the time constant of growth; compressed, with that of collapse. Both are exact at any step.
TEST(CavitationKinetics, AHeldStretchRelaxesExponentially) {
  const double growth = 3e-5, collapse = 8e-5, pulled = 2e-4, x = pulled - cutoff / k;
  for (const double dt : {1e-7, 1e-5}) {
    const KineticLiquid law({k, cutoff, 0}, growth, collapse);
    DrivenPoint point(law, dt);
    const int steps = int(std::lround(6e-5 / dt));
    double p = 0;
    for (int n = 1; n <= steps; ++n) {
      p = point.step(pulled);
      EXPECT_NEAR(p, -cutoff - k * x * std::exp(-n * dt / growth), 1e-9 * k * x);
    }
    const double alpha = point.state(0), pushed = 0.5 * pulled, y = pushed - cutoff / k;
    EXPECT_NEAR(alpha, x * (1 - std::exp(-6e-5 / growth)), 1e-9 * x);
    EXPECT_GT(alpha, y);
    for (int n = 1; n <= steps; ++n) EXPECT_NEAR(point.step(pushed), -cutoff + k * (alpha - y) * std::exp(-n * dt / collapse), 1e-9 * k * x);
    point.step(0);
    for (int n = 0; n < 100 * steps && point.state(0) > 0; ++n) point.step(-cutoff / k);
    EXPECT_EQ(point.state(0), 0);  // the void closes in the end, and the equation of state holds again
    EXPECT_NEAR(point.step(-1e-4), k * 1e-4, 1e-3);
  }
}

// The work done on the void over a cycle is (-p - sigma_c) dalpha, never negative in any part. Riemer's law takes none.
TEST(CavitationKinetics, GrowthAndCollapseDissipate) {
  const auto work = [](double growth, double collapse) {
    const double dt = 2e-8;
    const KineticLiquid law({k, cutoff, 0}, growth, collapse);
    DrivenPoint point(law, dt);
    double done = 0, lost = 0, before = 0, p_before = 0, alpha = 0;
    for (int n = 1; n <= 5000; ++n) {
      const double e = 2e-4 * std::pow(std::sin(M_PI * n / 5000.0), 2), p = point.step(e), now = point.state(0);
      EXPECT_GE(-(p + cutoff) * (now - alpha), 0);
      done -= 0.5 * (p + p_before) * (e - before);
      lost -= (0.5 * (p + p_before) + cutoff) * (now - alpha);
      before = e;
      p_before = p;
      alpha = now;
    }
    for (int n = 0; n < 400000; ++n) {  // until the void is closed
      const double p = point.step(0), now = point.state(0);
      lost -= (0.5 * (p + p_before) + cutoff) * (now - alpha);
      p_before = p;
      alpha = now;
    }
    EXPECT_NEAR(lost, done, 2e-3 * std::max(done, 1e-3 * k * 4e-8));
    return done / (0.5 * k * 4e-8);
  };
  measured("dissipated_share", work(2e-5, 5e-5));
  EXPECT_GT(work(2e-5, 5e-5), 0.1);
  EXPECT_LT(std::abs(work(0, 0)), 1e-3);
}

// A wall that recedes from the mercury is pulled by more than the cutoff for about the time of growth. The traction of the pair is
// (sigma_c + R v) / (1 + R (1/Z_s + 1/Z_m)), R = K growth_time / l, l half an element, v the velocity with which the mercury separates.
TEST(CavitationKinetics, AWallPartsAndMeetsAgainstAResistance) {
  const double h = 0.001;
  Mesh mesh = block({80, 1, 1}, {-0.04, 0, 0}, {0.04, h, h}, [](const Vec3& x) { return x[0] < 0 ? Region::mercury : Region::steel; });
  fix(mesh, 2 | 4, everywhere());
  split(mesh, {Vec3{1, 0, 0}});
  mesh.wetted = faces_at(mesh, 0, 0);
  std::vector<bool> mercury(mesh.nodes.size(), false);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::mercury)
      for (const NodeId n : mesh.elements[e]) mercury[std::size_t(n)] = true;
  const double z_m = mercury_density * mercury_speed, z_s = steel_density * steel_speed(), z = z_m * z_s / (z_m + z_s), tau = 3e-7, v = 1, hold = 0.2 * z * v;
  const std::vector<ObservationRow> rows{component(mesh.slip[0].steel, 0), component(mesh.slip[0].mercury, 0)};
  const ExplicitSolver solver(mesh, steel());
  const auto moving = [&](double velocity, double gap, double parting, double meeting) {
    RunSetup s = linear_setup(1.2e-5, 1.2e-5 / 200);
    for (const bool m : mercury) s.initial_velocity.push_back({m ? velocity : 0, 0, 0}), s.initial_displacement.push_back({m ? -gap : 0, 0, 0});
    s.wetted_cutoff = hold;
    s.parting_time = parting;
    s.meeting_time = meeting;
    return s;
  };
  const auto rate = [](const SolveSummary& out, std::size_t row) {
    const auto u = row_of(out, row);
    return (u[190] - u[60]) / (out.times[190] - out.times[60]);
  };
  const double resistance = k * tau / (0.5 * h);
  const double pull = (hold + resistance * v) / (1 + resistance / z), push = (hold - resistance * v) / (1 + resistance / z);
  EXPECT_GT(pull, 2 * hold);
  EXPECT_LT(push, 0);
  for (const char* precision : {"double", "single"})
    for (const std::size_t runs : {1, 8}) {
      SolveOptions o;
      o.precision = precision;
      o.energy_balance = runs == 1;
      RunSetup off = moving(-v, 0, tau, 0), on = moving(v, 1e-4, 0, tau);
      off.energies.assign(runs, 1.0);
      on.energies.assign(runs, 1.0);
      const auto apart = solver.solve(off, rows, o), together = solver.solve(on, rows, o);
      EXPECT_NEAR(rate(apart, 0), -pull / z_s, 0.01 * v) << precision << runs;
      EXPECT_NEAR(rate(apart, 1), -v + pull / z_m, 0.01 * v) << precision << runs;
      EXPECT_NEAR(rate(together, 0), -push / z_s, 0.01 * v) << precision << runs;
      if (runs > 1) continue;
      EXPECT_LT(apart.energy_balance_error, *precision == 'd' ? 1e-9 : 1e-3);
      EXPECT_LT(together.energy_balance_error, *precision == 'd' ? 1e-9 : 1e-3);
      EXPECT_GT(apart.dissipated, 0);
      // Control: a void that grows at once pulls with the cutoff, and a time of the other kind changes nothing.
      EXPECT_NEAR(rate(solver.solve(moving(-v, 0, 0, 0), rows, o), 0), -hold / z_s, 0.01 * v);
      EXPECT_EQ(solver.solve(moving(-v, 0, 0, tau), rows, o).observations, solver.solve(moving(-v, 0, 0, 0), rows, o).observations);
    }
}

// With nuclei a nanometre apart the law is Riemer's; with nuclei a millimetre apart it is not.
TEST(CavitationKinetics, ManyNucleiAreRiemersLaw) {
  const double dt = 2e-7;
  const NucleatedLiquid many(riemer, mercury_density, 1e-9), few(riemer, mercury_density, 1e-3);
  DrivenPoint a(many, dt), b(few, dt);
  double away = 0;
  for (int n = 1; n < 2000; ++n) {
    const double t = n * dt, e = strain_at(t), p0 = 5e6 * std::min(1.0, t / 7e-7), exact = riemer.pressure(p0, e, (e - strain_at(t - dt)) / dt);
    EXPECT_NEAR(a.step(e, p0), exact, 1e-12 * k * 5e-4);
    away = std::max(away, std::abs(b.step(e, p0) - exact) / (k * 5e-4));
  }
  EXPECT_GT(away, 0.1);
}

// A nucleus in mercury that is stretched at once and held first grows after Rayleigh under a constant tension T = K x, R = t sqrt(2 T/(3 rho)). As the void
// takes up the stretch, dr/dt = w sqrt(x - r^3), r = R/a, which quadrature solves. It ends at the balance, to the last bit of a cube root. Under compression it
// closes in the time of the same law backwards.
TEST(CavitationKinetics, ANucleusGrowsAgainstTheInertiaOfTheMercury) {
  const double spacing = 2e-3, a = std::cbrt(3 / (4 * M_PI)) * spacing, pulled = 2e-4, x = pulled - cutoff / k, tension = k * x;
  const double w = std::sqrt(2 * k / (3 * mercury_density)) / a;
  const auto time_to = [&](double r_end) {  // integral of dr / (w sqrt(x - r^3)), with r = r_max (1 - s^2) near the zero of the root
    const double top = std::cbrt(x), end = std::sqrt(1 - r_end / top);
    const int n = 20000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double s = end + (i + 0.5) / n * (1 - end), r = top * (1 - s * s);
      sum += 2 * top * s / (w * std::sqrt(x - r * r * r)) * (1 - end) / n;
    }
    return sum;
  };
  for (const double dt : {1e-8, 1e-7}) {
    const NucleatedLiquid law({k, cutoff, 0}, mercury_density, spacing);
    DrivenPoint point(law, dt);
    double early = 0, half = 0, whole = 0;
    for (int n = 1; n <= int(1e-3 / dt) && whole == 0; ++n) {
      const double p = point.step(pulled), radius = a * point.state(0);
      if (std::abs(n * dt - 1e-6) < 0.5 * dt) early = radius;
      if (half == 0 && point.state(0) >= 0.5 * std::cbrt(x)) half = n * dt;
      if (std::abs(p + cutoff) < 1e-9 * tension) whole = n * dt;
    }
    EXPECT_NEAR(early, 1e-6 * std::sqrt(2 * tension / (3 * mercury_density)), 2e-3 * early);
    EXPECT_NEAR(half, time_to(0.5 * std::cbrt(x)), 1e-3 * half + 2 * dt);
    EXPECT_NEAR(whole, time_to(std::cbrt(x)), 0.02 * whole + 2 * dt);
    measured("half_grown_us", 1e6 * half);
    measured("grown_us", 1e6 * whole);
    // The void closes under a constant pressure P - sigma_c far above its own. The radius falls at sqrt(2 P/(3 rho)), and the equation of state holds again.
    double closed = 0;
    const double start = a * point.state(0), pushed = -3e-3;
    for (int n = 1; closed == 0 && n < 100000; ++n) {
      point.step(pushed);
      if (point.state(0) == 0) closed = n * dt;
    }
    EXPECT_NEAR(closed, start / std::sqrt(2 * k * 3e-3 / (3 * mercury_density)), 0.1 * closed + dt);
    EXPECT_NEAR(point.step(pushed), -k * pushed, 1e-6 * k * 3e-3);
  }
}

// The dissipation is (-p - sigma_c) dalpha, never negative.
TEST(CavitationKinetics, NucleiDissipate) {
  const double dt = 2e-8;
  const NucleatedLiquid law({k, cutoff, 0}, mercury_density, 2e-3);
  DrivenPoint point(law, dt);
  double lost = 0, alpha = 0;
  for (int n = 1; n <= 20000; ++n) {
    const double p = point.step(2e-4 * std::pow(std::sin(M_PI * n / 5000.0), 2)), now = std::pow(point.state(0), 3);
    EXPECT_GE(-(p + cutoff) * (now - alpha), -1e-9 * k * 4e-8);
    lost -= (p + cutoff) * (now - alpha);
    alpha = now;
  }
  EXPECT_GT(lost, 0.05 * k * 4e-8);
}

// Only one of the two laws may be used at a time.
TEST(CavitationKinetics, TimesAndNucleiTogetherAreRefused) {
  const ForwardCase c = small_case("[mechanism.cavitation_kinetics]\nenabled = true\ngrowth_time = 1e-6\nnuclei_spacing = 1e-3\n");
  try {
    const auto p = BuiltInModel(c, {.pulses = 1}).evaluate({});
    EXPECT_FALSE(p.ok);
    EXPECT_NE(p.message.find("nuclei_spacing"), std::string::npos) << p.message;
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("nuclei_spacing"), std::string::npos) << e.what();
  }
}

// The law departs from the base model without a jump: very short times change little, and a wall that never parts changes much.
TEST(CavitationKinetics, ShortTimesAreNearTheBaseModel) {
  const auto histories = [](ForwardCase c) {
    const auto p = BuiltInModel(c, {.pulses = 1}).evaluate({});
    EXPECT_TRUE(p.ok) << p.message;
    return p.mean;
  };
  const auto base = histories(small_case());
  const auto away = [&](const std::vector<double>& a) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference += std::pow(a[i] - base[i], 2), size += base[i] * base[i];
    return std::sqrt(difference / size);
  };
  const auto kinetic = [&](const std::string& time) {
    return away(histories(small_case("[mechanism.cavitation_kinetics]\nenabled = true\ngrowth_time = " + time + "\ncollapse_time = " + time + "\n")));
  };
  ForwardCase held = small_case();
  held.geometry.wetted = "no_separation";
  const auto nucleated = [&](const std::string& spacing) {
    return away(histories(small_case("[mechanism.cavitation_kinetics]\nenabled = true\nnuclei_spacing = " + spacing + "\n")));
  };
  const double dense = nucleated("1e-9"), sparse = nucleated("2e-3");
  measured("nuclei_1_nm_apart", dense);
  measured("nuclei_2_mm_apart", sparse);
  EXPECT_LT(dense, 1e-3);
  EXPECT_GT(sparse, 0.05);
  const double shortest = kinetic("1e-12"), short_time = kinetic("1e-9"), longer = kinetic("20e-6"), no_separation = away(histories(held));
  measured("at_1_ps", shortest);
  measured("at_1_ns", short_time);
  measured("at_20_us", longer);
  measured("no_separation", no_separation);
  EXPECT_LT(shortest, 1e-3);
  EXPECT_LT(short_time, 0.2 * no_separation);
  EXPECT_GT(longer, 0.05);
}
