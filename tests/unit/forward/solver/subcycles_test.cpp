// Sub-cycling: the choice of slow elements, the conservation laws between slow and fast elements, and the limit of stability.
#include "forward/solver/subcycles.hpp"

#include <fmt/format.h>

#include "base/random.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/solver/layout.hpp"
#include "forward/solver/load.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// A plane-strain or solid box with three elements through its walls.
Mesh box(bool plane_strain = true) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.05;
  g.width = 0.04;
  g.height = 0.03;
  g.wall = 0.003;
  g.plane_strain = plane_strain;
  g.half = !plane_strain;
  g.element_size = plane_strain ? 0.002 : 0.004;
  g.rear = "non_reflecting";
  g.wall_elements = 3;
  return make_mesh(g);
}

RunSetup heated(const Mesh& mesh, double end) {
  RunSetup s = linear_setup(end, 2e-6);
  ProfileOptions profile;
  profile.center = {0, 0.015};
  profile.widths = {0.03, 0.01};
  for (const double v : heating_shape(mesh, profile).element) s.p0.push_back(25e6 * v);
  s.p0_at = [profile](const Vec3& x) { return 25e6 * profile.shape(x, true); };
  s.pulse_length = 0.7e-6;
  s.liquid.viscosity = 2000;
  s.liquid.tensile_cutoff = 1.5e5;
  return s;
}

SolveOptions cycled(int subcycles, int buffer = default_subcycle_buffer) {
  SolveOptions o;
  o.subcycles = subcycles;
  o.subcycle_buffer = buffer;
  return o;
}

}  // namespace

TEST(Subcycles, SlowElementsKeepTheirDistance) {
  const Mesh mesh = box(false);
  std::size_t before = mesh.elements.size() + 1;
  for (const int buffer : {0, 1, 2}) {
    const auto slow = slow_elements(mesh, buffer);
    std::vector<int> layer(mesh.nodes.size(), 99);  // number of mercury layers between a node and the steel, the slip pairs and the rear
    for (std::size_t e = 0; e < slow.size(); ++e)
      if (mesh.region[e] == Region::steel)
        for (const NodeId n : mesh.elements[e]) layer[std::size_t(n)] = 0;
    for (const auto& p : mesh.slip) layer[std::size_t(p.mercury)] = 0;
    for (const auto& f : mesh.rear)
      for (const NodeId n : f.nodes) layer[std::size_t(n)] = 0;
    std::vector<int> nearest(slow.size());
    for (int sweep = 0; sweep < 30; ++sweep)
      for (std::size_t e = 0; e < slow.size(); ++e) {
        nearest[e] = 99;
        for (const NodeId n : mesh.elements[e]) nearest[e] = std::min(nearest[e], layer[std::size_t(n)]);
        for (const NodeId n : mesh.elements[e]) layer[std::size_t(n)] = std::min(layer[std::size_t(n)], nearest[e] + 1);
      }
    std::size_t count = 0;
    for (std::size_t e = 0; e < slow.size(); ++e) {
      EXPECT_EQ(slow[e] != 0, mesh.region[e] == Region::mercury && nearest[e] >= buffer) << e;
      count += slow[e];
    }
    EXPECT_GT(count, 0u);
    EXPECT_LT(count, before);
    before = count;
  }
}

TEST(Subcycles, SlowBlocksAndTheirNodesComeLast) {
  const Mesh mesh = box(false);
  const auto slow = slow_elements(mesh, 1);
  const Layout layout = make_layout(mesh, std::vector<std::uint8_t>(mesh.elements.size(), 1), 64, slow);
  ASSERT_LT(layout.first_slow_block, layout.blocks.size());
  std::vector<int> touched(std::size_t(layout.nodes), 0);  // bit 0: by fast blocks, bit 1: by slow ones
  for (std::size_t b = 0; b < layout.blocks.size(); ++b)
    for (const auto e : layout.blocks[b].elements) {
      EXPECT_EQ(slow[std::size_t(e)] != 0, b >= layout.first_slow_block);
      for (const NodeId n : mesh.elements[std::size_t(e)]) touched[std::size_t(layout.to_solver[std::size_t(n)])] |= b >= layout.first_slow_block ? 2 : 1;
    }
  std::size_t border = 0, rows = 0;
  for (std::size_t i = 0; i < layout.plain.size(); ++i) {
    const int t = touched[std::size_t(layout.plain[i])];
    EXPECT_EQ(t == 2, i >= layout.first_slow_plain);
    border += t == 3;
  }
  EXPECT_GT(border, 0u);
  for (const auto& s : layout.special) EXPECT_EQ(touched[std::size_t(s.node)], 1);
  // Fast rows of the outbox come first, whichever block wrote them.
  for (std::size_t k = 0; k < layout.outbox_fast_end.size(); ++k)
    for (std::size_t i = layout.outbox_begin[k]; i < layout.outbox_begin[k + 1]; ++i, ++rows)
      EXPECT_EQ(layout.outbox_rows[i] < layout.blocks[layout.first_slow_block].outbox, i < layout.outbox_fast_end[k]);
  EXPECT_EQ(rows, layout.outbox_size);
}

