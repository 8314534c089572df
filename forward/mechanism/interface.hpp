#pragma once
/// A wetted face that holds less than the mercury does: it opens at the normal traction `strength` (tension), carries none while open, and closes without rebound when the gap is
/// gone. The wall is then no longer pulled back beyond that. Off: strength infinite (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry interface();

}  // namespace calomel
