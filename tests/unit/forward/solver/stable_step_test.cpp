#include <algorithm>
#include <complex>
#include <limits>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "forward/solver/stable_step.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

/// Greatest stable step of the whole mesh, from the stiffness that the solver applies: central differences with damping C that lags
/// half a step are stable while 4 M - 2 dt C - dt^2 K is positive definite. C is beta K, beta of the liquid or of the steel, and the
/// two stiffnesses come from runs in which the other material has next to none.
double true_limit(const Mesh& mesh, const RunSetup& setup) {
  RunSetup plain = setup;
  plain.liquid.viscosity = 0;
  plain.steel_stiffness_damping = 0;
  const auto m = masses(mesh, plain);
  const Eigen::Index n = 3 * m.size();
  const Eigen::MatrixXd k = stiffness(ExplicitSolver(mesh, setup.steel), plain);
  Eigen::MatrixXd damping = Eigen::MatrixXd::Zero(n, n);
  if (setup.liquid.viscosity > 0 || setup.steel_stiffness_damping > 0) {
    RunSetup soft = plain;
    soft.liquid.bulk_modulus *= 0.5;
    const Eigen::MatrixXd liquid = 2 * (k - stiffness(ExplicitSolver(mesh, setup.steel), soft));
    damping = setup.liquid.viscosity / setup.liquid.bulk_modulus * liquid + setup.steel_stiffness_damping * (k - liquid);
  }
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = 1 / std::sqrt(m[i / 3]);
  // The pairs of a slip interface move together along their normals: the solver applies P K, and P K P determines the step.
  Eigen::MatrixXd together = Eigen::MatrixXd::Identity(n, n);
  for (const auto& pair : mesh.slip)
    for (int i = 0; i < pair.count; ++i) {
      Eigen::VectorXd apart = Eigen::VectorXd::Zero(n);
      for (Eigen::Index c = 0; c < 3; ++c) {
        const double x = pair.normals[std::size_t(i)][std::size_t(c)];
        apart[3 * pair.steel + c] = x * scale[3 * pair.steel];
        apart[3 * pair.mercury + c] = -x * scale[3 * pair.mercury];
      }
      together -= apart * apart.transpose() / apart.squaredNorm();
    }
  const auto scaled = [&](const Eigen::MatrixXd& a) -> Eigen::MatrixXd {
    const Eigen::MatrixXd b = scale.asDiagonal() * a * scale.asDiagonal() * together;
    return 0.5 * (b + b.transpose());
  };
  const Eigen::MatrixXd ks = scaled(k), cs = scaled(damping);
  double low = 0, high = 1e-3;
  for (int i = 0; i < 60; ++i) {
    const double dt = 0.5 * (low + high);
    const Eigen::MatrixXd a = 2 * dt * cs + dt * dt * ks;
    (symmetric_eigenvalues(a).maxCoeff() < 4 ? low : high) = dt;
  }
  return low;
}

/// A column that moves along x only, in which the bound of an element is the limit of the mesh.
Mesh column(int n) {
  Mesh m = block({n, 1, 1}, {0, 0, 0}, {0.001 * n, 0.001, 0.001}, Region::mercury);
  fix(m, 2 | 4, everywhere());
  return m;
}

}  // namespace

// u+ = u + dt v+, v+ = v - dt omega^2 (u + beta v): both eigenvalues remain within the unit circle up to the limit and no farther.
TEST(StableTimeStep, IsTheLimitOfADampedOscillator) {
  for (const double beta : {0.0, 1e-8, 1e-6, 1e-4})
    for (const double factor : {0.999, 1.001}) {
      const double w2 = 4e12, dt = factor * stable_time_step(w2, beta);
      // One step is the matrix (1 - dt^2 w2, dt (1 - dt w2 beta); -dt w2, 1 - dt w2 beta), whose determinant is 1 - dt w2 beta.
      const double half_trace = 1 - 0.5 * dt * w2 * (dt + beta), determinant = 1 - dt * w2 * beta;
      const std::complex<double> root = std::sqrt(std::complex<double>(half_trace * half_trace - determinant));
      const double radius = std::max(std::abs(half_trace + root), std::abs(half_trace - root));
      EXPECT_EQ(radius < 1 + 1e-9, factor < 1) << "beta " << beta << ", radius " << radius;
    }
}

