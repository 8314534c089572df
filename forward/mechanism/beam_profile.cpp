#include "forward/mechanism/beam_profile.hpp"

namespace calomel {

namespace {

void change_source(const MechanismValues& v, const Mesh&, LoadOptions& load) {
  auto& p = load.profile;
  p.center[0] += v["offset_y"];
  p.center[1] += v["offset_z"];
  p.widths[0] *= v["width_ratio_y"];
  p.widths[1] *= v["width_ratio_z"];
  load.factor *= v["energy_ratio"];
  load.pulse_length = v["pulse_length"];
}

MechanismKey ratio(const char* name, double low, double high, const char* doc) {
  return {.name = name, .unit = "", .off = 1, .low = low, .high = high, .least = 0.01, .greatest = 100, .doc = doc};
}

}  // namespace

MechanismEntry beam_profile() {
  return {.law = "offset, width, strength and length of the pulse",
          .plain = "the proton beam's profile",
          .check = "compare the beam's position, width, charge and length with the readings of the beam monitors during these pulses",
          .keys = {{.name = "offset_y",
                    .unit = "m",
                    .off = 0,
                    .low = -5e-3,
                    .high = 5e-3,
                    .off_centre = 1,
                    .doc = "of the axis, sideways; not in a model that is mirrored along y"},
                   {.name = "offset_z",
                    .unit = "m",
                    .off = 0,
                    .low = -5e-3,
                    .high = 5e-3,
                    .off_centre = 2,
                    .doc = "of the axis, upwards; not in a model that is mirrored along z"},
                   ratio("width_ratio_y", 0.85, 1.15, "of the width along y to the one in [load]"),
                   ratio("width_ratio_z", 0.85, 1.15, "of the width along z to the one in [load]"),
                   ratio("energy_ratio", 0.97, 1.03, "of the heating pressure everywhere to the one that the widths and [load] give"),
                   {.name = "pulse_length",
                    .unit = "s",
                    .off = LoadOptions{}.pulse_length,
                    .low = 0,
                    .high = 4e-6,
                    .least = 0,
                    .greatest = 1e-3,
                    .doc = "in place of the one in [load]",
                    .off_at = "load.pulse_length"}},
          .load = change_source};
}

}  // namespace calomel
