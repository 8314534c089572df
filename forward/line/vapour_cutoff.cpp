#include "forward/line/vapour_cutoff.hpp"

namespace calomel {

LineMechanismEntry vapour_cutoff() {
  return {.law =
              "p >= p_v: vapour cavities open at the nodes and close again, d(volume)/dt = area (V_downstream - V_upstream); with free gas (p - p_v) volume is "
              "constant",
          .keys = {{.name = "pressure",
                    .unit = "Pa",
                    .off = -std::numeric_limits<double>::infinity(),
                    .low = -101e3,
                    .high = -80e3,
                    .greatest = 1e9,
                    .doc = "vapour pressure over the atmosphere's; water at 20 C: -99e3"},
                   {.name = "gas_fraction",
                    .unit = "",
                    .off = 0,
                    .low = 1e-8,
                    .high = 1e-5,
                    .log_uniform = true,
                    .decides = false,
                    .least = 0,
                    .greatest = 0.01,
                    .doc = "free gas over the volume, at the steady pressure; 0 = vapour alone"}},
          .plain = "vapour in the pipe where the pressure falls too far",
          .check = "compare the lowest pressure with the vapour pressure of the liquid, and find out how much gas it contained",
          .pipe = [](const MechanismValues& v, PipeSetup& s) { s.vapour_pressure = v["pressure"], s.gas_fraction = v["gas_fraction"]; }};
}

}  // namespace calomel
