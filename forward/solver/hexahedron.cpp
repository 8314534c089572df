#include "forward/solver/hexahedron.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace calomel {

HexGeometry hex_geometry(const Corners& x) {
  HexGeometry g;
  // int dN_I/dx_i dV = int cof(J)_ik dN_I/dxi_k dxi: of degree two in each coordinate, so 2 x 2 x 2 Gauss points are exact.
  Eigen::Matrix<double, 3, 8> b = Eigen::Matrix<double, 3, 8>::Zero();
  double volume = 0;
  const double gauss = 1 / std::sqrt(3.0);
  for (int point = 0; point < 8; ++point) {
    const double xi[3] = {point & 1 ? gauss : -gauss, point & 2 ? gauss : -gauss, point & 4 ? gauss : -gauss};
    Eigen::Matrix<double, 3, 8> dn;
    for (int corner = 0; corner < 8; ++corner) {
      const double s[3] = {corner & 1 ? 1. : -1., corner & 2 ? 1. : -1., corner & 4 ? 1. : -1.};
      const double f[3] = {1 + s[0] * xi[0], 1 + s[1] * xi[1], 1 + s[2] * xi[2]};
      dn(0, corner) = 0.125 * s[0] * f[1] * f[2];
      dn(1, corner) = 0.125 * s[1] * f[0] * f[2];
      dn(2, corner) = 0.125 * s[2] * f[0] * f[1];
    }
    const Eigen::Matrix3d j = x * dn.transpose();  // dx_i / dxi_k
    Eigen::Matrix3d cofactor;
    cofactor.col(0) = j.col(1).cross(j.col(2));
    cofactor.col(1) = j.col(2).cross(j.col(0));
    cofactor.col(2) = j.col(0).cross(j.col(1));
    volume += j.col(0).dot(cofactor.col(0));
    b.noalias() += cofactor * dn;
  }
  g.volume = volume;
  g.gradient = b / volume;
  Eigen::Matrix3d centre = Eigen::Matrix3d::Zero();
  for (int corner = 0; corner < 8; ++corner)
    for (int k = 0; k < 3; ++k) centre.col(k) += 0.125 * mode_sign(1 << k, corner) * x.col(corner);
  g.inverse_jacobian = centre.inverse();
  g.mode_gradient.setZero();
  g.hourglass.setZero();
  for (int corner = 0; corner < 8; ++corner) {
    for (int m = 1; m < 8; ++m) g.mode_gradient.col(m - 1) += 0.125 * mode_sign(m, corner) * g.gradient.col(corner);
    for (int a = 0; a < 4; ++a) g.hourglass.col(a) += mode_sign(hourglass_modes[std::size_t(a)], corner) * x.col(corner);
  }
  g.parallelepiped = g.hourglass.cwiseAbs().maxCoeff() < 1e-9 * std::cbrt(volume);
  return g;
}

HourglassStiffness hourglass_stiffness(const HexGeometry& g, const LinearElastic& steel) {
  HourglassStiffness k;
  k.bending.setZero();
  const double lambda = steel.lambda, mu = steel.mu;
  // Position among the first three hourglass modes of the mode xi_k xi_l.
  const auto mode_of = [](int a, int b) { return (a == 0 || b == 0) ? ((a == 1 || b == 1) ? 0 : 1) : 2; };
  // The linear parts of the strain: G = xi_k sum_{l != k} (q_{c,kl} / 8) n_l, n_l = row l of the inverse Jacobian.
  // The incompatible modes add a (x) n_k at the same xi_k; minimising over a leaves the stiffness of plane stress normal to n_k.
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d n = g.inverse_jacobian.row(axis).transpose();
    const auto couple = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) -> Eigen::Matrix3d {
      // (a (x) p) : C : (b (x) q) = a.[lambda p q^T + mu (p.q) I + mu q p^T].b
      return lambda * p * q.transpose() + mu * p.dot(q) * Eigen::Matrix3d::Identity() + mu * q * p.transpose();
    };
    const Eigen::Matrix3d inner = couple(n, n).inverse();
    for (int l = 0; l < 3; ++l) {
      if (l == axis) continue;
      for (int m = 0; m < 3; ++m) {
        if (m == axis) continue;
        const Eigen::Vector3d nl = g.inverse_jacobian.row(l).transpose(), nm = g.inverse_jacobian.row(m).transpose();
        const Eigen::Matrix3d c = (couple(nl, nm) - couple(nl, n) * inner * couple(n, nm)) * (g.volume / 3 / 64);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) k.bending(i * 3 + mode_of(axis, l), j * 3 + mode_of(axis, m)) += c(i, j);
      }
    }
  }
  k.last.setZero();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d n = g.inverse_jacobian.row(axis).transpose();
    k.last += steel.young() * g.volume / 9 / 64 * n * n.transpose();
  }
  return k;
}

