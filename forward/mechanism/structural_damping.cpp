#include "forward/mechanism/structural_damping.hpp"

namespace calomel {

MechanismEntry structural_damping() {
  return {.law = "Rayleigh damping a M + b K of the steel",
          .plain = "damping of the steel structure",
          .check = "hold the damping against the ring-down of the vessel, and look at its joints and supports",
          .keys = {{.name = "mass", .unit = "1/s", .off = 0, .low = 0, .high = 1e4, .least = 0, .doc = "a: damps slow motion, also of a rigid body"},
                   {.name = "stiffness", .unit = "s", .off = 0, .low = 0, .high = 1e-6, .least = 0, .doc = "b: damps fast modes; shortens the stable step"}},
          .like_the_mesh = true,
          .cost = 2.2,
          .setup = [](const MechanismValues& v, RunSetup& s) { s.steel_mass_damping += v["mass"], s.steel_stiffness_damping += v["stiffness"]; }};
}

}  // namespace calomel
