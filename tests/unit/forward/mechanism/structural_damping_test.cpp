#include "forward/mechanism/structural_damping.hpp"

#include <complex>

#include "forward/mesh/make_mesh.hpp"
#include "forward/target/offered_groups.hpp"
#include "forward/solver/load.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/unit/forward/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;

// A mode decays at zeta w, zeta = (mass / w + stiffness w) / 2.
TEST(StructuralDamping, EveryModeOfABarHasRayleighsRatio) {
  const double length = 0.1;
  const Mesh mesh = column(160, length, Region::steel);
  const auto entry = structural_damping();
  struct Row {
    double mass, stiffness;
  };
  for (const int n : {1, 4})
    for (const auto& [a, b] : {Row{2000, 0}, Row{0, 1e-7}, Row{2000, 1e-7}}) {
      const double k = n * M_PI / length, w = steel_speed() * k, theory = 0.5 * (a + b * w * w);
      RunSetup s = linear_setup(0, 0);
      entry.setup(values_of(entry, {{"mass", a}, {"stiffness", b}}), s);
      const auto got = decay(mesh, s, k, w, n == 1 ? 3 : 4);
      const std::string name = std::to_string(n) + "_" + std::to_string(int(a)) + "_" + std::to_string(int(1e9 * b));
      measured("rate_over_theory_" + name, got.rate / theory);
      measured("energy_balance_" + name, got.energy_error);
      EXPECT_NEAR(got.rate, theory, 0.02 * theory) << name;
      EXPECT_LT(got.energy_error, 1e-3) << name;
    }
}

// A mode of a bar with branches satisfies s^2 + w^2 (1 + sum m s t / (1 + s t)) = 0, which Newton's method solves. Its damping ratio is `loss` for a decade
// about `frequency`.
TEST(StructuralDamping, EveryModeOfABarLosesWhatItsBranchesTake) {
  using Complex = std::complex<double>;
  const double length = 0.1, loss = 0.02;
  const Mesh mesh = column(160, length, Region::steel);
  const auto entry = structural_damping();
  for (const int n : {1, 4}) {
    const double k = n * M_PI / length, w = steel_speed() * k;
    for (const double times : {1.0, 3.0, 10.0}) {
      RunSetup s = linear_setup(0, 0);
      entry.setup(values_of(entry, {{"loss", loss}, {"frequency", times * w / (2 * M_PI)}}), s);
      ASSERT_EQ(s.steel_branches.size(), 3u);
      Complex root(0, w);
      const auto residual = [&](Complex z) {
        Complex sum = 1;
        for (const auto& b : s.steel_branches) sum += b.share * z * b.time / (1.0 + z * b.time);
        return z * z + w * w * sum;
      };
      for (int i = 0; i < 20; ++i) root -= residual(root) / ((residual(root + 1.0) - residual(root - 1.0)) / 2.0);
      const auto got = decay(mesh, s, k, root.imag(), 4, 4);  // the initial transient of the branches has decayed
      const std::string name = std::to_string(n) + "_" + std::to_string(int(10 * times));
      measured("rate_over_theory_" + name, got.rate / -root.real());
      measured("ratio_over_loss_" + name, -root.real() / w / loss);
      measured("energy_balance_" + name, got.energy_error);
      EXPECT_NEAR(got.rate, -root.real(), 0.005 * -root.real()) << name;
      EXPECT_LT(got.energy_error, 1e-4 * n * n) << name;  // the dissipation is counted to second order in w dt
      if (times == 1) {
        EXPECT_NEAR(-root.real() / w, loss, 0.1 * loss);  // the modulus at w is a little above the slow one
      } else if (times == 3) {
        EXPECT_NEAR(-root.real() / w, loss, 0.2 * loss);
      }
    }
  }
}

// In a target only the steel is damped, and the dissipation is counted.
TEST(StructuralDamping, ABoxLosesEnergyThatIsCounted) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.06;
  g.width = 0.05;
  g.height = 0.03;
  g.wall = 0.003;
  g.plane_strain = true;
  g.rear = "wall";
  g.element_size = 0.0015;
  const Mesh mesh = make_mesh(g);
  ProfileOptions profile;
  profile.center = {0, 0.015};
  profile.widths = {1, 0.01};
  RunSetup s = linear_setup(1e-4, 1e-4);
  for (const double v : heating_shape(mesh, profile).element) s.p0.push_back(25e6 * v);
  s.pulse_length = 0.7e-6;
  SolveOptions o;
  o.energy_balance = true;
  const ExplicitSolver solver(mesh, steel());
  EXPECT_EQ(solver.solve(s, {}, o).dissipated, 0);
  const auto entry = structural_damping();
  for (const auto& [key, value] : {std::pair<const char*, double>{"mass", 2e3}, {"stiffness", 1e-7}, {"loss", 0.02}}) {
    RunSetup damped = s;
    entry.setup(values_of(entry, {{key, value}}), damped);
    const auto out = solver.solve(damped, {}, o);
    measured(std::string(key) + "_share_lost", out.dissipated / out.energy_in);
    measured(std::string(key) + "_balance", out.energy_balance_error);
    EXPECT_GT(out.dissipated, 1e-3 * out.energy_in);
    EXPECT_LT(out.energy_balance_error, 1e-3);
    for (const int threads : {2, 3}) {  // the energy balance has the same bits too
      SolveOptions several = o;
      several.threads = threads;
      const auto again = solver.solve(damped, {}, several);
      EXPECT_EQ(again.dissipated, out.dissipated);
      EXPECT_EQ(again.energy_balance_error, out.energy_balance_error);
    }
  }
}

// The case keeps its own mass and stiffness damping. About a high frequency `loss` has the effect of a stiffness term without its cost in steps.
TEST(StructuralDamping, ADiagnosisScreensTheLossAboutAFrequency) {
  for (const auto& g : offered_groups(small_case(), make_mesh(small_case().geometry)))
    if (g.name == "structural_damping") {
      ASSERT_EQ(g.added.size(), 1u);
      EXPECT_EQ(g.added[0].parameter.name, "structural_damping.loss");
      ASSERT_EQ(g.shapes.size(), 1u);
      EXPECT_EQ(g.shapes[0].parameter.name, "structural_damping.frequency");
      return;
    }
  FAIL() << "not offered";
}
