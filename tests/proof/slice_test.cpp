// The generator of concealed-physics records against what is known exactly, and its effects against the base model. Compiled in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/proof/experiment.hpp"
#include "tests/proof/slice_kernels.hpp"

using namespace calomel::proof;

namespace {

constexpr double density = 13500, speed = 1450, modulus = density * speed * speed;

/// A strip along x between rigid sides: mercury to `wetted`, solid beyond; behind its ends `left` and `right`.
Grid strip(double h, double wetted, double length, Cell left, Cell right) {
  Grid g(int(std::lround(length / h)) + 2, 6, h, -h, -h);
  g.fill(Cell::rigid, -1, 1, -1, 1);
  g.fill(Cell::mercury, 0, wetted, 0, 4 * h);
  g.fill(Cell::solid, wetted, length, 0, 4 * h);
  g.fill(left, -h, 0, 0, 4 * h);
  g.fill(right, length, length + h, 0, 4 * h);
  return g;
}

double pulse(double x) { return 1e5 * std::exp(-std::pow(x / 0.01, 2)); }

/// A pulse of pressure about `middle` that runs towards positive x.
State running(const Slice& slice, double middle, double dt) {
  State s = slice.rest();
  const Grid& g = slice.grid();
  for (int j = 0; j < g.nz; ++j)
    for (int i = 1; i < g.nx; ++i) {
      const auto c = std::size_t(g.index(i, j));
      if (g.at(i, j) != Cell::mercury) continue;
      s.p[c] = Real(pulse(g.x(i + 0.5) - middle));
      s.e[c] = -s.p[c] / Real(modulus);
      s.vx[c] = Real(pulse(g.x(i) - middle + speed * dt / 2) / (density * speed));
    }
  return s;
}

void advance(const Slice& slice, State& s, double dt, double time) {
  for (int k = 0; k < int(std::lround(time / dt)); ++k) slice.advance_velocity(s, dt), slice.advance_stress(s, dt, 0, 0);
}

/// A small vessel with every part of a case; 60 us on 1 mm take a tenth of a second.
Experiment small() {
  Experiment x;
  x.grid = 1e-3;
  x.length = 0.08;
  x.height = 0.03;
  x.front = 0.004;
  x.top = 0.004;
  x.bottom = 0.004;
  x.center = 0.014;
  x.width = 0.012;
  x.end = 60e-6;
  x.energies = {0.99, 1.01};
  x.gauges = {{.name = "T1", .x = 0.02, .z = 0.03},
              {.name = "T2", .x = 0.05, .z = 0.03},
              {.name = "B1", .x = 0.035, .z = 0},
              {.name = "F1", .x = 0, .z = 0.016, .along_x = false}};
  return x;
}

double change(const Experiment& x, const Effect& effect) {
  const auto base = mean_of(x.strains({}, x.grid, x.energies, 1), 2), with = mean_of(x.strains({effect}, x.grid, x.energies, 1), 2);
  const auto d = difference(with, base, x.gauges.size(), x.interval);
  return *std::max_element(d.raw.begin(), d.raw.end());
}

const std::vector<Effect> effects = {
    {"beam", {{"offset_z", 2e-3}, {"width_ratio", 1.1}, {"energy_ratio", 1.02}, {"pulse_length_ratio", 2}}, {}},
    {"rear_layer", {{"impedance_ratio", 0.4}, {"depth", 0.002}}, {}},
    {"bubbles", {{"small_fraction", 1e-4}, {"large_fraction", 1e-4}, {"small_radius", 3e-5}, {"large_radius", 1e-4}, {"ambient", 2e5}, {"viscosity", 0.3}}, {}},
    {"nucleation", {{"number", 1e7}, {"radius", 1e-5}, {"stronger", 0.5}, {"strength", 1e6}}, {}},
    {"relaxing_liquid", {{"viscosity", 5000}, {"time", 2e-6}}, {}},
    {"zener_steel", {{"loss", 0.05}, {"frequency", 3e4}}, {}},
    {"heated_steel", {{"rise", 2}, {"depth", 0.03}, {"expansion", 16e-6}}, {}},
    {"tait", {{"stiffening", 60}}, {}},
    {"debonding", {{"begin", 0.01}, {"length", 0.05}, {"strength", 0}}, {{"wall", "top"}}},
    {"thinning", {{"begin", 0.03}, {"length", 0.03}, {"fraction", 0.25}}, {{"wall", "top"}}},
    {"residual_ringing", {{"amplitude", 0.3}, {"after", 50e-6}}, {}},
    {"gauge_fault", {{"gain", 1.1}, {"delay", 1e-6}, {"low_pass", 1e5}, {"angle", 5}}, {{"gauge", "T2"}}},
    {"yielding", {{"stress", 5e7}, {"hardening", 1e9}}, {}},
    {"rib", {{"place", 0.034}, {"thickness", 0.004}, {"height", 0.01}}, {{"wall", "top"}}},
    {"gas_pocket", {{"begin", 0.02}, {"length", 0.03}, {"thickness", 2e-4}}, {{"wall", "top"}}},
    {"speed_gradient", {{"change", 0.1}}, {}},
    {"added_mass", {{"begin", 0.02}, {"length", 0.03}, {"mass", 10}}, {{"wall", "top"}}},
    {"slot", {{"place", 0.03}, {"width", 1e-3}, {"depth", 2e-3}}, {{"wall", "top"}}},
};

}  // namespace

