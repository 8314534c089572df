// Patch, rigid-body and hourglass tests (physics.md section 4), all on forces that the solver itself computes.
#include <fmt/format.h>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// 4 x 4 x 4 elements of 2 mm whose inner nodes are moved by up to 0.5 mm.
Mesh distorted(Region region) {
  Mesh m = block({4, 4, 4}, {0, 0, 0}, {0.008, 0.008, 0.008}, region);
  RandomStream random(7, 0);
  for (auto& x : m.nodes)
    if (std::all_of(x.begin(), x.end(), [](double c) { return c > 1e-4 && c < 0.0079; }))
      for (auto& c : x) c += random.uniform(-0.0005, 0.0005);
  return m;
}
bool inner(const Vec3& x) {
  return std::all_of(x.begin(), x.end(), [](double c) { return c > 1e-4 && c < 0.0079; });
}

std::vector<Vec3> linear(const Mesh& mesh, const Eigen::Matrix3d& gradient) {
  return field(mesh, [&](const Vec3& x) { return hexahedron::vec3(gradient * hexahedron::point(x)); });
}

/// Greatest acceleration of an inner node over the greatest of all nodes.
double inner_share(const Mesh& mesh, const Eigen::VectorXd& a) {
  double in = 0, all = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const double size = a.segment<3>(Eigen::Index(3 * n)).norm();
    all = std::max(all, size);
    if (inner(mesh.nodes[n])) in = std::max(in, size);
  }
  return in / all;
}

const Eigen::Matrix3d gradient = (Eigen::Matrix3d() << 1.1, 0.3, -0.7, 0.2, -0.4, 0.5, 0.9, -0.6, 0.8).finished() * 1e-3;

}  // namespace

// Irons' patch test: in a linear field no inner node has a force, whatever the shape of the elements.
TEST(Patch, LinearFieldsLeaveInnerNodesOfADistortedPatchAtRest) {
  for (const Region region : {Region::steel, Region::mercury}) {
    const Mesh mesh = distorted(region);
    const ExplicitSolver solver(mesh, steel());
    const RunSetup setup = linear_setup(0, 0);
    const double share = inner_share(mesh, accelerations(solver, setup, linear(mesh, gradient)));
    const auto bent = field(mesh, [](const Vec3& x) { return Vec3{0.1 * x[0] * x[0], 0, 0}; });
    verify({.item = "Patch and modes",
            .quantity = std::string("net force within a distorted patch, ") + (region == Region::steel ? "steel" : "mercury"),
            .reference = 0,
            .source = "linear field (Irons)",
            .measured = share,
            .tolerance = 1e-10,
            .control = "quadratic field",
            .control_value = inner_share(mesh, accelerations(solver, setup, bent))});
  }
}

// Control for the test above: gradients at the centre of the element, instead of their mean over the volume, fail the patch test.
TEST(Patch, CentreGradientsInPlaceOfMeanOnesWouldFail) {
  const Mesh mesh = distorted(Region::steel);
  for (const bool mean : {true, false}) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(Eigen::Index(3 * mesh.nodes.size()));
    const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
    const Eigen::Matrix3d stress = steel().lambda * strain.trace() * Eigen::Matrix3d::Identity() + 2 * steel().mu * strain;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      const auto x = hexahedron::corners(mesh, e);
      Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
      for (int a = 0; a < 8; ++a)
        for (int k = 0; k < 3; ++k) j.col(k) += (a >> k & 1 ? 0.125 : -0.125) * x[std::size_t(a)];
      const Eigen::Matrix3d inverse = j.inverse();
      // The mean gradient of N_I times the volume is dV/dx_I (Flanagan and Belytschko 1981), here by differences.
      for (int a = 0; a < 8; ++a) {
        Eigen::Vector3d b;
        for (int i = 0; i < 3; ++i) {
          if (mean) {
            auto plus = x, minus = x;
            // V is linear in each coordinate
            plus[std::size_t(a)][i] += 1e-5;
            minus[std::size_t(a)][i] -= 1e-5;
            b[i] = (hexahedron::volume(plus) - hexahedron::volume(minus)) / 2e-5;
          } else {
            b[i] = 0;
            for (int k = 0; k < 3; ++k) b[i] += (a >> k & 1 ? 0.125 : -0.125) * inverse(k, i) * hexahedron::volume(x);
          }
        }
        force.segment<3>(3 * mesh.elements[e][std::size_t(a)]) += stress * b;
      }
    }
    if (mean)
      EXPECT_LT(inner_share(mesh, force), 1e-9);
    else
      EXPECT_GT(inner_share(mesh, force), 1e-3);
  }
}

