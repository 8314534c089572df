#pragma once
/// What added runs teach a search: its surrogate set right, and the mesh's error.
#include "inverse/map_search.hpp"

namespace calomel {

/// Puts into `current`, on which `search` works, what `runs` tell beyond `models`: with two or more that came through the surrogate is set right at them
/// (RefinedModel), with two or more pairs their differences make the MeshError. Runs where the surrogate of `models` has no values are left out.
void teach(MapModels& current, const MapModels& models, const std::vector<AddedRun>& runs, const MapSearch& search);

}  // namespace calomel
