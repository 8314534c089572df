#pragma once
#include <array>
#include <string>

#include "base/options.hpp"

namespace calomel {

/// `[[sensor]]`: a strain gauge and the constants of its channel.
struct SensorOptions {
  std::string name;
  std::array<double, 3> position{};
  std::array<double, 3> direction{};
  double gauge_length = 0;
  double gain = 1;
  double delay = 0;
  double max_distance = 0.005;
  std::string placement = "surface";

  template <class V>
  void visit(V& v) {
    v("name", name, {.doc = "name, as in the recordings", .required = true});
    v("position", position, {.unit = "m", .doc = "place on the outer surface (x, y, z)", .required = true});
    v("direction", direction, {.doc = "direction of the strain, made tangential and of length 1", .required = true});
    v("gauge_length", gauge_length, {.unit = "m", .range = at_least(0), .doc = "length over which the strain is averaged; 0 = at the point"});
    v("gain", gain, {.doc = "reading per true strain"});
    v("delay", delay, {.unit = "s", .doc = "by which the reading lags the strain"});
    v("max_distance", max_distance,
      {.unit = "m", .range = at_least(0), .doc = "a position farther from the outer surface is refused, a nearer one moved to it"});
    v("placement", placement,
      {.doc = "strain of the outer surface, or of the element below at its centre (shows less bending)", .choices = {"surface", "element_centre"}});
  }
  /// Errors: InputError when the name is empty or the direction zero.
  void validate() const {
    if (name.empty()) throw InputError({.problem = "a sensor needs a name", .key = "name", .value = "\"\""});
    if (direction[0] == 0 && direction[1] == 0 && direction[2] == 0)
      throw InputError({.problem = "the direction of sensor \"" + name + "\" has no length", .key = "direction", .value = "[0, 0, 0]"});
  }
};

}  // namespace calomel