TEST(Patch, RigidMotionsLeaveNoForceAnywhere) {
  for (const Region region : {Region::steel, Region::mercury}) {
    const Mesh mesh = distorted(region);
    const ExplicitSolver solver(mesh, steel());
    const RunSetup setup = linear_setup(0, 0);
    const Eigen::Matrix3d spin = gradient - gradient.transpose();
    const double scale = accelerations(solver, setup, linear(mesh, gradient + gradient.transpose())).cwiseAbs().maxCoeff();
    verify({.item = "Patch and modes",
            .quantity = std::string("force of a rigid rotation, ") + (region == Region::steel ? "steel" : "mercury"),
            .reference = 0,
            .source = "exact",
            .measured = accelerations(solver, setup, linear(mesh, spin)).cwiseAbs().maxCoeff() / scale,
            .tolerance = 1e-10,
            .control = "a stretch of a hundredth of it",
            .control_value = accelerations(solver, setup, linear(mesh, 0.01 * (gradient + gradient.transpose()))).cwiseAbs().maxCoeff() / scale});
    const auto shift = field(mesh, [](const Vec3&) { return Vec3{1e-5, -2e-5, 3e-5}; });
    EXPECT_LT(accelerations(solver, setup, shift).cwiseAbs().maxCoeff(), 1e-10 * scale);
  }
}

TEST(Patch, MercuryCarriesNoShear) {
  Eigen::Matrix3d isochoric = gradient;
  isochoric -= gradient.trace() / 3 * Eigen::Matrix3d::Identity();
  for (const Region region : {Region::steel, Region::mercury}) {
    const Mesh mesh = distorted(region);
    const ExplicitSolver solver(mesh, steel());
    const RunSetup setup = linear_setup(0, 0);
    const double ratio = accelerations(solver, setup, linear(mesh, isochoric)).cwiseAbs().maxCoeff() /
                         accelerations(solver, setup, linear(mesh, gradient)).cwiseAbs().maxCoeff();
    if (region == Region::mercury)
      EXPECT_LT(ratio, 1e-10);
    else
      EXPECT_GT(ratio, 0.1);  // control
  }
}

// The force on a face of a stretched bar is stress times area, with the exact uniform stress.
TEST(Patch, UniformStressLoadsTheFacesWithItsTraction) {
  const Mesh mesh = distorted(Region::steel);
  const ExplicitSolver solver(mesh, steel());
  const RunSetup setup = linear_setup(0, 0);
  const auto a = accelerations(solver, setup, linear(mesh, gradient));
  const auto m = masses(mesh, setup);
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const Eigen::Matrix3d stress = steel().lambda * strain.trace() * Eigen::Matrix3d::Identity() + 2 * steel().mu * strain;
  // The traction at corner (8, 8, 8) mm: a quarter of an element's face in each direction, 1 mm^2 each.
  const NodeId corner = nearest(mesh, {0.008, 0.008, 0.008});
  const Eigen::Vector3d force = m[corner] * a.segment<3>(3 * corner), expected = -stress * Eigen::Vector3d::Ones() * 1e-6;
  EXPECT_LT((force - expected).norm(), 1e-9 * expected.norm());
  // Control: a Poisson's ratio with an error of 0.01.
  const LinearElastic wrong = LinearElastic::from_young(young, poisson + 0.01);
  RunSetup spoiled = setup;
  spoiled.steel = wrong;
  const Eigen::Vector3d other = m[corner] * accelerations(ExplicitSolver(mesh, wrong), spoiled, linear(mesh, gradient)).segment<3>(3 * corner);
  EXPECT_GT((other - expected).norm(), 1e-3 * expected.norm());
}

