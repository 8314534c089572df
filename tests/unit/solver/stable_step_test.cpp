#include <Eigen/Dense>
#include <limits>

#include "base/random.hpp"
#include "forward/solver/stable_step.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

/// 2/omega of the greatest frequency of the whole mesh, from the stiffness that the solver shows.
double true_limit(const Mesh& mesh, const RunSetup& setup) {
  const ExplicitSolver solver(mesh, setup.steel);
  const Eigen::MatrixXd k = stiffness(solver, setup);
  const auto m = masses(mesh, setup);
  Eigen::VectorXd scale(k.rows());
  for (Eigen::Index i = 0; i < scale.size(); ++i) scale[i] = 1 / std::sqrt(m[i / 3]);
  const Eigen::MatrixXd a = scale.asDiagonal() * (0.5 * (k + k.transpose())) * scale.asDiagonal();
  return 2 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff());
}

/// A column that can only move along x: there the element's bound is the limit of the mesh.
Mesh column(int n) {
  Mesh m = block({n, 1, 1}, {0, 0, 0}, {0.001 * n, 0.001, 0.001}, Region::mercury);
  fix(m, 2 | 4, everywhere());
  return m;
}

}  // namespace

// u+ = u + dt v+, v+ = v - dt omega^2 (u + beta v): both eigenvalues stay within the unit circle up to the limit and no farther.
TEST(StableTimeStep, IsTheLimitOfADampedOscillator) {
  for (const double beta : {0.0, 1e-8, 1e-6, 1e-4})
    for (const double factor : {0.999, 1.001}) {
      const double w2 = 4e12, dt = factor * stable_time_step(w2, beta);
      Eigen::Matrix2d step;
      step << 1 - dt * dt * w2, dt * (1 - dt * w2 * beta), -dt * w2, 1 - dt * w2 * beta;
      const double radius = step.eigenvalues().cwiseAbs().maxCoeff();
      EXPECT_EQ(radius < 1 + 1e-9, factor < 1) << "beta " << beta << ", radius " << radius;
    }
}

TEST(StableTimeStep, IsNeverAboveTheLimitOfTheWholeMesh) {
  for (const int kind : {0, 1, 2})
    for (const double distortion : {0.0, 0.15}) {
      Mesh mesh = block({3, 3, 3}, {0, 0, 0}, {0.003, 0.0045, 0.006}, [&](const Vec3& x) { return kind == 0 || (kind == 2 && x[2] < 0.002) ? Region::steel : Region::mercury; });
      RandomStream random(5, 0);
      for (auto& x : mesh.nodes)
        for (auto& c : x) c += distortion * random.uniform(-0.001, 0.001);
      const RunSetup s = linear_setup(0, 0);
      const double estimate = ExplicitSolver(mesh, steel()).stable_step(s), truth = true_limit(mesh, s);
      measured("estimate_over_limit_" + std::to_string(kind) + (distortion > 0 ? "_distorted" : ""), estimate / truth);
      EXPECT_LE(estimate, truth * (1 + 1e-9));
      EXPECT_GT(estimate, 0.5 * truth);
    }
}

TEST(StableTimeStep, SharpWhereElementsAreAlike) {
  const Mesh mesh = column(20);
  const ExplicitSolver solver(mesh, steel());
  for (const double viscosity : {0.0, 2000.0}) {
    RunSetup s = linear_setup(0, 0);
    s.liquid.viscosity = viscosity;
    const double limit = solver.stable_step(s);
    RandomStream random(9, 0);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) s.initial_velocity.push_back({random.uniform(-1e-3, 1e-3), 0, 0});
    for (const double factor : {0.98, 1.02}) {
      s.output_interval = factor * limit, s.end = 3000 * s.output_interval;
      SolveOptions o;
      o.time_step_safety = factor * (1 + 1e-9);
      const std::vector<ObservationRow> rows{component(nearest(mesh, {0.02, 0, 0}), 0)};
      if (factor < 1) {
        EXPECT_NO_THROW((void)solver.solve(s, rows, o)) << viscosity;
      } else {
        EXPECT_THROW((void)solver.solve(s, rows, o), NumericsError) << viscosity;
      }
    }
  }
}

TEST(StableTimeStep, ARunThatLeavesAllBoundsNamesStepNodeAndElement) {
  const Mesh mesh = column(20);
  const ExplicitSolver solver(mesh, steel());
  RunSetup s = linear_setup(0, 0);
  s.initial_velocity.assign(mesh.nodes.size(), {});
  s.initial_velocity[5] = {1, 0, 0};
  s.output_interval = 1.2 * solver.stable_step(s), s.end = 500 * s.output_interval;
  SolveOptions o;
  o.time_step_safety = 1.3;
  try {
    (void)solver.solve(s, {}, o);
    FAIL();
  } catch (const NumericsError& e) {
    EXPECT_THAT(e.what(), HasSubstr("leave all bounds at step"));
    EXPECT_THAT(e.what(), HasSubstr("of mercury element"));
    EXPECT_THAT(e.what(), HasSubstr("density 13500"));
  }
}

TEST(StableTimeStep, ALiquidWithoutStiffnessIsANumericsError) {
  const Mesh mesh = column(2);
  const ExplicitSolver solver(mesh, steel());
  RunSetup s = linear_setup(1e-5, 1e-6);
  s.liquid.bulk_modulus = 0;
  EXPECT_THROW((void)solver.stable_step(s), NumericsError);
  EXPECT_THROW((void)solver.solve(s, {}, {}), NumericsError);
}

TEST(ExplicitSolver, RefusesAnInvertedElement) {
  Mesh mesh = column(2);
  for (auto& x : mesh.nodes) x[2] = -x[2];
  EXPECT_THROW((void)ExplicitSolver(mesh, steel()), InputError);
}

TEST(ExplicitSolver, TheStepDividesTheOutputInterval) {
  const Mesh mesh = column(10);
  const ExplicitSolver solver(mesh, steel());
  RunSetup s = linear_setup(1e-5, 1e-6);
  const auto out = solver.solve(s, {}, {});
  EXPECT_EQ(out.times.size(), 11u);
  EXPECT_DOUBLE_EQ(out.times.back(), 1e-5);
  const double ratio = 1e-6 / out.time_step;
  EXPECT_NEAR(ratio, std::round(ratio), 1e-9);
  EXPECT_LE(out.time_step, 0.95 * solver.stable_step(s));
  EXPECT_GT(out.time_step, 0.3 * solver.stable_step(s));
}

TEST(ExplicitSolver, StopsWhenAsked) {
  const Mesh mesh = column(10);
  const std::atomic<bool> stop{true};
  SolveOptions o;
  o.stop = &stop;
  EXPECT_THROW((void)ExplicitSolver(mesh, steel()).solve(linear_setup(1e-5, 1e-6), {}, o), Interrupted);
}