TEST(ReferenceGenerator, KeepsEnergyWithoutCutoffAndViscosity) {
  Experiment x = small();
  x.rear = 0.004;
  x.cutoff = 1e15;
  x.viscosity = 0;
  x.collapse = 0;
  const Slice slice = x.slice({}, x.grid);
  const double dt = 0.99 / 0.9 * slice.stable_step();  // 0.99 of the stable step
  State s = slice.rest();
  s.keep_strain = true;
  s.total_xx.assign(s.exx.size(), 0);
  s.total_zz = s.total_xx;
  double least = 1e300, most = 0, before = 0;
  for (int k = 1; k <= 2000; ++k) {
    const State old = s;
    slice.advance_velocity(s, dt);
    const double energy = slice.kinetic_energy(old, s) + slice.stored_energy(old), ramp = std::min(k * dt / x.pulse_length, 1.0);
    if (before == 1) least = std::min(least, energy), most = std::max(most, energy);
    slice.advance_stress(s, dt, before, ramp);
    before = ramp;
  }
  EXPECT_GT(most, 1);  // J/m
  EXPECT_NEAR(least / most, 1, 1e-11);
}

TEST(ReferenceGenerator, WaveRunsAtTheSpeedOfSoundAndIsReflectedByTheImpedances) {
  const double h = 0.5e-3;
  const Solid steel = Solid::from_young(7960, 193e9, 0.29);
  const Slice slice(strip(h, 0.2, 0.3, Cell::rigid, Cell::continuing), steel, {.density = density, .sound_speed = speed, .cutoff = 1e15, .collapse = 0});
  const double dt = slice.stable_step();
  State s = running(slice, 0.05, dt);
  const Grid& g = slice.grid();
  const auto highest = [&] {
    double p = 0, x = 0;
    for (int i = 1; i < g.nx; ++i)
      if (const double v = s.p[std::size_t(g.index(i, 2))]; std::abs(v) > std::abs(p)) p = v, x = g.x(i + 0.5);
    return std::pair(p, x);
  };
  advance(slice, s, dt, 0.1 / speed);
  EXPECT_NEAR(highest().second, 0.15, 0.6e-3);
  EXPECT_NEAR(highest().first, 1e5, 200);
  advance(slice, s, dt, 0.12 / speed);  // back at 0.13
  const double steel_impedance = std::sqrt(steel.density * steel.p_modulus()),
               reflection = (steel_impedance - density * speed) / (steel_impedance + density * speed);
  EXPECT_NEAR(reflection, 0.3925, 3e-4);  // 316L and mercury at 1450 m/s
  EXPECT_NEAR(highest().first / 1e5, reflection, 0.002);
  EXPECT_NEAR(highest().second, 0.13, 1.1e-3);
  double left = 0;  // the transmitted wave has gone through the rear of the steel
  for (int i = 0; i < g.nx; ++i) left = std::max(left, std::abs(double(s.sxx[std::size_t(g.index(i, 2))])));
  EXPECT_LT(left, 0.002 * 1e5);
}