TEST(SteelElement, HasSixZeroEnergyModesAndNoMore) {
  for (const bool skewed : {false, true}) {
    Mesh mesh = block({1, 1, 1}, {0, 0, 0}, {0.002, 0.003, 0.0015}, Region::steel);
    if (skewed) mesh.nodes[0] = {-0.0003, 0.0002, -0.0001}, mesh.nodes[7] = {0.0023, 0.0031, 0.0017}, mesh.nodes[2][0] += 0.0004;
    const ExplicitSolver solver(mesh, steel());
    const Eigen::MatrixXd k = stiffness(solver, linear_setup(0, 0));
    EXPECT_LT((k - k.transpose()).norm(), 1e-10 * k.norm());
    const Eigen::VectorXd values = symmetric_eigenvalues(0.5 * (k + k.transpose()));
    for (int i = 0; i < 24; ++i) {
      if (i < 6)
        EXPECT_LT(std::abs(values[i]), 1e-9 * values[23]) << i;
      else
        EXPECT_GT(values[i], 1e-3 * values[23]) << i;
    }
    const auto soft = [&](double share) { return double((values.array().abs() < share * values[23]).count()); };
    verify({.item = "Patch and modes",
            .quantity = std::string("modes without energy of a steel element, ") + (skewed ? "skewed" : "rectangular"),
            .reference = 6,
            .source = "rigid motions",
            .measured = soft(1e-9),
            .tolerance = 0,
            .control = "one-point element: hourglass modes free",
            .control_value = 18});
  }
}

// The liquid resists only a change of volume and, weakly, hourglassing: 1 + 12 energies, 11 of zero.
TEST(LiquidElement, ResistsVolumeAndWeaklyHourglassing) {
  const Mesh mesh = block({1, 1, 1}, {0, 0, 0}, {0.002, 0.002, 0.002}, Region::mercury);
  const ExplicitSolver solver(mesh, steel());
  const RunSetup setup = linear_setup(0, 0);
  const Eigen::MatrixXd k = stiffness(solver, setup);
  const Eigen::VectorXd values = symmetric_eigenvalues(0.5 * (k + k.transpose()));
  const double dilatation = setup.liquid.bulk_modulus * 8e-9 * 8 * 3 / (16 * 0.002 * 0.002);  // V K sum B^2, B = 1/(4 h)
  EXPECT_NEAR(values[23], dilatation, 1e-9 * dilatation);
  for (int i = 0; i < 11; ++i) EXPECT_LT(std::abs(values[i]), 1e-10 * values[23]);
  for (int i = 11; i < 23; ++i) EXPECT_NEAR(values[i] / values[23], setup.hourglass, 1e-6);
}

// Pure bending of a rectangular element about y with curvature kappa: u_x = kappa x z and, when free to, u_y = -nu kappa y z:
// energy E/(1 - nu^2) kappa^2 V h^2 / 24 held straight across, E kappa^2 V h^2 / 24 with the anticlastic part (beam theory).
TEST(SteelElement, BendingEnergyOfARectangularElementIsExact) {
  const double lx = 0.004, ly = 0.003, h = 0.0015, kappa = 0.1;
  const Mesh mesh = block({1, 1, 1}, {-lx / 2, -ly / 2, -h / 2}, {lx / 2, ly / 2, h / 2}, Region::steel);
  const ExplicitSolver solver(mesh, steel());
  const RunSetup setup = linear_setup(0, 0);
  const auto m = masses(mesh, setup);
  const auto energy = [&](const std::vector<Vec3>& u) {
    const auto a = accelerations(solver, setup, u);
    double w = 0;
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t c = 0; c < 3; ++c) w -= 0.5 * m[Eigen::Index(n)] * a[Eigen::Index(3 * n + c)] * u[n][c];
    return w;
  };
  const double unit = kappa * kappa * lx * ly * h * h * h / 24;
  const double straight = energy(field(mesh, [&](const Vec3& x) { return Vec3{kappa * x[0] * x[2], 0, 0}; }));
  const double saddle = energy(field(mesh, [&](const Vec3& x) { return Vec3{kappa * x[0] * x[2], -poisson * kappa * x[1] * x[2], 0}; }));
  EXPECT_NEAR(straight, young / (1 - poisson * poisson) * unit, 1e-9 * straight);
  EXPECT_NEAR(saddle, young * unit, 1e-9 * saddle);
  // Control: the fully integrated trilinear element locks in this mode, E (1 - nu)/((1 + nu)(1 - 2 nu)) and the shear of x z.
  const double locked = (steel().longitudinal_modulus() + steel().mu * lx * lx / (h * h)) * unit;
  EXPECT_GT(locked / straight, 2);
}