// The step lies between the bound of the worst element and the limit of the mesh, close to the limit.
// v+ = f v - dt omega^2 u, f = exp(-a dt): damping of the motion after each step shortens the stable step, too.
TEST(StableTimeStep, IsStableWithDampingOfTheMotion) {
  const double w2 = 4e12, without = stable_time_step(w2, 0);
  const auto radius = [&](double dt, double a) {
    const double f = std::exp(-a * dt);
    Eigen::Matrix2d step;
    step << 1 - dt * dt * w2, dt * f, -dt * w2, f;  // of u and of v before the factor
    // Roots of r^2 - trace r + det.
    const double half = 0.5 * step.trace(), det = step.determinant(), root = half * half - det;
    return root < 0 ? std::sqrt(det) : std::abs(half) + std::sqrt(root);
  };
  EXPECT_EQ(mass_damped_time_step(without, 0), without);
  for (const double a : {1e3, 1e5, 1e6, 1e7}) {
    EXPECT_LE(radius(mass_damped_time_step(without, a), a), 1 + 1e-9) << a;
    EXPECT_GT(radius(without, a), 1 + 1e-6) << a;  // control
    EXPECT_GT(mass_damped_time_step(without, a), 0.7 * without) << a;
  }
}

TEST(StableTimeStep, LiesBetweenTheElementsBoundAndTheLimitOfTheMesh) {
  struct Kind {
    std::string name;
    int material;  ///< 0 steel, 1 mercury, 2 both
    double viscosity = 0, steel_damping = 0;
    bool slip = false, symmetric = false;
  };
  for (const Kind& kind : {Kind{"steel", 0},
                           {"mercury", 1},
                           {"mixed", 2},
                           {"viscous", 1, 2000},
                           {"viscous_mixed", 2, 2000},
                           {"damped_steel", 0, 0, 2e-7},
                           {"damped_mixed", 2, 2000, 2e-7},
                           {"slip", 2, 0, 0, true},
                           {"symmetric", 2, 0, 0, false, true},
                           {"all", 2, 2000, 2e-7, true, true}})
    for (const double distortion : {0.0, 0.15}) {
      Mesh mesh = block({3, 2, 3}, {0, 0, 0}, {0.003, 0.003, 0.006},
                        [&](const Vec3& x) { return kind.material == 0 || (kind.material == 2 && x[2] < 0.002) ? Region::steel : Region::mercury; });
      RandomStream random(5, 0);
      for (auto& x : mesh.nodes)
        for (auto& c : x) c += distortion * random.uniform(-0.001, 0.001);
      if (kind.symmetric)
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
          if (n % 4 == 0) mesh.fixed[n] |= 1;      // x = 0
          if (n / 4 % 3 == 0) mesh.fixed[n] |= 2;  // y = 0
        }
      if (kind.slip) split(mesh, {Vec3{0, 0, 1}});
      RunSetup s = linear_setup(0, 0);
      s.liquid.viscosity = kind.viscosity;
      s.steel_stiffness_damping = kind.steel_damping;
      const ExplicitSolver solver(mesh, steel());
      const double bound = solver.element_step(s), estimate = solver.stable_step(s), truth = true_limit(mesh, s);
      const std::string name = kind.name + (distortion > 0 ? "_distorted" : "");
      measured("bound_over_limit_" + name, bound / truth);
      measured("estimate_over_limit_" + name, estimate / truth);
      EXPECT_LE(bound, truth * (1 + 1e-9)) << name;
      EXPECT_GE(estimate, bound) << name;
      EXPECT_LE(estimate, truth * (1 + 1e-9)) << name;
      EXPECT_GT(estimate, (kind.steel_damping > 0 ? 0.7 : 0.9) * truth) << name;  // damping is taken at the shorter step
      s.energies = {1.0, 1.1, 0.9};
      EXPECT_LE(solver.stable_step(s), truth * (1 + 1e-9)) << name;
      EXPECT_LE(solver.stable_step(s, {.precision = "single"}), truth * (1 + 1e-3)) << name;
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
      s.output_interval = factor * limit;
      s.end = 3000 * s.output_interval;
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

// A branch adds the stiffness of its spring, however slow it is, and no more.
TEST(StableTimeStep, OfSteelWithRelaxingBranchesIsThatOfTheStifferSteel) {
  const Mesh mesh = block({20, 1, 1}, {0, 0, 0}, {0.02, 0.001, 0.001}, [](const Vec3&) { return Region::steel; });
  const ExplicitSolver solver(mesh, steel());
  for (const double time : {1e-8, 1e-6, 1e-3}) {
    RunSetup s = linear_setup(0, 0);
    const double base = solver.stable_step(s);
    s.steel_branches = {{0.3, time}, {0.14, time}};
    const double limit = solver.stable_step(s);
    EXPECT_NEAR(limit, base / 1.2, 1e-9 * base);
    RandomStream random(9, 0);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) s.initial_velocity.push_back({random.uniform(-1e-3, 1e-3), 0, 0});
    s.output_interval = 0.999 * limit;
    s.end = 3000 * s.output_interval;
    SolveOptions o;
    o.time_step_safety = 1;
    EXPECT_NO_THROW((void)solver.solve(s, {}, o)) << time;
    if (time < 1e-3) continue;
    s.output_interval = 1.04 * limit;
    s.end = 3000 * s.output_interval;
    o.time_step_safety = 1.05;
    EXPECT_THROW((void)solver.solve(s, {}, o), NumericsError);
  }
}

