// The B-bar element agrees with the fast element. Finite strain agrees with small strain for small loads and is exact under rotations.
#include "base/random.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

std::vector<double> histories(const ExplicitSolver& solver, const RunSetup& s, const std::vector<ObservationRow>& rows, const char* element,
                              const char* kinematics) {
  SolveOptions o;
  o.steel_element = element;
  o.kinematics = kinematics;
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
    const std::vector<ObservationRow> rows{component(nearest(mesh, {0.04, 0.03, 0.05}), 0), component(nearest(mesh, {0.02, 0.015, 0.05}), 2),
                                           component(nearest(mesh, {0, 0, 0}), 1)};
    const double d = difference(histories(solver, s, rows, "b_bar", "small"), histories(solver, s, rows, "assumed_strain", "small"));
    measured("b_bar_against_fast" + std::string(distortion > 0 ? "_distorted" : ""), d);
    EXPECT_LT(d, 0.03);
    EXPECT_GT(d, 1e-6);  // and the two elements are not the same
    // Control: 10 % in the modulus makes a larger difference.
    const LinearElastic softer = LinearElastic::from_young(0.9 * young, poisson);
    RunSetup t = s;
    t.steel = softer;
    EXPECT_GT(difference(histories(ExplicitSolver(mesh, softer), t, rows, "b_bar", "small"), histories(solver, s, rows, "assumed_strain", "small")), 1.5 * d);
  }
}

// Bending u = (k x z, 0, -k x^2 / 2) of one element through the thickness: the assumed strain is exact for any shape of the element. The energy of the B-bar
// element over the exact one is (2 mu / E') (2/3 + (l/h)^2 / 2) by hand, parasitic shear included.
TEST(BBarElement, IsTooStiffInBendingByItsParasiticShear) {
  const double h = 0.002, curvature = 1e-3, plane_modulus = young / (1 - poisson * poisson);
  for (const double aspect : {1.0, 2.0, 4.0}) {
    const double l = aspect * h;
    const Mesh mesh = block({5, 1, 1}, {0, 0, 0}, {5 * l, h, h}, Region::steel);
    const ExplicitSolver solver(mesh, steel());
    const RunSetup s = linear_setup(0, 0);
    const auto bent = field(mesh, [&](const Vec3& x) { return Vec3{curvature * x[0] * (x[2] - h / 2), 0, -curvature * x[0] * x[0] / 2}; });
    const auto m = masses(mesh, s);
    const auto energy = [&](const char* element) {
      const auto a = accelerations(solver, s, bent, {.steel_element = element});
      double e = 0;
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        for (std::size_t c = 0; c < 3; ++c) e -= 0.5 * m[Eigen::Index(n)] * a[Eigen::Index(3 * n + c)] * bent[n][c];
      return e;
    };
    const double exact = plane_modulus / 2 * curvature * curvature * h * h / 12 * 5 * l * h * h;
    const double by_hand = 2 * steel().mu / plane_modulus * (2.0 / 3 + aspect * aspect / 2);
    measured("assumed_strain_at_aspect_" + std::to_string(int(aspect)), energy("assumed_strain") / exact);
    measured("b_bar_at_aspect_" + std::to_string(int(aspect)), energy("b_bar") / exact);
    EXPECT_NEAR(energy("assumed_strain") / exact, 1, 1e-8);
    EXPECT_NEAR(energy("b_bar") / exact, by_hand, 1e-8);
  }
}

// Irons' patch test for the elements that are not in the table of docs/verification.
TEST(ElementKinds, LinearFieldsLeaveTheInnerNodesOfADistortedPatchAtRest) {
  Mesh mesh = block({4, 4, 4}, {0, 0, 0}, {0.008, 0.008, 0.008}, Region::steel);
  const auto inner = [](const Vec3& x) { return std::all_of(x.begin(), x.end(), [](double c) { return c > 1e-4 && c < 0.0079; }); };
  RandomStream random(7, 0);
  for (auto& x : mesh.nodes)
    if (inner(x)) {
      for (auto& c : x) c += random.uniform(-0.0005, 0.0005);
    }
  const ExplicitSolver solver(mesh, steel());
  const RunSetup s = linear_setup(0, 0);
  const Eigen::Matrix3d gradient = (Eigen::Matrix3d() << 1.1, 0.3, -0.7, 0.2, -0.4, 0.5, 0.9, -0.6, 0.8).finished() * 0.1;
  const auto share = [&](const SolveOptions& o, bool bent) {
    const auto u = field(mesh, [&](const Vec3& x) { return bent ? Vec3{10 * x[0] * x[0], 0, 0} : hexahedron::vec3(gradient * hexahedron::point(x)); });
    const auto a = accelerations(solver, s, u, o);
    double in = 0, all = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const double size = a.segment<3>(Eigen::Index(3 * n)).norm();
      all = std::max(all, size);
      if (inner(mesh.nodes[n])) in = std::max(in, size);
    }
    return in / all;
  };
  for (const SolveOptions& o : {SolveOptions{.steel_element = "b_bar"}, SolveOptions{.kinematics = "finite"}}) {
    EXPECT_LT(share(o, false), 1e-10) << o.steel_element << ' ' << o.kinematics;
    EXPECT_GT(share(o, true), 1e-3) << o.steel_element << ' ' << o.kinematics;
  }
}

