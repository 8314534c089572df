#pragma once
/// The eight-node hexahedron: mean-quadrature gradients, hourglass modes, and the stiffness of the hourglass modes in steel.
///
/// Nodal values f_I are carried as Walsh-Hadamard modes f_m = sum_I s_m(I) f_I; the mode number m is a bit mask over
/// (xi, eta, zeta), s_m(I) the product of the signs of the named coordinates at corner I: modes 1, 2, 4 are linear,
/// 3, 5, 6, 7 the hourglass modes eta xi, zeta xi, zeta eta, xi eta zeta.
#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "forward/material/linear_elastic.hpp"
#include "forward/mesh/mesh.hpp"

namespace calomel {

using Corners = Eigen::Matrix<double, 3, 8>;  ///< coordinates [m], one corner a column

inline constexpr std::array<int, 3> linear_modes{1, 2, 4};
inline constexpr std::array<int, 4> hourglass_modes{3, 5, 6, 7};

/// +1 or -1: value of mode m at corner I.
constexpr int mode_sign(int m, int corner) {
  int s = 1;
  for (int bit = 1; bit < 8; bit <<= 1)
    if ((m & bit) && !(corner & bit)) s = -s;
  return s;
}

/// Geometry of one element, exact for any hexahedron with straight edges.
struct HexGeometry {
  double volume;                              ///< [m^3]
  Eigen::Matrix<double, 3, 8> gradient;       ///< B_iI = (1/V) int dN_I/dx_i dV [1/m] (Flanagan and Belytschko 1981)
  Eigen::Matrix<double, 3, 7> mode_gradient;  ///< b_im with mean(df/dx_i) = sum_m b_im f_m, m = 1..7 [1/m]
  Eigen::Matrix<double, 3, 4> hourglass;      ///< X_ia = sum_I h_a(I) x_iI: zero for a parallelepiped [m]
  Eigen::Matrix3d inverse_jacobian;           ///< d xi_k / d x_j at the centre [1/m]
  bool parallelepiped;                        ///< X vanishes to rounding
};

HexGeometry hex_geometry(const Corners& x);

/// Stiffness of the hourglass amplitudes in an elastic element, exact in bending for parallelepipeds:
/// the trilinear strain of the first three modes enhanced by the nine incompatible modes xi_k^2 - 1 of Wilson and
/// Taylor (1973, 1976), which are condensed here face normal by face normal; the fourth mode keeps its normal strains only
/// (after Belytschko and Bindeman 1993, who drop its shear). W = 1/2 q.K q with q the projected mode values
/// q_ca = f_{h_a} - sum_i X_ia df/dx_i, ordered c * 3 + a for the first three modes.
struct HourglassStiffness {
  Eigen::Matrix<double, 9, 9> bending;  ///< modes 3, 5, 6 [N/m]
  Eigen::Matrix3d last;                 ///< mode 7 [N/m]
};
HourglassStiffness hourglass_stiffness(const HexGeometry& g, const LinearElastic& steel);

/// Stiffness over the 21 mode values (component * 7 + mode - 1) [N/m].
using ModeStiffness = Eigen::Matrix<double, 21, 21>;

/// The selectively reduced trilinear element: 2 x 2 x 2 points for the deviator, the mean of the dilatation in each (B-bar,
/// Hughes 1980, Int. J. Numer. Methods Eng. 15, 1413). It locks in bending where the fast element does not, and needs no
/// hourglass control: the check on the fast one.
ModeStiffness b_bar_stiffness(const Corners& x, const LinearElastic& steel);

/// Greatest eigenvalue [1/s^2] times density [kg/m^3] of a steel element against its lumped mass (an upper bound where
/// the element is no parallelepiped). `fixed` are the corners' fixed bits.
double steel_eigenvalue(const HexGeometry& g, const LinearElastic& steel, const HourglassStiffness& k, const std::array<std::uint8_t, 8>& fixed);

/// Greatest eigenvalue divided by c^2 [1/m^2] of a liquid element: 8 sum B^2 over the free directions.
double liquid_eigenvalue(const HexGeometry& g, const std::array<std::uint8_t, 8>& fixed);

/// Hourglass stiffness of a liquid element divided by (coefficient times bulk modulus): V sum B^2 / 8 [m].
double liquid_hourglass(const HexGeometry& g);

}  // namespace calomel
