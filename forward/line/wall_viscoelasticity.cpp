#include "forward/line/wall_viscoelasticity.hpp"

namespace calomel {

LineMechanismEntry wall_viscoelasticity() {
  return {.law = "dp/dt + rho a^2 dV/dx + dq/dt = 0, tau dq/dt + q = chi (p - p_steady): retarded strain of the wall",
          .keys = {{.name = "compliance",
                    .unit = "",
                    .off = 0,
                    .low = 1e-3,
                    .high = 0.3,
                    .log_uniform = true,
                    .least = 0,
                    .greatest = 100,
                    .doc = "chi, retarded compliance over the line's elastic one"},
                   {.name = "time",
                    .unit = "s",
                    .off = 0.02,
                    .low = 1e-3,
                    .high = 1,
                    .log_uniform = true,
                    .decides = false,
                    .least = 1e-9,
                    .doc = "tau, time of retardation"}},
          .plain = "a pipe wall that yields with a delay",
          .check = "find out the material and the supports of the pipe; metal walls respond at once",
          .pipe = [](const MechanismValues& v, PipeSetup& s) { s.retarded_compliance = v["compliance"], s.retardation_time = v["time"]; }};
}

}  // namespace calomel
