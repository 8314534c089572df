#pragma once
/// Part of a wall, as the keys `wall`, `begin` and `end` of a mechanism name it.
#include "forward/mechanism/mechanism.hpp"
#include "forward/mesh/deform_mesh.hpp"

namespace calomel {

/// front, rear, side, top, bottom: where the outer normal's largest component points.
const std::vector<std::string>& wall_names();

/// The keys `wall` (one of `walls`, by default the first), `begin` and `end` (by default 0 and 1 m: all of it).
std::vector<MechanismKey> stretch_keys(const std::vector<std::string>& walls);

/// What those keys say. Errors: InputError where begin is not below end.
WallThinning wall_stretch(const MechanismValues& v, const std::vector<std::string>& walls);

/// The error of a stretch that holds no wetted face.
InputError nothing_there(const WallThinning& stretch, const std::string& mechanism);

}  // namespace calomel