TEST(ReferenceGenerator, NothingComesBackFromTheRearFace) {
  const double h = 0.5e-3;
  const Slice slice(strip(h, 0.2, 0.2, Cell::rigid, Cell::continuing), Solid::from_young(7960, 193e9, 0.29),
                    {.density = density, .sound_speed = speed, .cutoff = 1e15, .collapse = 0});
  const double dt = slice.stable_step();
  State s = running(slice, 0.1, dt);
  advance(slice, s, dt, 0.15 / speed);
  double left = 0;
  for (const Real p : s.p) left = std::max(left, std::abs(double(p)));
  EXPECT_LT(left, 1e-3 * 1e5);
}

// Mercury that has given way, stretched by e0 and without strength, flies at V against a rigid wall: rho S V = p, S (e0 + p/K) = V behind a front of speed S
// (Rankine and Hugoniot).
TEST(ReferenceGenerator, ClosingCavityIsInelastic) {
  const double e0 = 1e-3, v = 1, length = 0.1, time = 1e-4, h = 0.5e-3;
  const double p = modulus / 2 * (std::sqrt(e0 * e0 + 4 * density * v * v / modulus) - e0), front = v / (e0 + p / modulus);
  const double lost = (0.5 * density * v * v - 0.5 * p * p / modulus) * front * time;  // per area
  const auto closing = [&](double collapse) {
    const Slice slice(strip(h, length, length, Cell::rigid, Cell::vacuum), {}, {.density = density, .sound_speed = speed, .cutoff = 0, .collapse = collapse});
    const double dt = 0.2 * slice.stable_step();
    State s = slice.rest();
    const Grid& g = slice.grid();
    for (int j = 1; j < g.nz - 1; ++j)
      for (int i = 1; i < g.nx; ++i) {
        const auto c = std::size_t(g.index(i, j));
        if (g.at(i, j) == Cell::mercury) s.e[c] = Real(e0), s.opened[c] = 1;
        if (i > 1 && i < g.nx) s.vx[c] = Real(-v);
      }
    const double start = slice.kinetic_energy(s, s);
    advance(slice, s, dt, time);
    double compressed = 0;
    for (int i = 1; g.x(i) < 0.04; ++i) compressed += h * s.e[std::size_t(g.index(i, 2))];
    const double end = slice.kinetic_energy(s, s) + slice.stored_energy(s);
    return std::pair(compressed / (-0.04 * p / modulus), (start - end) / (4 * h * lost));
  };
  const auto [displacement, energy] = closing(Mercury{}.collapse);
  EXPECT_NEAR(displacement, 1, 0.005);
  EXPECT_NEAR(energy, 1, 0.02);
  EXPECT_LT(closing(0).first, 0.8) << "without the viscosity of closing";
}

// A wall that is pulled away does not carry mercury with it: the solid flies on with what the cutoff leaves, a gap opens in front of it.
TEST(ReferenceGenerator, MercuryPartsFromTheWall) {
  const double h = 0.5e-3, cutoff = 1e5, thrown = 1, time = 10e-6;
  const Slice slice(strip(h, 0.1, 0.104, Cell::rigid, Cell::vacuum), Solid::from_young(7960, 193e9, 0.29),
                    {.density = density, .sound_speed = speed, .cutoff = cutoff});
  State s = slice.rest();
  const Grid& g = slice.grid();
  for (int j = 1; j < g.nz - 1; ++j)
    for (int i = 1; i < g.nx; ++i)
      if (g.at(i, j) == Cell::solid || g.at(i - 1, j) == Cell::solid) s.ux[std::size_t(g.index(i, j))] = Real(thrown);
  advance(slice, s, slice.stable_step(), time);
  const double wall = thrown - cutoff * time / (7960 * 0.004);  // mean velocity of the plate
  const double mercury = cutoff / (density * speed);            // of the mercury behind its tension wave
  double mean = 0;
  for (int k = 0; k <= 8; ++k) mean += s.ux[std::size_t(g.index(201 + k, 2))] * (k == 0 || k == 8 ? 0.5 : 1) / 8;
  EXPECT_NEAR(mean, wall, 1e-4);
  EXPECT_NEAR(s.contacts.front().gap, thrown * time - 0.5 * cutoff * time * time / (7960 * 0.004) - mercury * time, 0.03 * thrown * time);
}

