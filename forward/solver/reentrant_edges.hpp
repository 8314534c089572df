#pragma once
/// Inner corners of the steel, where finite elements lose an order of convergence, and what restores it.
#include <cstdint>
#include <vector>

#include "forward/mesh/mesh.hpp"

namespace calomel {

/// Share by which the stiffness of the steel elements at a re-entrant edge of 270 degrees is lowered.
///
/// At such an edge the stress grows as r^(0.544 - 1) (Williams 1952), so that any standard element is too stiff by an energy
/// of order h^1.09 and everything that bends the corner, however far off, converges at first order only. Lowering the
/// stiffness of the elements that touch the edge by a fixed share, the same for every h, takes that term away (Egger,
/// Ruede and Wohlmuth, Energy-corrected finite element methods for corner singularities, SIAM J. Numer. Anal. 52, 2014).
/// The share belongs to the element and the angle; 0.18 was found with this element, square around the edge, nu = 0.29,
/// from the first frequency of a free L-shaped frame alone (docs/verification).
inline constexpr double reentrant_softening = 0.18;

/// Per mesh element: 1 for a steel element with an edge around which the steel fills 270 degrees to within 20. An edge that
/// lies in a symmetry plane is judged by the modelled part only.
std::vector<std::uint8_t> reentrant_elements(const Mesh& mesh);

}  // namespace calomel