TEST(BBarElement, IsOneOfSmallStrain) {
  const Mesh mesh = thick_block(0);
  const ExplicitSolver solver(mesh, steel());
  EXPECT_THROW((void)histories(solver, linear_setup(1e-6, 1e-6), {}, "b_bar", "finite"), InputError);
}

// The difference of the two kinematics decreases with the load.
TEST(FiniteStrain, IsSmallStrainForSmallLoads) {
  for (const bool with_liquid : {false, true})
    for (const double distortion : {0.0, 0.1}) {
      Mesh mesh =
          block({12, 3, 6}, {0, 0, 0}, {0.024, 0.006, 0.012}, [&](const Vec3& x) { return with_liquid && x[2] < 0.006 ? Region::mercury : Region::steel; });
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
        if (before > 0) {
          EXPECT_NEAR(before / d, 10, 1.5);
        }
        before = d;
      }
    }
}

// A body that is turned as a whole has no stress and remains at rest. With small strain it would burst.
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

// On a block that is stretched by far and turned, each face carries the exact traction: P N with P = F S, S = lambda tr(E) + 2 mu E, E = (F^T F - 1) / 2 in the
// steel, and P = -p cof F, p = -K (det F - 1) in the liquid.
TEST(FiniteStrain, FacesOfAStretchedAndTurnedBlockHaveTheExactTraction) {
  const double side = 0.006;
  const Eigen::Matrix3d stretch = (Eigen::Matrix3d() << 1.25, 0.05, 0, 0.05, 0.85, -0.04, 0, -0.04, 1.1).finished();
  const Eigen::Matrix3d f = Eigen::AngleAxisd(0.7, Eigen::Vector3d(2, -1, 1).normalized()).toRotationMatrix() * stretch, identity = Eigen::Matrix3d::Identity();
  for (const Region region : {Region::steel, Region::mercury}) {
    const Mesh mesh = block({3, 3, 3}, {0, 0, 0}, {side, side, side}, region);
    const ExplicitSolver solver(mesh, steel());
    const RunSetup s = linear_setup(0, 0);
    const auto u = field(mesh, [&](const Vec3& x) { return hexahedron::vec3((f - identity) * hexahedron::point(x)); });
    const Eigen::Matrix3d green = 0.5 * (f.transpose() * f - identity);
    const Eigen::Matrix3d p = region == Region::steel
                                  ? Eigen::Matrix3d(f * (steel().lambda * green.trace() * identity + 2 * steel().mu * green))
                                  : Eigen::Matrix3d(s.liquid.bulk_modulus * (f.determinant() - 1) * f.determinant() * f.inverse().transpose());
    const auto m = masses(mesh, s);
    const auto error = [&](const SolveOptions& o) {
      const auto a = accelerations(solver, s, u, o);
      double worst = 0;
      for (int axis = 0; axis < 3; ++axis) {
        // Inside a face only that face pulls: each of its four inner nodes carries a ninth of the area.
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
          const Vec3& x = mesh.nodes[n];
          const auto within = [&](int k) { return x[std::size_t(k)] > 1e-9 && x[std::size_t(k)] < side - 1e-9; };
          if (!plane(axis, side)(x) || !within((axis + 1) % 3) || !within((axis + 2) % 3)) continue;
          const Eigen::Vector3d exact = -p.col(axis) * side * side / 9, force = m[Eigen::Index(n)] * a.segment<3>(Eigen::Index(3 * n));
          worst = std::max(worst, (force - exact).norm() / (p.norm() * side * side / 9));
        }
      }
      return worst;
    };
    EXPECT_LT(error({.kinematics = "finite"}), 1e-8);
    EXPECT_GT(error({}), 0.1);  // small strain
  }
}