// Where the walls hold, their faces never part, and the mercury behind them gives way in their place.
TEST(ReferenceGenerator, MercuryThatCannotPartGivesWayBehindTheFaces) {
  Experiment x = small();
  const auto run = [&](double wall_strength_ratio) {
    x.wall_strength_ratio = wall_strength_ratio;
    const Slice slice = x.slice({}, x.grid);
    const double dt = slice.stable_step();
    State s = slice.rest();
    std::ptrdiff_t parted = 0;
    double before = 0;
    for (double t = dt; t < 60e-6; t += dt) {
      slice.advance_velocity(s, dt);
      const double ramp = std::min(t / x.pulse_length, 1.0);
      slice.advance_stress(s, dt, before, ramp);
      before = ramp;
      parted = std::max(parted, std::count_if(s.contacts.begin(), s.contacts.end(), [](const Contact& c) { return c.apart; }));
    }
    return std::pair(parted, std::count_if(s.opened.begin(), s.opened.end(), [](auto opened) { return opened != 0; }));
  };
  EXPECT_GT(run(1).first, 0);
  const auto [parted, opened] = run(1e9);
  EXPECT_EQ(parted, 0);
  EXPECT_GT(opened, 0);
}

// The laws of the effects against formulas.

/// Moves of the lowest mode of a closed strip: (time of the first zero of its velocity, amplitude after `periods` over that at the start).
struct Mode {
  double quarter = 0, left = 0;
};
Mode lowest_mode(Slice& slice, double length, bool solid, double frequency, int periods) {
  const double dt = slice.stable_step();
  State s = slice.rest();
  const Grid& g = slice.grid();
  auto& v = solid ? s.ux : s.vx;
  for (int j = 1; j < g.nz - 1; ++j)
    for (int i = 2; i < g.nx - 1; ++i) v[std::size_t(g.index(i, j))] = Real(1e-4 * std::sin(std::numbers::pi * g.x(i) / length));
  const auto middle = std::size_t(g.index(g.nx / 2, 2));
  Mode m;
  double before = v[middle];
  const int steps = int(periods / frequency / dt) + 1;
  for (int k = 1; k <= steps; ++k) {
    slice.advance_velocity(s, dt);
    slice.advance_stress(s, dt, 0, 0);
    const double now = v[middle];
    if (m.quarter == 0 && now < 0) m.quarter = (k - 0.5 + before / (before - now)) * dt - dt / 2;
    before = now;
    if (k > steps - 1.1 / frequency / dt) m.left = std::max(m.left, now / 1e-4);
  }
  return m;
}

TEST(ReferenceGenerator, BubblyMercuryHasWoodsSpeed) {
  Slice slice(strip(1e-3, 0.1, 0.1, Cell::rigid, Cell::rigid), {}, {.density = density, .sound_speed = speed, .cutoff = 1e15, .viscosity = 0, .collapse = 0});
  slice.bubbles = {.fraction = {0.4e-4, 0.6e-4}, .radius = {1e-5, 2e-5}, .ambient = 3e5, .tension = 0, .viscosity = 0};
  const double wood = 1 / std::sqrt(1 / (speed * speed) + density * 1e-4 / 3e5);
  EXPECT_NEAR(wood, 448, 1);
  EXPECT_NEAR(0.1 / 2 / lowest_mode(slice, 0.1, false, wood / 0.2, 1).quarter / wood, 1, 0.01);
}

/// One cell of mercury at a held pressure: its modulus is next to none.
struct HeldCell {
  Real p = 0, e = 0, opened = 0, radius = 1, growth = 0, other = 1, other_growth = 0, heat = 0, vx[2] = {0, 0}, vz = 0;
  kernel::Liquid liquid{.modulus = Real(1e-20), .viscosity = 0, .front = 0, .cutoff = Real(1e5), .dt = Real(2e-8), .per_h = 1, .ramp = 1};
  void nuclei(const kernel::Nuclei& n) { kernel::nucleation(&p, &e, &opened, &radius, &other, &heat, vx, &vz, &vz, liquid, n, 1); }
  void bubbles(const kernel::Cloud& c) { kernel::bubbly(&p, &e, &opened, &radius, &growth, &other, &other_growth, &heat, vx, &vz, &vz, liquid, c, 1); }
};

