#pragma once
/// The mechanisms and numbers that a diagnosis may add to a target.
#include <vector>

#include "forward/parameter_group.hpp"

namespace calomel {

struct ForwardCase;
struct Mesh;

/// What can be added to the case's model: the built mechanisms that it lists without enabling, or all built ones where it lists none, then the solver's own
/// numbers. A mechanism with several laws is one group for each. A mechanism of a wall is one group for each wall and, of a box, for each quarter of it, each
/// half a quarter on; where it begins and ends are shapes of it, normal about there with a quarter of its length as standard deviation (of a whole wall an
/// eighth), as far as the wall reaches. The prior of another shape is lognormal, its range two deviations either way. What breaks a symmetry that the mesh is
/// cut by is not offered.
[[nodiscard]] std::vector<ParameterGroup> offered_groups(const ForwardCase& forward_case, const Mesh& mesh);

}  // namespace calomel
