#include "forward/mechanism/static_pressure.hpp"

namespace calomel {

namespace {

void shift_cutoff(const MechanismValues& v, RunSetup& s) { s.liquid.tensile_cutoff += v["pressure"], s.wetted_cutoff += v["pressure"]; }

}  // namespace

MechanismEntry static_pressure() {
  return {.law = "the effective cutoff is sigma_c + p_s",
          .plain = "a static pressure on the mercury",
          .check = "read the pressure of the cover gas and the height of the mercury above the target during these pulses",
          .keys = {{.name = "pressure",
                    .unit = "Pa",
                    .off = 0,
                    .low = 0,
                    .high = 4e5,
                    .least = 0,
                    .doc = "p_s, added to the tensile cutoff: no strain distinguishes the two, only their sum"}},
          .setup = shift_cutoff};
}

}  // namespace calomel