TEST(Subcycles, TheCheapestDivisionThatIsStable) {
  Layout layout;
  layout.blocks.resize(2);
  layout.blocks[0].elements.resize(100);
  layout.blocks[1].elements.resize(300);
  layout.blocks[0].liquid = layout.blocks[1].liquid = true;
  layout.first_slow_block = 1;
  const auto at_most = [&](int least, int least_slow, int most) {
    const Stepping s = cheapest_stepping(layout, false, least, least_slow, most);
    EXPECT_EQ(s.per_output % s.subcycles, 0);
    EXPECT_GE(s.per_output, least);
    EXPECT_GE(s.per_output, s.subcycles > 1 ? s.subcycles * least_slow : 1);
    return std::pair(s.per_output, s.subcycles);
  };
  EXPECT_EQ(at_most(12, 3, 1), std::pair(12, 1));
  EXPECT_EQ(at_most(12, 3, 2), std::pair(12, 2));
  EXPECT_EQ(at_most(12, 3, 4), std::pair(12, 4));
  EXPECT_EQ(at_most(12, 5, 4), std::pair(12, 2));   // 3 would need 15 steps
  EXPECT_EQ(at_most(12, 12, 4), std::pair(12, 1));  // a liquid as fast as the steel
  EXPECT_EQ(at_most(6, 1, 4), std::pair(6, 3));     // 8 steps are not taken in order to have 4
  EXPECT_EQ(at_most(1, 1, 4), std::pair(1, 1));
  layout.first_slow_block = 2;  // no element is slow
  EXPECT_EQ(at_most(12, 3, 4), std::pair(12, 1));
}

// Every impulse has its counterpart: a free body with internal forces keeps its momentum to rounding.
TEST(Subcycles, MomentumIsKept) {
  Mesh mesh = block({12, 6, 8}, {0, 0, 0}, {0.024, 0.012, 0.016}, [](const Vec3& x) { return x[2] > 0.013 ? Region::steel : Region::mercury; });
  split(mesh, {Vec3{0, 0, 1}});
  RunSetup s = linear_setup(4e-5, 2e-6);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) s.p0.push_back(mesh.region[e] == Region::mercury ? 1e6 * double(e % 11) : 0);
  const auto m = masses(mesh, s);
  SolveOptions o = cycled(4);
  o.field_interval = s.end;
  double push[3]{}, size = 0;
  o.on_field = [&](const FieldSnapshot& f) {
    std::fill_n(push, 3, 0.0), size = 0;
    for (std::size_t n = 0; n < f.velocity.size(); ++n)
      for (std::size_t c = 0; c < 3; ++c) push[c] += m[Eigen::Index(n)] * f.velocity[n][c], size += m[Eigen::Index(n)] * std::abs(f.velocity[n][c]);
  };
  const auto out = ExplicitSolver(mesh, steel()).solve(s, {}, o);
  EXPECT_GT(out.subcycles, 1);
  EXPECT_GT(size, 0);
  for (const double p : push) EXPECT_LT(std::abs(p), 1e-12 * size);
}

TEST(Subcycles, OneIsTheRunWithoutThem) {
  const Mesh mesh = box();
  const RunSetup s = heated(mesh, 2e-5);
  const ExplicitSolver solver(mesh, steel());
  const std::vector<ObservationRow> rows{component(nearest(mesh, {0.02, 0, 0.03}), 2), component(nearest(mesh, {0.02, 0, 0.015}), 2)};
  const auto plain = solver.solve(s, rows, {}), one = solver.solve(s, rows, cycled(1)), four = solver.solve(s, rows, cycled(4));
  EXPECT_EQ(one.observations, plain.observations);
  EXPECT_EQ(plain.subcycles, 1);
  EXPECT_GT(four.subcycles, 1);
  EXPECT_NE(four.observations, plain.observations);
  // With a liquid faster than the steel nothing is gained.
  RunSetup fast = s;
  fast.liquid.bulk_modulus *= 100;
  EXPECT_EQ(solver.solve(fast, rows, cycled(4)).subcycles, 1);
}

