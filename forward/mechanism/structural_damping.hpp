#pragma once
/// Damping of the steel, C = mass M + stiffness K (Rayleigh): the ratio of a mode of angular frequency w is zeta = (mass / w + stiffness w) / 2. Beside it the
/// ratio `loss` that changes little over a decade about `frequency`, by three Maxwell branches of one share m at 1/5, 1 and 5 times that, of times t_k:
///   loss factor 2 zeta = sum m w t_k / (1 + (w t_k)^2),   stiffness K (1 + sum m (w t_k)^2 / (1 + (w t_k)^2)).
/// Off: mass, stiffness and loss 0 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry structural_damping();

}  // namespace calomel