// A plate strip 10 mm x 1 mm in plane strain under an end moment M per width: axial deflection of its end
// M L^2 / (2 E' I), I = h^3/12, E' = E/(1 - nu^2): a solution quadratic in x, z that elements exact in bending hold to rounding.
TEST(SteelElement, StripUnderAnEndMomentDeflectsExactlyWithOneElementThroughItsThickness) {
  const double length = 0.01, h = 0.001, width = 0.001;
  for (const int through : {1, 2}) {
    const Mesh mesh = block({10, 1, through}, {0, 0, 0}, {length, width, h}, Region::steel);
    const ExplicitSolver solver(mesh, steel());
    Eigen::MatrixXd k = stiffness(solver, linear_setup(0, 0));
    Eigen::VectorXd f = Eigen::VectorXd::Zero(k.rows());
    const double moment = 1;  // per width; traction sigma_x = M (z - h/2) / I on the end, consistent nodal forces
    for (const auto& face : faces_at(mesh, 0, length))
      for (const NodeId n : face.nodes) {
        double low = 1e9, high = -1e9;
        for (const NodeId m : face.nodes)
          low = std::min(low, mesh.nodes[std::size_t(m)][2] - h / 2), high = std::max(high, mesh.nodes[std::size_t(m)][2] - h / 2);
        const bool top = mesh.nodes[std::size_t(n)][2] - h / 2 > (low + high) / 2;
        f[3 * n] += moment * 12 / (h * h * h) * (width / 2) * (high - low) * (top ? low + 2 * high : 2 * low + high) / 6;
      }
    const NodeId held = nearest(mesh, {0, 0, 0}), held_too = nearest(mesh, {0, width, 0});
    for (Eigen::Index i = 0; i < k.rows(); ++i) {
      const NodeId n = NodeId(i / 3);
      const bool fixed = i % 3 == 1 || (i % 3 == 0 && mesh.nodes[std::size_t(n)][0] < 1e-9) || (i % 3 == 2 && (n == held || n == held_too));
      if (fixed) k.row(i).setZero(), k.col(i).setZero(), k(i, i) = 1, f[i] = 0;
    }
    const Eigen::VectorXd u = solve_symmetric(k, f);
    const double theory = -moment * length * length / 2 / (young / (1 - poisson * poisson) * h * h * h / 12);
    const double error = u[3 * nearest(mesh, {length, 0, 0}) + 2] / theory - 1;
    verify({.item = "Bending",
            .quantity = fmt::format("strip under an end moment, {} through it, relative error", through),
            .reference = 0,
            .source = "M L^2 / 2 E' I",
            .measured = error,
            .tolerance = 1e-8,
            .control = "no plane-strain factor",
            .control_value = u[3 * nearest(mesh, {length, 0, 0}) + 2] / (theory / (1 - poisson * poisson)) - 1});
    // Control: Young's modulus without the plane-strain factor is far off.
    EXPECT_GT(std::abs(u[3 * nearest(mesh, {length, 0, 0}) + 2] / (theory / (1 - poisson * poisson)) - 1), 0.05);
  }
}