// The result holds for any number of threads, lanes of runs and both precisions; liquid laws of their own receive the long step.
TEST(Subcycles, ThreadsAndLanesDoNotMatter) {
  const Mesh mesh = box(false);
  const ExplicitSolver solver(mesh, steel());
  RunSetup s = heated(mesh, 3.8e-5);
  s.output_interval = 1.9e-6;  // 12 steps of the steel: 3 of 4
  std::vector<ObservationRow> rows;
  for (std::size_t n = 0; n < mesh.nodes.size(); n += 41) rows.push_back(component(NodeId(n), mesh.fixed[n] & 1 ? 2 : 0));
  for (const char* precision : {"double", "single"}) {
    SolveOptions o = cycled(4);
    o.precision = precision;
    s.energies = {1.0};
    const auto one = solver.solve(s, rows, o);
    EXPECT_GT(one.subcycles, 1);
    for (o.threads = 2; o.threads <= 3; ++o.threads) EXPECT_EQ(solver.solve(s, rows, o).observations, one.observations) << precision << o.threads;
    s.energies = {1.0, 1.0 + 1e-6};
    const auto pair = solver.solve(s, rows, o);
    EXPECT_EQ(pair.subcycles, one.subcycles);
    double apart = 0, size = 0;
    for (std::size_t i = 0; i < one.observations.size(); ++i)
      apart += std::pow(pair.observations[i] - one.observations[i], 2), size += std::pow(one.observations[i], 2);
    EXPECT_LT(std::sqrt(apart / size), *precision == 'd' ? 1e-9 : 2e-3);
    s.energies = {1.0 + 1e-6, 1.0};  // control: the other lane is a different run
    EXPECT_NE(solver.solve(s, rows, o).observations, pair.observations);
  }
}

namespace {

/// Riemer's law as a LiquidLaw that records the steps which it receives.
class Noting : public LiquidLaw {
 public:
  explicit Noting(const Riemer& r) : riemer_(r) {}
  void advance(const LiquidPoints& p) const override {
    least = std::min(least, p.dt);
    greatest = std::max(greatest, p.dt);
    for (std::size_t i = 0; i < p.count; ++i) p.pressure[i] = riemer_.pressure(p.heating[i], p.strain[i], (p.strain[i] - p.strain_before[i]) / p.dt);
  }
  mutable double least = 1, greatest = 0;

 private:
  Riemer riemer_;
};

}  // namespace

TEST(Subcycles, ALawOfItsOwnIsHandedTheLongStep) {
  const Mesh mesh = box();
  const ExplicitSolver solver(mesh, steel());
  RunSetup s = heated(mesh, 2e-5);
  const std::vector<ObservationRow> rows{component(nearest(mesh, {0.02, 0, 0.03}), 2)};
  const auto base = solver.solve(s, rows, cycled(4));
  const auto law = std::make_shared<Noting>(s.liquid);
  s.liquid_law = law;
  const auto same = solver.solve(s, rows, cycled(4));
  EXPECT_EQ(same.subcycles, base.subcycles);
  EXPECT_DOUBLE_EQ(law->least, base.time_step);
  EXPECT_DOUBLE_EQ(law->greatest, base.subcycles * base.time_step);
  for (std::size_t i = 0; i < base.observations.size(); ++i) EXPECT_NEAR(same.observations[i], base.observations[i], 1e-9);
}

