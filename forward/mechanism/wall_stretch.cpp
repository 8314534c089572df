#include "forward/mechanism/wall_stretch.hpp"

#include "forward/mechanism/correction.hpp"

namespace calomel {

const std::vector<std::string>& wall_names() {
  static const std::vector<std::string> names{"front", "rear", "side", "top", "bottom"};
  return names;
}

std::vector<MechanismKey> stretch_keys(const std::vector<std::string>& walls) {
  return {{.name = "wall",
           .off = 0,
           .low = 0,
           .high = double(walls.size() - 1),
           .decides = false,
           .doc = "by where its outer side points: front towards the beam, side across, top up",
           .choices = walls},
          {.name = "begin",
           .unit = "m",
           .off = -anywhere,
           .low = 0,
           .high = 1,
           .decides = false,
           .doc = "of the stretch along x; along z for front and rear. All of the wall unless set"},
          {.name = "end", .unit = "m", .off = anywhere, .low = 0, .high = 1, .decides = false, .doc = "of the stretch"}};
}

WallThinning wall_stretch(const MechanismValues& v, const std::vector<std::string>& walls) {
  if (!(v["begin"] < v["end"]))
    throw InputError({.problem = "the stretch of the wall ends where it begins or before",
                      .key = "end",
                      .value = number_text(v["end"]),
                      .range = "> begin = " + number_text(v["begin"])});
  return {.wall = walls.at(std::size_t(v["wall"])), .begin = v["begin"], .end = v["end"]};
}

InputError nothing_there(const WallThinning& stretch, const std::string& mechanism) {
  const std::string axis = stretch.wall == "front" || stretch.wall == "rear" ? "z = " : "x = ", begin = number_text(stretch.begin),
                    end = number_text(stretch.end);
  const bool from = stretch.begin > -anywhere, to = stretch.end < anywhere;
  return InputError({.problem = "the target has no wetted face of this wall" + (from && to ? " between " + axis + begin + " and " + end + " m"
                                                                                : from     ? " beyond " + axis + begin + " m"
                                                                                : to       ? " before " + axis + end + " m"
                                                                                           : ""),
                     .key = "mechanism." + mechanism + ".wall",
                     .value = '"' + stretch.wall + '"',
                     .suggestion = "name a wall between mercury and outside, and a stretch of it"});
}

}  // namespace calomel
