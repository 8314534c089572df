#pragma once
/// What is left of the pulses before this one: the target still moves when the record starts, and the gauges are set to zero there. The run starts from
///   u = sum_k a_k u_k,   v = sum_k a_k v_k,
/// (u_k, v_k) the 64 states of LeftStates: what one pulse leaves at 64 times after the record's end, by the model itself with every other mechanism. All that
/// the pulse then does it does in a target that moves: mercury gives way elsewhere, and where it has, the walls go on without it. Off: all a_k 0. (physics.md
/// section 3 adds modes to the histories; in mercury that gives way the records differ from that sum by as much as the effect, docs/theory/mechanisms.md.)
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry previous_pulses();

}  // namespace calomel
