#include "forward/mechanism/thermal_stress.hpp"

#include "forward/target/built_in_model.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/unit/forward/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;

// Steel is heated at once by delta_t exp(-x / decay), held sideways and free at x = 0. The resulting stress leaves as two waves, and the free end
// moves with u = -(3 lambda + 2 mu)/(lambda + 2 mu) a delta_t decay (1 - exp(-c t / decay)).
TEST(ThermalStress, AHeatedHalfSpacePushesItsFreeSurfaceOut) {
  const double length = 0.3, decay = 0.03, delta_t = 1.5, end = 3e-5, lambda = steel().lambda, mu = steel().mu;
  const Mesh mesh = column(600, length, Region::steel);
  const auto entry = thermal_stress();
  const auto end_of = [&](double used) {
    RunSetup s = linear_setup(end, end / 10);
    entry.fields(values_of(entry, {{"delta_t", delta_t}, {"decay", used}}), mesh, LoadOptions{}, s);
    return ExplicitSolver(mesh, steel()).solve(s, std::vector<ObservationRow>{component(nearest(mesh, {0, 0, 0}), 0)}, {});
  };
  const auto exact = [&](double t) {
    return -(3 * lambda + 2 * mu) / (lambda + 2 * mu) * steel_expansion * delta_t * decay * (1 - std::exp(-steel_speed() * t / decay));
  };
  const auto out = end_of(decay), wrong = end_of(1.2 * decay);
  measured("surface_over_exact", out.observations[10] / exact(end));
  for (std::size_t i = 1; i < out.times.size(); ++i) EXPECT_NEAR(out.observations[i], exact(out.times[i]), 0.005 * std::abs(exact(end)));
  EXPECT_GT(std::abs(wrong.observations[10] / exact(end) - 1), 0.05);  // control
}

namespace {

ForwardCase heated(const std::string& more = "", const std::string& load = "peak_pressure = 25e6") {
  return small_case("[mechanism.thermal_stress]\nenabled = true\ndelta_t = 1.2\ndecay = 0.04\n" + more, load);
}

RunSetup setup_of(const ForwardCase& c, std::size_t condition = 0) {
  const BuiltInModel model(c, {.pulses = 1});
  return model.setup(model.forward_case(), model.mesh(), condition, {1.0});
}

}  // namespace

// The thermal strain is a delta_t S(z) exp(-x / decay) in the steel and 0 in the mercury, S that of the beam as another mechanism moves it.
TEST(ThermalStress, TheHeatIsThatOfTheBeam) {
  const BuiltInModel model(heated("[mechanism.beam_profile]\nenabled = true\noffset_z = 2e-3\nwidth_ratio_z = 1.1\nenergy_ratio = 1.02\n"), {.pulses = 1});
  const Mesh& mesh = model.mesh();
  const RunSetup s = model.setup(model.forward_case(), mesh, 0, {1.0});
  ASSERT_EQ(s.thermal_strain.size(), mesh.elements.size());
  int steel_elements = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    Vec3 x{};
    for (const NodeId n : mesh.elements[e])
      for (std::size_t c = 0; c < 3; ++c) x[c] += mesh.nodes[std::size_t(n)][c] / 8;
    const double expected = 16e-6 * 1.02 * 1.2 * std::exp(-0.5 * std::pow((x[2] - 0.017) / 0.011, 2)) * std::exp(-x[0] / 0.04);
    EXPECT_NEAR(s.thermal_strain[e], mesh.region[e] == Region::steel ? expected : 0, 1e-12 * 16e-6);
    steel_elements += mesh.region[e] == Region::steel;
  }
  EXPECT_GT(steel_elements, 50);
}

// A condition of half the strength heats the steel half as much, whether pressure or energy gives the strength.
TEST(ThermalStress, FollowsTheStrengthOfTheCondition) {
  const auto one = setup_of(heated()).thermal_strain;
  const auto c = heated("[[condition]]\nname = \"half\"\npeak_pressure = 12.5e6\n[[condition]]\nname = \"full\"\npeak_pressure = 25e6\n");
  const auto half = setup_of(c, 0).thermal_strain, full = setup_of(c, 1).thermal_strain;
  const auto by_energy = setup_of(heated("[[condition]]\nname = \"double\"\nenergy = 20.0\n", "energy = 10.0")).thermal_strain;
  for (std::size_t e = 0; e < one.size(); ++e) {
    EXPECT_NEAR(half[e], 0.5 * one[e], 1e-20);
    EXPECT_NEAR(full[e], one[e], 1e-20);
    EXPECT_NEAR(by_energy[e], 2 * one[e], 1e-20);
  }
}
