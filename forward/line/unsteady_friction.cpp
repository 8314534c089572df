#include "forward/line/unsteady_friction.hpp"

namespace calomel {

LineMechanismEntry unsteady_friction() {
  return {.law = "(16 mu / D^2) int dV/dt W of the past of the velocity, W = exp(-B t) / (2 sqrt(pi t)) of Vardy and Brown",
          .keys = {{.name = "strength", .unit = "", .off = 0, .low = 0, .high = 2, .least = 0, .greatest = 100, .doc = "share of Vardy and Brown's"}},
          .plain = "friction that grows where the flow changes fast",
          .check = "see whether the flow was laminar or turbulent and how rough the pipe is",
          .pipe = [](const MechanismValues& v, PipeSetup& s) { s.unsteady_friction = v["strength"]; }};
}

}  // namespace calomel
