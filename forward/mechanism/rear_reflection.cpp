#include "forward/mechanism/rear_reflection.hpp"

namespace calomel {

namespace {

void expect_rear(const MechanismValues& v, const Mesh& mesh, const LoadOptions&, RunSetup&) {
  if (v["coefficient"] != 0 && mesh.rear.empty())
    throw InputError({.problem = "the target has no rear face that swallows waves, so that nothing changes with what it sends back", .key = "mechanism.rear_reflection.coefficient",
                      .value = number_text(v["coefficient"]), .suggestion = "set geometry.rear = \"non_reflecting\" (a mesh from a file: geometry.sets.rear), or remove the mechanism"});
}

}  // namespace

MechanismEntry rear_reflection() {
  return {.law = "(1 - r) p' = (1 + r) rho c v_n at the rear face",
          .plain = "waves that come back from the rear end",
          .check = "look at what stands behind the modelled part, whose rear end swallows every wave in the simulation",
          .keys = {{.name = "coefficient", .unit = "", .off = 0, .low = -1, .high = 1, .least = -1, .greatest = 1, .doc = "r, the share of the pressure that comes back"}},
          .needs_rear = true,
          .setup = [](const MechanismValues& v, RunSetup& s) { s.rear_coefficient = v["coefficient"]; },
          .fields = expect_rear};
}

}  // namespace calomel