TEST(StableTimeStep, ARunThatLeavesAllBoundsNamesStepNodeAndElement) {
  const Mesh mesh = column(20);
  const ExplicitSolver solver(mesh, steel());
  RunSetup s = linear_setup(0, 0);
  s.initial_velocity.assign(mesh.nodes.size(), {});
  s.initial_velocity[5] = {1, 0, 0};
  s.output_interval = 1.2 * solver.stable_step(s);
  s.end = 500 * s.output_interval;
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

namespace {

/// A liquid that reports its stiffness.
class OfStiffness : public LiquidLaw {
 public:
  explicit OfStiffness(double stiffness) : stiffness_(stiffness) {}
  [[nodiscard]] double greatest_stiffness() const override { return stiffness_; }
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) p.pressure[i] = p.heating[i] - stiffness_ * p.strain[i];
  }

 private:
  double stiffness_;
};

}  // namespace

// Liquid that closes counts with b rho c h of each element: as that viscosity where all are alike, by the small elements' own size where they are not.
TEST(StableTimeStep, CountsTheViscosityOfClosingElementByElement) {
  const auto column_of = [](double least) {
    Mesh m = block({6, 2, 2}, {0, 0, 0}, {0.006, 0.002, 0.002}, Region::mercury);
    for (auto& x : m.nodes)
      if (x[0] > 0.0005 && x[0] < 0.0015) x[0] = least;  // the first layer is so thin
    return m;
  };
  const auto step = [](const Mesh& m, double closing, double viscosity) {
    RunSetup s = linear_setup(0, 0);
    s.liquid.tensile_cutoff = 1e5;
    s.collapse_viscosity = closing;
    s.liquid.viscosity = viscosity;
    s.hourglass = 0;  // one of them damps the springs, the other does not
    return ExplicitSolver(m, steel()).stable_step(s);
  };
  const double impedance = mercury_density * mercury_speed;
  const Mesh even = column_of(0.001), uneven = column_of(0.0003);
  EXPECT_NEAR(step(even, 0.5, 0) / step(even, 0, 0.5 * impedance * 0.001), 1, 1e-6);
  EXPECT_NEAR(step(even, 0.5, 2000) / step(even, 0, 2000 + 0.5 * impedance * 0.001), 1, 1e-6);
  EXPECT_LT(step(even, 0.5, 0), 0.75 * step(even, 0, 0));
  const double own = step(uneven, 0.5, 0);
  EXPECT_GT(own, 1.5 * step(uneven, 0, 0.5 * impedance * 0.001));
  EXPECT_NEAR(own / step(uneven, 0, 0.5 * impedance * 0.0003), 1, 0.1);
  RunSetup s = linear_setup(2e-5, 1e-6);  // bounded: noise that opens and closes at that step loses energy
  s.liquid.tensile_cutoff = 0;
  RandomStream random(3, 0);
  s.initial_velocity.resize(uneven.nodes.size());
  for (auto& v : s.initial_velocity)
    for (auto& c : v) c = random.uniform(-1, 1);
  SolveOptions o;
  o.energy_balance = true;
  o.time_step_safety = 0.999;
  EXPECT_GT(ExplicitSolver(uneven, steel()).solve(s, {}, o).dissipated, 0);
}

