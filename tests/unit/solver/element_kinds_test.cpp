// The B-bar element checks the fast one; finite strain is small strain for small loads and knows rotations.
#include "base/random.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

std::vector<double> histories(const ExplicitSolver& solver, const RunSetup& s, const std::vector<ObservationRow>& rows, const char* element, const char* kinematics) {
  SolveOptions o;
  o.steel_element = element, o.kinematics = kinematics;
  return solver.solve(s, rows, o).observations;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double d = 0, n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) d += (a[i] - b[i]) * (a[i] - b[i]), n += b[i] * b[i];
  return std::sqrt(d / n);
}

Mesh thick_block(double distortion) {
  Mesh m = block({8, 8, 8}, {0, 0, 0}, {0.04, 0.03, 0.05}, Region::steel);
  RandomStream random(11, 0);
  for (auto& x : m.nodes)
    for (auto& c : x) c += distortion * 0.004 * random.uniform(-1, 1);
  return m;
}

}  // namespace

TEST(BBarElement, AgreesWithTheFastOneInAThickBlock) {
  for (const double distortion : {0.0, 0.15}) {
    const Mesh mesh = thick_block(distortion);
    const ExplicitSolver solver(mesh, steel());
    RunSetup s = linear_setup(4e-5, 1e-6);
    s.initial_velocity = field(mesh, [](const Vec3& x) { return Vec3{5 * x[0] * x[2], 3 * x[0] * x[1], -2 * x[2]}; });
    const std::vector<ObservationRow> rows{component(nearest(mesh, {0.04, 0.03, 0.05}), 0), component(nearest(mesh, {0.02, 0.015, 0.05}), 2), component(nearest(mesh, {0, 0, 0}), 1)};
    const double d = difference(histories(solver, s, rows, "b_bar", "small"), histories(solver, s, rows, "assumed_strain", "small"));
    measured("b_bar_against_fast" + std::string(distortion > 0 ? "_distorted" : ""), d);
    EXPECT_LT(d, 0.03);
    EXPECT_GT(d, 1e-6);  // and is another element
    // Control: 10 % in the modulus is more.
    const LinearElastic softer = LinearElastic::from_young(0.9 * young, poisson);
    RunSetup t = s;
    t.steel = softer;
    EXPECT_GT(difference(histories(ExplicitSolver(mesh, softer), t, rows, "b_bar", "small"), histories(solver, s, rows, "assumed_strain", "small")), 1.5 * d);
  }
}

TEST(BBarElement, IsOneOfSmallStrain) {
  const Mesh mesh = thick_block(0);
  const ExplicitSolver solver(mesh, steel());
  EXPECT_THROW((void)histories(solver, linear_setup(1e-6, 1e-6), {}, "b_bar", "finite"), InputError);
}

// The difference of the two kinematics falls with the load.
TEST(FiniteStrain, IsSmallStrainForSmallLoads) {
  for (const bool with_liquid : {false, true})
    for (const double distortion : {0.0, 0.1}) {
      Mesh mesh = block({12, 3, 6}, {0, 0, 0}, {0.024, 0.006, 0.012}, [&](const Vec3& x) { return with_liquid && x[2] < 0.006 ? Region::mercury : Region::steel; });
      RandomStream random(4, 0);
      for (auto& x : mesh.nodes)
        for (auto& c : x) c += distortion * 0.002 * random.uniform(-1, 1);
      const ExplicitSolver solver(mesh, steel());
      const auto rows = std::vector<ObservationRow>{component(nearest(mesh, {0.024, 0.006, 0.012}), 0), component(nearest(mesh, {0.012, 0, 0.012}), 2)};
      double before = 0;
      for (const double load : {1e-2, 1e-3, 1e-4}) {
        RunSetup s = linear_setup(2e-5, 1e-6);
        s.initial_velocity = field(mesh, [&](const Vec3& x) { return Vec3{load * 1e5 * x[0] * x[2], load * 2e4 * x[1] * x[0], -load * 3e2 * x[2]}; });
        const double d = difference(histories(solver, s, rows, "assumed_strain", "finite"), histories(solver, s, rows, "assumed_strain", "small"));
        measured("finite_against_small_" + std::to_string(with_liquid) + (distortion > 0 ? "_distorted_" : "_") + std::to_string(load), d);
        if (before > 0) EXPECT_NEAR(before / d, 10, 1.5);
        before = d;
      }
    }
}

// Turned as a whole, the body is without stress: nothing moves from its place. In small strain it would burst.
TEST(FiniteStrain, ARotatedBodyIsAtRest) {
  for (const bool liquid : {false, true})
    for (const double distortion : {0.0, 0.15}) {
      Mesh mesh = block({4, 4, 4}, {0, 0, 0}, {0.008, 0.008, 0.008}, liquid ? Region::mercury : Region::steel);
      RandomStream random(7, 0);
      for (auto& x : mesh.nodes)
        for (auto& c : x) c += distortion * 0.002 * random.uniform(-1, 1);
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix() - Eigen::Matrix3d::Identity();
      RunSetup s = linear_setup(5e-6, 5e-6);
      s.initial_displacement = field(mesh, [&](const Vec3& x) { return hexahedron::vec3(turn * hexahedron::point(x)); });
      const ExplicitSolver solver(mesh, steel());
      const auto rows = all_components(mesh);
      const auto moved = [&](const char* kinematics) {
        const auto u = histories(solver, s, rows, "assumed_strain", kinematics);
        double m = 0;
        for (std::size_t i = 0; i + 1 < u.size(); i += 2) m = std::max(m, std::abs(u[i + 1] - u[i]));
        return m;
      };
      measured(std::string(liquid ? "liquid" : "steel") + "_moves_by", moved("finite"));
      EXPECT_LT(moved("finite"), 1e-12);
      EXPECT_GT(moved("small"), 1e-5);
    }
}