ModeStiffness b_bar_stiffness(const Corners& x, const LinearElastic& steel) {
  const HexGeometry mean = hex_geometry(x);
  const double gauss = 1 / std::sqrt(3.0);
  Eigen::Matrix<double, 6, 6> c = Eigen::Matrix<double, 6, 6>::Zero();  // xx yy zz xy yz zx, engineering shear
  c.topLeftCorner<3, 3>().setConstant(steel.lambda);
  for (int i = 0; i < 3; ++i) c(i, i) += 2 * steel.mu, c(i + 3, i + 3) = steel.mu;
  ModeStiffness k = ModeStiffness::Zero();
  for (int point = 0; point < 8; ++point) {
    const double xi[3] = {point & 1 ? gauss : -gauss, point & 2 ? gauss : -gauss, point & 4 ? gauss : -gauss};
    // Values of mode m at xi are products of its coordinates; f = sum_m f_m mode_m / 8.
    Eigen::Matrix<double, 3, 7> slope;
    for (int m = 1; m < 8; ++m)
      for (int axis = 0; axis < 3; ++axis) {
        double value = (m >> axis) & 1 ? 0.125 : 0;
        for (int other = 0; other < 3; ++other)
          if (other != axis && ((m >> other) & 1)) value *= xi[other];
        slope(axis, m - 1) = value;
      }
    Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
    for (int m = 1; m < 8; ++m) {
      Eigen::Vector3d amplitude = Eigen::Vector3d::Zero();
      for (int corner = 0; corner < 8; ++corner) amplitude += mode_sign(m, corner) * x.col(corner);
      j += amplitude * slope.col(m - 1).transpose();
    }
    const Eigen::Matrix<double, 3, 7> gradient = j.transpose().inverse() * slope;
    Eigen::Matrix<double, 6, 21> b = Eigen::Matrix<double, 6, 21>::Zero();
    for (int m = 0; m < 7; ++m) {
      const Eigen::Vector3d d = gradient.col(m), dilatation = (mean.mode_gradient.col(m) - d) / 3;
      for (int axis = 0; axis < 3; ++axis) {
        b(axis, axis * 7 + m) += d(axis);
        for (int row = 0; row < 3; ++row) b(row, axis * 7 + m) += dilatation(axis);
      }
      b(3, m) = d(1);
      b(3, 7 + m) = d(0);
      b(4, 7 + m) = d(2);
      b(4, 14 + m) = d(1);
      b(5, m) = d(2);
      b(5, 14 + m) = d(0);
    }
    k += j.determinant() * b.transpose() * c * b;
  }
  return k;
}

double steel_eigenvalue(const HexGeometry& g, const LinearElastic& steel, const HourglassStiffness& k, const std::array<std::uint8_t, 8>& fixed) {
  // Constant part: V B^T C B against (rho V / 8): 8 / rho times the greatest eigenvalue of C^1/2 (sum_I B_I B_I^T) C^1/2.
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d d = g.gradient.col(corner);
    for (int c = 0; c < 3; ++c) {
      if (fixed[std::size_t(corner)] & (1 << c)) continue;
      Eigen::Matrix<double, 6, 1> s = Eigen::Matrix<double, 6, 1>::Zero();  // xx yy zz xy yz zx, engineering shear
      s(c) = d(c);
      if (c == 0) {
        s(3) = d(1);
        s(5) = d(2);
      }
      if (c == 1) {
        s(3) = d(0);
        s(4) = d(2);
      }
      if (c == 2) {
        s(4) = d(1);
        s(5) = d(0);
      }
      gram += s * s.transpose();
    }
  }
  // C^1/2 on normal strains has the eigenvalues 3 lambda + 2 mu (trace) and 2 mu (rest); on shear mu.
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Zero();
  const double trace = std::sqrt(3 * steel.lambda + 2 * steel.mu), deviator = std::sqrt(2 * steel.mu);
  root.topLeftCorner<3, 3>() = deviator * Eigen::Matrix3d::Identity() + (trace - deviator) / 3 * Eigen::Matrix3d::Ones();
  root.bottomRightCorner<3, 3>() = std::sqrt(steel.mu) * Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, 6, 6> scaled = root * gram * root;
  const double constant = 8 * symmetric_eigenvalues(scaled)(5);
  const double bending = symmetric_eigenvalues(k.bending)(8);
  const double last = symmetric_eigenvalues(k.last)(2);
  // u_I = h_a(I) e: q = 8 e, mass rho V; modes are orthogonal to linear fields in a parallelepiped.
  const double hourglass = 64 * std::max(bending, last) / g.volume;
  return g.parallelepiped ? std::max(constant, hourglass) : constant + hourglass;
}

double liquid_eigenvalue(const HexGeometry& g, const std::array<std::uint8_t, 8>& fixed) {
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner)
    for (int c = 0; c < 3; ++c)
      if (!(fixed[std::size_t(corner)] & (1 << c))) sum += g.gradient(c, corner) * g.gradient(c, corner);
  return 8 * sum;
}

double liquid_hourglass(const HexGeometry& g) { return g.volume * g.gradient.squaredNorm() / 8; }

}  // namespace calomel
