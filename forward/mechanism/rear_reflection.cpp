#include "forward/mechanism/rear_reflection.hpp"

namespace calomel {

MechanismEntry rear_reflection() {
  return {.law = "(1 - r) p' = (1 + r) rho c v_n at the rear face",
          .plain = "waves that come back from the rear end",
          .check = "look at the structure behind the modelled part, whose rear end absorbs every wave in the simulation",
          .keys = {{.name = "coefficient",
                    .unit = "",
                    .off = 0,
                    .low = -1,
                    .high = 1,
                    .least = -1,
                    .greatest = 1,
                    .doc = "r, the share of the pressure that comes back"}},
          .needs_rear = true,
          .setup = [](const MechanismValues& v, RunSetup& s) { s.rear_coefficient = v["coefficient"]; }};
}

}  // namespace calomel
