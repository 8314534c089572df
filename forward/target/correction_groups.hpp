#pragma once
/// The terms and places by which a diagnosis describes what is missing.
#include "forward/parameter_group.hpp"

namespace calomel {

struct ForwardCase;

/// Each term at each place as a group of one number, of a correction of its own, so that several may act in one run. The mercury as a whole and, of a box, in
/// thirds of its length and along each wall; each wall there is and, of a box, its quarters.
[[nodiscard]] std::vector<ParameterGroup> correction_groups(const ForwardCase& forward_case);

}  // namespace calomel