// A thin wall with mercury on it is faster once the mercury leaves it. Where faces may separate, the step is that of the mesh with both apart, and a run in
// which they separate remains bounded.
TEST(StableTimeStep, IsThatOfPartedFacesWhereTheyMayPart) {
  Mesh mesh = block({6, 4, 5}, {0, 0, 0}, {0.012, 0.008, 0.0085}, [](const Vec3& x) { return x[2] > 0.0068 ? Region::steel : Region::mercury; });
  for (auto& x : mesh.nodes)
    if (x[2] > 0.006 && x[2] < 0.008) x[2] = 0.0079;
  split(mesh, {Vec3{0, 0, 1}});
  mesh.wetted = faces_at(mesh, 2, 0.0079);
  Mesh free = mesh;
  free.slip.clear();
  RunSetup s = linear_setup(4e-4, 2e-6);
  const double together = ExplicitSolver(mesh, steel()).stable_step(s), apart = ExplicitSolver(free, steel()).stable_step(s);
  measured("apart_over_together", apart / together);
  EXPECT_LT(apart, 0.97 * together);
  s.wetted_cutoff = s.liquid.tensile_cutoff = 1e4;
  EXPECT_NEAR(ExplicitSolver(mesh, steel()).stable_step(s) / apart, 1, 0.01);
  RandomStream random(9, 0);
  s.initial_velocity.resize(mesh.nodes.size());
  for (auto& v : s.initial_velocity)
    for (auto& c : v) c = random.uniform(-1, 1);
  SolveOptions o;
  o.energy_balance = true;
  o.time_step_safety = 0.95;
  EXPECT_LT(ExplicitSolver(mesh, steel()).solve(s, {}, o).energy_balance_error, 0.05);
}

// A solver remembers the last step that it found. Whatever a mechanism changes of the run, the step is the one that a solver without memory finds.
TEST(StableTimeStep, WhatIsRememberedIsTakenForNoOtherSetup) {
  Mesh mesh = block({4, 3, 6}, {0, 0, 0}, {0.004, 0.003, 0.006}, [](const Vec3& x) { return x[2] < 0.002 ? Region::steel : Region::mercury; });
  split(mesh, {Vec3{0, 0, 1}});
  const ExplicitSolver solver(mesh, steel());
  const RunSetup base = linear_setup(0, 0);
  const double k = base.liquid.bulk_modulus, own = solver.stable_step(base);
  const std::vector<std::pair<std::string, std::function<void(RunSetup&)>>> changes{
      {"steel density", [](RunSetup& s) { s.steel_density *= 0.5; }},
      {"liquid density", [](RunSetup& s) { s.liquid_density *= 0.05; }},
      {"steel", [](RunSetup& s) { s.steel.lambda *= 2, s.steel.mu *= 2; }},
      {"bulk modulus", [&](RunSetup& s) { s.liquid.bulk_modulus = 20 * k; }},
      {"viscosity", [](RunSetup& s) { s.liquid.viscosity = 2e4; }},
      {"viscosity of closing", [](RunSetup& s) { s.liquid.tensile_cutoff = 1e5, s.collapse_viscosity = 2; }},
      {"parting faces", [](RunSetup& s) { s.wetted_cutoff = 1e5; }},
      {"a film on them", [](RunSetup& s) { s.wetted_cutoff = 1e5, s.wall_film = 2e-4; }},
      {"hourglass", [&](RunSetup& s) { s.hourglass = 1, s.liquid.bulk_modulus = 20 * k; }},
      {"steel damping", [](RunSetup& s) { s.steel_stiffness_damping = 5e-7; }},
      {"relaxing branches",
       [](RunSetup& s) {
         s.steel_branches = {{0.5, 1e-6}};
       }},
      {"mass damping", [](RunSetup& s) { s.steel_mass_damping = 5e6; }},
      {"a stiff law", [&](RunSetup& s) { s.liquid_law = std::make_shared<OfStiffness>(20 * k); }},
      {"a stiffer law", [&](RunSetup& s) { s.liquid_law = std::make_shared<OfStiffness>(60 * k); }},
      {"lanes", [](RunSetup& s) {
         s.energies = {1.0, 1.0};
       }}};
  for (const auto& [name, change] : changes) {
    RunSetup s = base;
    change(s);
    EXPECT_EQ(solver.stable_step(s), ExplicitSolver(mesh, steel()).stable_step(s)) << name;
    EXPECT_TRUE(name == "lanes" || solver.stable_step(s) != own) << name;
    EXPECT_EQ(solver.stable_step(base), own) << name;
  }
  RunSetup boundless = base;
  boundless.liquid_law = std::make_shared<OfStiffness>(std::numeric_limits<double>::infinity());
  EXPECT_THROW((void)solver.stable_step(boundless), NumericsError);
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

TEST(ExplicitSolver, StopsOnRequest) {
  const Mesh mesh = column(10);
  const std::atomic<bool> stop{true};
  SolveOptions o;
  o.stop = &stop;
  EXPECT_THROW((void)ExplicitSolver(mesh, steel()).solve(linear_setup(1e-5, 1e-6), {}, o), Interrupted);
}
