// Sub-cycling: which elements are slow, that nothing is lost between them and the others, and where it stops being stable.
#include "forward/solver/subcycles.hpp"

#include "base/random.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/solver/layout.hpp"
#include "forward/solver/load.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// A plane-strain or solid box whose walls are four times thinner than the mercury's elements are long.
Mesh box(bool plane_strain = true) {
  GeometryOptions g;
  g.kind = "box", g.length = 0.05, g.width = 0.04, g.height = 0.03, g.wall = 0.003, g.plane_strain = plane_strain, g.half = !plane_strain;
  g.element_size = plane_strain ? 0.002 : 0.004;
  g.rear = "non_reflecting";
  return make_mesh(g);
}

RunSetup heated(const Mesh& mesh, double end) {
  RunSetup s = linear_setup(end, 2e-6);
  ProfileOptions profile;
  profile.center = {0, 0.015}, profile.widths = {0.03, 0.01};
  for (const double v : heating_shape(mesh, profile).element) s.p0.push_back(25e6 * v);
  s.p0_at = [profile](const Vec3& x) { return 25e6 * profile.shape(x, true); };
  s.pulse_length = 0.7e-6;
  s.liquid.viscosity = 2000, s.liquid.tensile_cutoff = 1.5e5;
  return s;
}

std::vector<Vec3> noise(const Mesh& mesh, double size) {
  RandomStream random(7, 0);
  std::vector<Vec3> v(mesh.nodes.size());
  for (auto& x : v)
    for (auto& c : x) c = random.uniform(-size, size);
  return v;
}

SolveOptions cycled(int subcycles, int buffer = default_subcycle_buffer) {
  SolveOptions o;
  o.subcycles = subcycles, o.subcycle_buffer = buffer;
  return o;
}

}  // namespace

TEST(Subcycles, SlowElementsKeepTheirDistance) {
  const Mesh mesh = box(false);
  std::size_t before = mesh.elements.size() + 1;
  for (const int buffer : {0, 1, 2}) {
    const auto slow = slow_elements(mesh, buffer);
    std::vector<int> layer(mesh.nodes.size(), 99);  // layers of mercury between a node and the steel, the slip pairs and the rear
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
  // Fast rows of the outbox come first, whoever wrote them.
  for (std::size_t k = 0; k < layout.outbox_fast_end.size(); ++k)
    for (std::size_t i = layout.outbox_begin[k]; i < layout.outbox_begin[k + 1]; ++i, ++rows)
      EXPECT_EQ(layout.outbox_rows[i] < layout.blocks[layout.first_slow_block].outbox, i < layout.outbox_fast_end[k]);
  EXPECT_EQ(rows, layout.outbox_size);
}

TEST(Subcycles, TheCheapestDivisionThatTheLiquidBears) {
  Layout layout;
  layout.blocks.resize(2);
  layout.blocks[0].elements.resize(100), layout.blocks[1].elements.resize(300);
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
  EXPECT_EQ(at_most(6, 1, 4), std::pair(6, 3));     // not 8 steps for the sake of 4
  EXPECT_EQ(at_most(1, 1, 4), std::pair(1, 1));
  layout.first_slow_block = 2;                      // nothing is slow
  EXPECT_EQ(at_most(12, 3, 4), std::pair(12, 1));
}

// Every impulse has its counterpart: a free body that pulls at itself keeps its momentum, to rounding.
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
  // A liquid faster than the steel leaves nothing to gain.
  RunSetup fast = s;
  fast.liquid.bulk_modulus *= 100;
  EXPECT_EQ(solver.solve(fast, rows, cycled(4)).subcycles, 1);
}

// Noise in every node, which holds every mode, for 40 000 steps of the steel, without viscosity: modes that resonate with the long step would grow.
TEST(Subcycles, NoModeGrows) {
  const Mesh mesh = box();
  const ExplicitSolver solver(mesh, steel());
  for (const double viscosity : {0.0, 2000.0})
    for (const int m : {2, 3, 4, 6, 8}) {
      RunSetup s = linear_setup(8e-3, 2e-6);
      s.liquid.viscosity = viscosity;
      s.initial_velocity = noise(mesh, 1e-3);
      SolveOptions o = cycled(m);
      o.booking = true;
      const auto out = solver.solve(s, {}, o);
      measured(fmt::format("balance_{}_of_{}_viscosity_{}", out.subcycles, m, viscosity), out.energy_balance_error);
    }
}
