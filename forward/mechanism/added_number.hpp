#pragma once
/// A key of a mechanism as a number that a diagnosis may add to a model.
#include "forward/mechanism/mechanism.hpp"
#include "forward/parameter_group.hpp"

namespace calomel {

/// A key of a mechanism as a number that may be added; `off`: its off value in the case. Its prior is normal about off, the range of the registry two standard
/// deviations of it, and ends at twice that range or where the law does; half-Cauchy about the geometric middle of a log-uniform range, uniform in the inverse
/// of one that is infinite where it is off. `whole`: of a key with `shows_below`, that number, of which it is then a uniform share.
[[nodiscard]] AddedParameter added_number(const std::string& mechanism, const MechanismKey& key, double off, double whole = 1);

}  // namespace calomel
