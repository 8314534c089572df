#pragma once
/// Sub-cycling: mercury away from the steel takes one step where the steel takes several (impulse method; docs/theory/forward.md).
/// Which elements do depends on the mesh alone, how many steps on the stable steps and the cost.
#include <cstdint>
#include <vector>

#include "forward/mesh/mesh.hpp"

namespace calomel {

struct Layout;

inline constexpr int no_subcycles = -1;            ///< in place of a number of layers
inline constexpr int default_subcycle_buffer = 1;  ///< layers of mercury beside the steel that take every step

/// Greatest stable steps [s].
struct StableSteps {
  double whole = 0;   ///< of everything
  double liquid = 0;  ///< of the liquid alone; 0: not requested
};

/// How an output interval is divided.
struct Stepping {
  int per_output = 1;  ///< steps, a multiple of `subcycles`
  int subcycles = 1;   ///< of them in a step of the slow elements
  double work = 1;     ///< estimated share of the work that these steps would take with every element in each
};

/// Per element: 1 where it takes long steps, that is mercury with at least `buffer` layers of elements between it and steel, slip pairs,
/// the rear and the loaded face; 0 elsewhere.
std::vector<std::uint8_t> slow_elements(const Mesh& mesh, int buffer);

/// The cheapest division with 1 to `most` sub-cycles by `block_cost`, the fewer sub-cycles of two alike. `least`, `least_slow`: steps
/// that an output interval needs at least, of all elements and of the liquid alone.
Stepping cheapest_stepping(const Layout& layout, bool own_law, int least, int least_slow, int most);

}  // namespace calomel
