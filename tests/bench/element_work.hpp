#pragma once
/// Arithmetic and traffic of one step of the explicit solver, by element and node.
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "forward/mesh/mesh.hpp"
#include "forward/solver/kernel.hpp"

namespace calomel {

/// Additions, multiplications and divisions of real numbers in one element's step without an energy balance and without memory of its rate (12 more in a liquid
/// that closes inelastically), one each; comparisons, changes of sign and what is known before the run count nothing. Found by running the element code of the
/// kernels on numbers that count, so it is the work that is requested, whatever the compiler makes of it.
struct ElementWork {
  int to_modes = 0;    ///< displacements of the corners to modes
  int gradients = 0;   ///< modes to displacement gradients
  int law = 0;         ///< strain, and pressure or stress times volume
  int hourglass = 0;   ///< amplitudes, their forces, and their share in the mean stress
  int spread = 0;      ///< stress to forces on the modes
  int to_corners = 0;  ///< forces on the modes to corners, and their sum with what the nodes have
  [[nodiscard]] int total() const { return to_modes + gradients + law + hourglass + spread + to_corners; }
};
ElementWork element_work(bool liquid, Form form);

/// The same of a node: u + beta v (the regularising viscosity costs no more), v += kick f / m, u += dt v. What slip, the rear face and the sums over blocks add
/// is left out.
inline constexpr int node_viscosity_work = 3 * 2, node_advance_work = 1 + 3 * 4;

/// What an element of a mesh costs in the mean.
struct MeshWork {
  double flops = 0;  ///< an element-step, nodes included
  double bytes = 0;  ///< that it must move at least: geometry, connectivity, and its share of node rows read and written
};

/// `real`: bytes of a number. `runs`: eight runs in the lanes, which share geometry and connectivity.
MeshWork mesh_work(const Mesh& mesh, std::size_t real, bool runs);

}  // namespace calomel