// Either kind of nucleus grows under the tension beyond its own cutoff at the rate sqrt(2/3 tension/rho), and closes to where it began.
TEST(ReferenceGenerator, NucleiGrowAtRayleighsRate) {
  const double radius = 1e-5, tension = 1e6, stronger = 6e5;
  const kernel::Nuclei nuclei{
      .fraction = {Real(1e-9), Real(1e-9)}, .cutoff = {Real(1e5), Real(1e5 + stronger)}, .speed = Real(std::sqrt(2 / (3 * density)) / radius)};
  HeldCell cell;
  cell.heat = Real(-1e5 - tension);
  for (int k = 0; k < 1000; ++k) cell.nuclei(nuclei);
  EXPECT_NEAR(radius * double(cell.radius - 1), 2e-5 * std::sqrt(2 * tension / (3 * density)), 1e-3 * radius);
  EXPECT_NEAR(radius * double(cell.other - 1), 2e-5 * std::sqrt(2 * (tension - stronger) / (3 * density)), 1e-3 * radius);
  cell.heat = Real(tension);
  for (int k = 0; k < 1000; ++k) cell.nuclei(nuclei);
  EXPECT_EQ(cell.radius, 1);
  EXPECT_EQ(cell.other, 1);
}

// What is empty closes in Rayleigh's time, 0.91468 R sqrt(rho/p): if the convection slowed it, it would take longer.
TEST(ReferenceGenerator, AnEmptyBubbleClosesInRayleighsTime) {
  const double size = 2e-4, pressure = 1e6, expected = 0.91468 * size * std::sqrt(density / pressure);
  const kernel::Cloud cloud{
      .fraction = {0, 0}, .per_inertia = {Real(1 / (density * size * size)), Real(1)}, .surface = {0, 0}, .damping = {0, 0}, .ambient = 0};
  HeldCell cell;
  cell.heat = Real(pressure);
  cell.liquid.cutoff = Real(1e15);
  int steps = 0;
  for (; cell.radius > Real(0.1) && steps < 10000; ++steps) cell.bubbles(cloud);
  EXPECT_NEAR(steps * 2e-8, expected, 0.02 * expected);
}

TEST(ReferenceGenerator, ZenerSolidHasItsLossRatio) {
  const Solid steel = Solid::from_young(7960, 193e9, 0.29);
  const double frequency = std::sqrt(steel.p_modulus() / steel.density) / 0.2;
  Slice slice(strip(1e-3, 0, 0.1, Cell::rigid, Cell::rigid), steel, {.density = density, .sound_speed = speed});
  slice.zener = {.strength = 4 * 0.01, .time = 1 / (2 * std::numbers::pi * frequency)};
  EXPECT_NEAR(std::log(lowest_mode(slice, 0.1, true, frequency, 10).left), -0.01 * 2 * std::numbers::pi * 9.5, 0.05);  // within the last period
}

TEST(ReferenceGenerator, RelaxingLiquidHasTheLossOfItsViscosity) {
  const double frequency = speed / 0.2, omega = 2 * std::numbers::pi * frequency, time = 5e-6, zeta = 3e4;
  Slice slice(strip(1e-3, 0.1, 0.1, Cell::rigid, Cell::rigid), {}, {.density = density, .sound_speed = speed, .cutoff = 1e15, .viscosity = 0, .collapse = 0});
  slice.relaxing = {.viscosity = zeta, .time = time};
  slice.step_share = 0.3;
  const double rate = omega * omega * zeta / (1 + omega * omega * time * time) / (2 * modulus);
  EXPECT_NEAR(std::log(lowest_mode(slice, 0.1, false, frequency, 10).left) / (-rate * 9.5 / frequency), 1, 0.08);
}

