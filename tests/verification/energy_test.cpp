// Energy: 1/2 v- M v+ + stored energy is kept (physics.md section 4).
#include "forward/mesh/make_mesh.hpp"
#include "forward/solver/load.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// A closed plane-strain box of 60 x 30 mm with 3 mm walls, heated by 25 MPa.
struct HeatedBox {
  explicit HeatedBox(const std::string& rear = "wall") {
    GeometryOptions g;
    g.kind = "box", g.length = 0.06, g.width = 0.05, g.height = 0.03, g.wall = 0.003, g.plane_strain = true, g.rear = rear;
    g.element_size = 0.0015;
    mesh = make_mesh(g);
    profile.center = {0, 0.015}, profile.widths = {1, 0.01};
    setup = linear_setup(2e-4, 2e-4);
    const auto heat = heating_shape(mesh, profile);
    for (const double v : heat.element) setup.p0.push_back(25e6 * v);
    setup.p0_at = [this](const Vec3& x) { return 25e6 * profile.shape(x, true); };
    setup.pulse_length = 0.7e-6;
  }
  [[nodiscard]] SolveSummary run(double safety = 0.95) const {
    SolveOptions o;
    o.booking = true, o.time_step_safety = safety;
    return ExplicitSolver(mesh, steel()).solve(setup, {}, o);
  }
  Mesh mesh;
  ProfileOptions profile;
  RunSetup setup;
};

}  // namespace

TEST(Energy, IsKeptInTheLinearCase) {
  const HeatedBox box;
  const auto s = box.run();
  measured("linear_balance", s.energy_balance_error);
  EXPECT_LT(s.energy_balance_error, 1e-6);
  EXPECT_GT(s.steps, 400);
  EXPECT_EQ(s.dissipated, 0);
  EXPECT_EQ(s.radiated, 0);
}

// Heat that comes at once stores p0^2 / (2 K) per volume.
TEST(Energy, SuddenHeatIsTheEnergyOfItsPressure) {
  HeatedBox box;
  box.setup.pulse_length = 0;
  double expected = 0;
  for (std::size_t e = 0; e < box.mesh.elements.size(); ++e)
    expected += box.setup.p0[e] * box.setup.p0[e] / (2 * box.setup.liquid.bulk_modulus) * hexahedron::volume(hexahedron::corners(box.mesh, e));
  EXPECT_NEAR(box.run().energy_in, expected, 1e-9 * expected);
  // Control: a slow pulse puts in another amount.
  box.setup.pulse_length = 20e-6;
  EXPECT_GT(std::abs(box.run().energy_in / expected - 1), 0.02);
}

// What viscosity takes and what leaves through the rear is booked; without either entry the balance would fail.
TEST(Energy, DissipationAndRadiationAreBooked) {
  HeatedBox box("non_reflecting");
  box.setup.liquid.viscosity = 2000;
  box.setup.hourglass = 0;
  const auto s = box.run();
  measured("balance_with_viscosity_and_rear", s.energy_balance_error);
  measured("dissipated_share", s.dissipated / s.energy_in);
  measured("radiated_share", s.radiated / s.energy_in);
  EXPECT_LT(s.energy_balance_error, 1e-6);
  EXPECT_GT(s.dissipated, 1e-2 * s.energy_in);
  EXPECT_GT(std::abs(s.radiated), 1e-2 * s.energy_in);
  box.setup.hourglass = 0.005;  // whose springs are damped too
  const auto with_hourglass = box.run();
  measured("balance_with_hourglass_control", with_hourglass.energy_balance_error);
  EXPECT_LT(with_hourglass.energy_balance_error, 1e-6);
}

TEST(Energy, IsKeptWithTheCutoffBetterAsTheStepFalls) {
  HeatedBox box;
  box.setup.liquid.tensile_cutoff = 1.5e5;
  double before = 1;
  for (const double safety : {0.9, 0.45, 0.225}) {
    const double error = box.run(safety).energy_balance_error;
    measured("cutoff_balance_at_" + std::to_string(safety).substr(0, 5), error);
    EXPECT_LT(error, 1e-3);
    EXPECT_LT(error, 0.75 * before);
    before = error;
  }
  EXPECT_GT(before, 1e-9);  // the cutoff is reached
}
