#pragma once
/// A part of a wall, given by the keys `wall`, `begin` and `end` of a mechanism.
#include "forward/mechanism/mechanism.hpp"
#include "forward/mesh/deform_mesh.hpp"

namespace calomel {

/// front, rear, side, top, bottom: the direction of the largest component of the outer normal.
const std::vector<std::string>& wall_names();

/// The keys `wall` (one of `walls`, by default the first), `begin` and `end` [m] (by default 0 and 1 m, the whole wall).
std::vector<MechanismKey> stretch_keys(const std::vector<std::string>& walls);

/// The part of the wall that the keys give. Errors: InputError if begin is not below end.
WallThinning wall_stretch(const MechanismValues& v, const std::vector<std::string>& walls);

/// The error for a part of a wall without a wetted face.
InputError nothing_there(const WallThinning& stretch, const std::string& mechanism);

}  // namespace calomel