TEST(ReferenceGenerator, YieldingWaveHasAnElasticPrecursor) {
  const double h = 0.25e-3, limit = 2e8, poisson = 0.29;
  const Solid steel = Solid::from_young(7960, 193e9, poisson);
  Slice slice(strip(h, 0, 0.1, Cell::rigid, Cell::vacuum), steel, {.density = density, .sound_speed = speed});
  slice.yielding = {.stress = limit, .hardening = 0};
  State s = slice.rest();
  const Grid& g = slice.grid();
  for (int j = 1; j < g.nz - 1; ++j)
    for (int i = 2; i < g.nx; ++i) s.ux[std::size_t(g.index(i, j))] = Real(-40);
  advance(slice, s, slice.stable_step(), 12e-6);
  // Between the fronts, which run at 5637 and (bulk modulus) 4380 m/s: uniaxial strain at the limit.
  double mean = 0;
  for (int k = -8; k < 8; ++k) mean += s.sxx[std::size_t(g.index(int(0.060 / h) + k, 2))] / 16;
  EXPECT_NEAR(mean / (-limit * (1 - poisson) / (1 - 2 * poisson)), 1, 0.02);
}

TEST(ReferenceGenerator, RearLayerReflectsByItsImpedanceAndFromItsDepth) {
  const double ratio = 0.4, depth = 0.02;
  Slice slice(strip(0.5e-3, 0.2, 0.2, Cell::rigid, Cell::continuing), Solid::from_young(7960, 193e9, 0.29),
              {.density = density, .sound_speed = speed, .cutoff = 1e15, .collapse = 0});
  slice.behind = {.coefficient = (ratio - 1) / (ratio + 1), .delay = 2 * depth / speed};
  const double dt = slice.stable_step();
  State s = running(slice, 0.12, dt);
  const double from_face = 0.06;
  advance(slice, s, dt, (0.08 + 2 * depth + from_face) / speed);
  const Grid& g = slice.grid();
  int peak = 1;
  for (int i = 1; i < g.nx - 1; ++i)
    if (std::abs(s.p[std::size_t(g.index(i, 2))]) > std::abs(s.p[std::size_t(g.index(peak, 2))])) peak = i;
  EXPECT_NEAR(double(s.p[std::size_t(g.index(peak, 2))]) / 1e5, (ratio - 1) / (ratio + 1), 0.003);
  EXPECT_NEAR(g.x(peak + 0.5), 0.2 - from_face, 2 * g.h);
}

// Every effect at no strength is the base model.
TEST(ReferenceGenerator, EffectOfNoStrengthIsTheBaseModel) {
  const Experiment x = small();
  EXPECT_EQ(x.strains({}, x.grid, x.energies, 1), x.strains({}, x.grid, x.energies, 2));
  for (const auto& effect : effects) {
    Effect off = effect.scaled(effect.name == "nucleation" ? 1e-3 : 0);
    // Many nuclei yield at the cutoff but for the shock of a single cell.
    const double allowed = effect.name == "nucleation" ? 0.05 : effect.name == "residual_ringing" || effect.name == "tait" ? 1e-6 : 0;
    EXPECT_LE(change(x, off), allowed) << effect.name;
  }
}

// A pocket far thinner than a micrometre would be a face that lets go, which the library has.
TEST(ReferenceGenerator, AWeakGasPocketIsShortAndNoThinner) {
  const auto pocket = std::find_if(effects.begin(), effects.end(), [](const Effect& e) { return e.name == "gas_pocket"; });
  ASSERT_NE(pocket, effects.end());
  const Effect weak = pocket->scaled(0.1);
  EXPECT_DOUBLE_EQ(weak["thickness"], (*pocket)["thickness"]);
  EXPECT_DOUBLE_EQ(weak["length"], 0.1 * (*pocket)["length"]);
  EXPECT_DOUBLE_EQ(weak["begin"], (*pocket)["begin"]);
}

TEST(ReferenceGenerator, EveryEffectChangesTheRecord) {
  const Experiment x = small();
  for (const auto& effect : effects) {
    const double made = change(x, effect);
    EXPECT_GT(made, 0.01) << effect.name;
    EXPECT_LT(made, 3) << effect.name;
  }
}
