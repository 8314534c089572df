#include "forward/mechanism/interface.hpp"

#include <algorithm>

#include "base/not_finite.hpp"
#include "forward/mechanism/wall_stretch.hpp"

namespace calomel {

namespace {

/// Any wetted face, those of plates inside as well; or one of the walls.
const std::vector<std::string>& faces() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"all"};
    all.insert(all.end(), wall_names().begin(), wall_names().end());
    return all;
  }();
  return names;
}

void weaken(const MechanismValues& v, const Mesh& mesh, const LoadOptions&, RunSetup& s) {
  const WallThinning stretch = wall_stretch(v, faces());
  if (mesh.slip.empty())
    throw InputError({.problem = "steel and mercury share nodes, so that no face of them can open",
                      .key = "mechanism.interface.strength",
                      .value = number_text(v["strength"]),
                      .suggestion = "set geometry.wetted = \"slip\""});
  const auto pairs = pairs_at_wall(mesh, stretch);
  if (pairs.empty()) throw nothing_there(stretch, "interface");
  s.slip_strength.resize(mesh.slip.size(), infinity);
  s.slip_hold.resize(mesh.slip.size(), 0);
  for (const PairAtWall& p : pairs) {
    // Where the stretch ends within the part of the wall of a pair, the rest of it holds as the mercury does.
    const double rest = p.share < 1 ? (1 - p.share) * s.wetted_cutoff : 0, strength = p.share * v["strength"] + rest;
    if (strength < s.slip_strength[p.pair]) {
      s.slip_strength[p.pair] = strength;
      s.slip_hold[p.pair] = rest;
    }
  }
}

}  // namespace

MechanismEntry interface() {
  std::vector<MechanismKey> keys{{.name = "strength",
                                  .unit = "Pa",
                                  .off = infinity,
                                  .low = 0,
                                  .high = 1.5e5,
                                  .least = 0,
                                  .doc = "tension at which the face opens; shows below the mercury's cutoff alone; inf = holds",
                                  .shows_below = "material.mercury.tensile_cutoff"}};
  for (auto& k : stretch_keys(faces())) keys.push_back(std::move(k));
  return {.law = "a wetted face opens at the normal traction -strength, carries none while open, and closes without rebound",
          .plain = "a wetted wall that the mercury leaves early",
          .check = "look at how well the mercury wets that wall: its surface, oxide, gas at it",
          .keys = std::move(keys),
          .fields = weaken};
}

}  // namespace calomel
