#include "forward/mechanism/wall_thinning.hpp"

#include "forward/mechanism/wall_stretch.hpp"

namespace calomel {

namespace {

void thin(const MechanismValues& v, Mesh& mesh) {
  WallThinning stretch = wall_stretch(v, wall_names());
  stretch.fraction = v["fraction"];
  if (pairs_at_wall(mesh, stretch).empty() && !mesh.slip.empty()) throw nothing_there(stretch, "wall_thinning");
  thin_wall(mesh, stretch);
}

}  // namespace

MechanismEntry wall_thinning() {
  std::vector<MechanismKey> keys{
      {.name = "fraction", .unit = "", .off = 0, .low = 0, .high = 0.5, .least = 0, .greatest = 0.9, .doc = "of the thickness that is gone"}};
  for (auto& k : stretch_keys(wall_names())) keys.push_back(std::move(k));
  return {.law = "h -> h (1 - fraction) from inside, over a stretch of a wall",
          .plain = "a wall that is thinner than drawn",
          .check = "measure the thickness of that wall",
          .keys = std::move(keys),
          .cost = 1.4,
          .mesh = thin};
}

}  // namespace calomel
