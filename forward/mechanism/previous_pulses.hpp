#pragma once
/// Motion that earlier pulses left in the target: it still moves when the record starts, and the gauges are set to zero there. The run starts from
///   u = sum_k a_k u_k,   v = sum_k a_k v_k,
/// where (u_k, v_k) are the 64 states of LeftStates: the motion that one pulse leaves at 64 times after the end of the record, computed by the model with all
/// other enabled mechanisms. The motion changes the response to the pulse, because mercury cavitates at other places and the walls are then free there. A sum
/// of modes added to the histories would neglect this interaction, which is as large as the effect (docs/theory/mechanisms.md). Off: all a_k are 0.
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry previous_pulses();

}  // namespace calomel
