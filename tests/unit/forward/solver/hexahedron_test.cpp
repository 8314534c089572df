#include "forward/solver/hexahedron.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "forward/mesh/hexahedron.hpp"

using namespace calomel;

namespace {

Corners brick(double a, double b, double c, double distortion = 0, std::uint64_t seed = 1) {
  RandomStream random(seed, 0);
  Corners x;
  for (int k = 0; k < 8; ++k)
    x.col(k) << a * (k & 1) + a * random.uniform(-distortion, distortion), b * (k >> 1 & 1) + b * random.uniform(-distortion, distortion),
        c * (k >> 2) + c * random.uniform(-distortion, distortion);
  return x;
}
double volume(const Corners& x) {
  hexahedron::Corners c;
  for (int k = 0; k < 8; ++k) c[std::size_t(k)] = x.col(k);
  return hexahedron::volume(c);
}
const LinearElastic steel = LinearElastic::from_young(193e9, 0.29);

}  // namespace

// B_iI V = dV/dx_iI (Flanagan and Belytschko 1981). V is linear in each coordinate, so that differences are exact.
TEST(HexGeometry, MeanGradientsAreDerivativesOfTheVolume) {
  const Corners x = brick(0.002, 0.003, 0.001, 0.2);
  const HexGeometry g = hex_geometry(x);
  EXPECT_NEAR(g.volume, volume(x), 1e-12 * g.volume);
  EXPECT_FALSE(g.parallelepiped);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 8; ++k) {
      Corners plus = x, minus = x;
      plus(i, k) += 1e-4;
      minus(i, k) -= 1e-4;
      EXPECT_NEAR(g.gradient(i, k), (volume(plus) - volume(minus)) / 2e-4 / g.volume, 1e-9 * g.gradient.norm());
    }
}

TEST(HexGeometry, ModeGradientsAreTheSameOperatorOnModes) {
  const Corners x = brick(0.002, 0.003, 0.001, 0.2);
  const HexGeometry g = hex_geometry(x);
  RandomStream random(2, 0);
  Eigen::Matrix<double, 8, 1> f;
  for (int k = 0; k < 8; ++k) f[k] = random.uniform(-1, 1);
  Eigen::Vector3d by_modes = Eigen::Vector3d::Zero();
  for (int m = 1; m < 8; ++m) {
    double amplitude = 0;
    for (int k = 0; k < 8; ++k) amplitude += mode_sign(m, k) * f[k];
    by_modes += g.mode_gradient.col(m - 1) * amplitude;
  }
  EXPECT_LT((by_modes - g.gradient * f).norm(), 1e-12 * by_modes.norm());
}

TEST(HexGeometry, KnowsParallelepipeds) {
  Corners x = brick(0.002, 0.003, 0.001);
  Eigen::Matrix3d shear;
  shear << 1, 0.3, 0.1, 0, 1, -0.4, 0.2, 0, 1;
  EXPECT_TRUE(hex_geometry(shear * x).parallelepiped);
  x(0, 7) += 1e-6;
  EXPECT_FALSE(hex_geometry(x).parallelepiped);
}

TEST(HourglassStiffness, IsPositiveAndSymmetric) {
  for (const double distortion : {0.0, 0.2}) {
    const auto k = hourglass_stiffness(hex_geometry(brick(0.002, 0.003, 0.001, distortion)), steel);
    EXPECT_LT((k.bending - k.bending.transpose()).norm(), 1e-12 * k.bending.norm());
    const Eigen::VectorXd values = symmetric_eigenvalues(k.bending);
    EXPECT_GT(values[0], 1e-4 * values[8]);
    const Eigen::VectorXd last = symmetric_eigenvalues(k.last);
    EXPECT_GT(last[0], 1e-4 * last[2]);
  }
}

// Parallelepipeds are exact in bending: the field of pure bending about y in a plate with inclined elements,
// u_x = kappa x z, u_y = -nu kappa y z, u_z = -kappa (x^2 - nu y^2 + nu z^2)/2, stores E kappa^2/2 int z^2 dV.
TEST(HourglassStiffness, IsExactInPureBendingOfALeaningElement) {
  const double nu = 0.29, kappa = 0.1, h = 0.001;
  for (const double lean : {0.0, 0.4}) {
    Corners x = brick(0.002, 0.003, h);
    for (int k = 0; k < 8; ++k) x(0, k) += lean * x(2, k);
    x.colwise() -= x.rowwise().mean();
    const HexGeometry g = hex_geometry(x);
    ASSERT_TRUE(g.parallelepiped);
    Eigen::Matrix<double, 3, 8> u;
    for (int k = 0; k < 8; ++k) {
      const double a = x(0, k), b = x(1, k), c = x(2, k);
      u.col(k) << kappa * a * c, -nu * kappa * b * c, -kappa / 2 * (a * a - nu * b * b + nu * c * c);
    }
    const Eigen::Matrix3d grad = u * g.gradient.transpose(), strain = 0.5 * (grad + grad.transpose());
    double energy = g.volume * (0.5 * steel.lambda * strain.trace() * strain.trace() + steel.mu * strain.squaredNorm());
    const auto k = hourglass_stiffness(g, steel);
    Eigen::Matrix<double, 9, 1> q;
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      for (int a = 0; a < 3; ++a) {
        q[c * 3 + a] = 0;
        for (int n = 0; n < 8; ++n) q[c * 3 + a] += mode_sign(hourglass_modes[std::size_t(a)], n) * u(c, n);
      }
      for (int n = 0; n < 8; ++n) last[c] += mode_sign(7, n) * u(c, n);
    }
    energy += 0.5 * q.dot(k.bending * q) + 0.5 * last.dot(k.last * last);
    const double exact = 193e9 * kappa * kappa / 2 * g.volume * h * h / 12;
    EXPECT_NEAR(energy / exact, 1, 1e-9) << lean;
  }
}

TEST(Eigenvalues, FixedDirectionsOnlyLowerThem) {
  const HexGeometry g = hex_geometry(brick(0.002, 0.003, 0.001, 0.1));
  const auto k = hourglass_stiffness(g, steel);
  std::array<std::uint8_t, 8> free{}, plane;
  plane.fill(2);
  EXPECT_LE(steel_eigenvalue(g, steel, k, plane), steel_eigenvalue(g, steel, k, free));
  EXPECT_LT(liquid_eigenvalue(g, plane), liquid_eigenvalue(g, free));
}
