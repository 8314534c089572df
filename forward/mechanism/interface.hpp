#pragma once
/// A wetted face that holds less than the mercury does: it opens at the normal traction `strength` (tension), carries none while open, and closes without
/// rebound when the gap is gone. The wall is then no longer pulled back beyond that. A pair of nodes that the stretch covers in part opens at, and holds, the
/// covered share of this and the rest of the mercury's cutoff. Off: strength infinite (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry interface();

}  // namespace calomel
