#include "forward/mechanism/liquid_viscosity.hpp"

namespace calomel {

MechanismEntry liquid_viscosity() {
  return {
      .law = "zeta is added to the regularising viscosity",
      .plain = "losses in the mercury",
      .check =
          "find out what could damp waves in the mercury, such as fine bubbles, and repeat the diagnosis on a finer mesh, because a coarse one damps them too",
      .keys = {{.name = "zeta",
                .unit = "Pa s",
                .off = 0,
                .low = 1,
                .high = 1e4,
                .log_uniform = true,
                .least = 0,
                .doc = "viscosity on top of the regularising one"}},
      .like_the_mesh = true,
      .setup = [](const MechanismValues& v, RunSetup& s) { s.liquid.viscosity += v["zeta"]; }};
}

}  // namespace calomel