namespace {

/// Greatest error of the energy balance over `steps` of the output interval, for initial noise at every node, which excites every mode.
double balance_of_noise(const Mesh& mesh, const ExplicitSolver& solver, double viscosity, double interval, double steps, const SolveOptions& options) {
  RunSetup s = linear_setup(interval * steps, interval);
  s.liquid.viscosity = viscosity;
  RandomStream random(7, 0);
  s.initial_velocity.resize(mesh.nodes.size());
  for (auto& v : s.initial_velocity)
    for (auto& c : v) c = random.uniform(-1e-3, 1e-3);
  SolveOptions o = options;
  o.energy_balance = true;
  const auto out = solver.solve(s, {}, o);
  EXPECT_EQ(out.subcycles, options.subcycles);
  return out.energy_balance_error;
}

/// Mercury and steel in a row, with steel elements of 1.4 mm and mercury elements of 2 mm, free to move along x only.
Mesh column() {
  Mesh m = block({40, 1, 1}, {0, 0, 0}, {0.08, 0.002, 0.002}, [](const Vec3& x) { return x[0] > 0.06 ? Region::steel : Region::mercury; });
  for (auto& x : m.nodes)
    if (x[0] > 0.0601) x[0] = 0.06 + (x[0] - 0.06) * 0.7;
  fix(m, 2 | 4, everywhere());
  split(m, {Vec3{1, 0, 0}});
  return m;
}

}  // namespace

// Modes that resonate with the long step would grow without bound. One layer of mercury in between prevents it; without the layer they grow.
TEST(Subcycles, NoModeGrowsBesideALayerOfFastMercury) {
  const Mesh mesh = box();
  const ExplicitSolver solver(mesh, steel());
  for (const double viscosity : {0.0, 2000.0})
    for (const int m : {2, 4})
      for (const double interval : {2e-6, 1.8e-6}) {  // steps of other lengths meet other modes
        const double balance = balance_of_noise(mesh, solver, viscosity, interval, 1000, cycled(m));
        measured(fmt::format("balance_{}_viscosity_{}_interval_{}", m, viscosity, interval), balance);
        EXPECT_LT(balance, 0.04);
      }
  EXPECT_THROW((void)balance_of_noise(mesh, solver, 0, 2e-6, 2000, cycled(4, 0)), NumericsError);
}

TEST(Subcycles, NoModeOfAColumnGrowsWhateverTheStep) {
  const Mesh mesh = column();
  const ExplicitSolver solver(mesh, steel());
  const auto greatest = [&](int buffer) {
    double balance = 0;
    for (int k = 0; k <= 12; ++k) try {
        balance = std::max(balance, balance_of_noise(mesh, solver, 0, 3.1e-6 + 0.15e-6 * k, 2000, cycled(3, buffer)));
      } catch (const NumericsError&) {
        balance = std::numeric_limits<double>::infinity();
      }
    return balance;
  };
  const double with = greatest(1), without = greatest(0);
  measured("balance_with_a_layer", with);
  measured("balance_without", without);
  EXPECT_LT(with, 0.04);
  EXPECT_GT(without, 1);
}

// The limit of the long step is that of the liquid alone.
TEST(Subcycles, TheLongStepEndsWhereTheLiquidsDoes) {
  const Mesh mesh = column();
  const ExplicitSolver solver(mesh, steel());
  const double limit = 0.002 / mercury_speed;  // of equal elements in a row, h / c
  for (const double factor : {0.98, 1.02}) {
    SolveOptions o = cycled(6);
    o.time_step_safety = factor * 1.001;  // the same for the step of the steel, which divides the long step by more than necessary
    const auto run = [&] { return balance_of_noise(mesh, solver, 0, factor * limit, 4000, o); };
    if (factor < 1) {
      EXPECT_LT(run(), 0.2);
    } else {
      EXPECT_THROW((void)run(), NumericsError);
    }
  }
}

// The balance oscillates with the impulses but does not drift: four times the time changes little.
TEST(Subcycles, EnergySwingsButDoesNotDrift) {
  Mesh mesh = box();
  mesh.rear.clear();
  const ExplicitSolver solver(mesh, steel());
  std::vector<double> errors;
  for (const int m : {1, 2, 4})
    for (const double end : {2e-4, 8e-4}) {
      RunSetup s = heated(mesh, end);
      s.liquid.viscosity = 0;
      s.liquid.tensile_cutoff = std::numeric_limits<double>::infinity();
      SolveOptions o = cycled(m);
      o.energy_balance = true;
      errors.push_back(solver.solve(s, {}, o).energy_balance_error);
      measured(fmt::format("balance_{}_until_{}", m, end), errors.back());
    }
  EXPECT_LT(errors[1], 1e-6);
  EXPECT_LT(errors[3], 2e-3);
  EXPECT_LT(errors[5], 1e-2);
  EXPECT_LT(errors[3], 2 * errors[2]);
  EXPECT_LT(errors[5], 2 * errors[4]);
}
