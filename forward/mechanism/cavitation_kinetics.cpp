#include "forward/mechanism/cavitation_kinetics.hpp"

#include <algorithm>
#include <cmath>

namespace calomel {

void KineticLiquid::advance(const LiquidPoints& points) const {
  const double k = liquid_.bulk_modulus, dt = points.dt, lag = dt > 0 ? liquid_.viscosity / (k * dt) : 0;
  const auto left = [dt](double tau) { return tau > 0 ? std::exp(-dt / tau) : 0; };  // of a difference after the step
  const double after_growth = left(growth_time_), after_collapse = left(collapse_time_);
  const double cutoff = std::min(liquid_.tensile_cutoff, 1e30);  // finite, so that mercury which never gives way needs no case of its own
  for (std::size_t i = 0; i < points.count; ++i) {
    const double stretch = points.strain[i] + lag * (points.strain[i] - points.strain_before[i]) - points.heating[i] / k, x = stretch - cutoff / k, alpha = points.state[i];
    const double now = std::max(0.0, x + (alpha - x) * (x > alpha ? after_growth : after_collapse));
    points.state[i] = now;
    points.pressure[i] = now > 0 ? -cutoff - k * (x - now) : -k * stretch;  // the cutoff itself, to the bit, where the void is as large as it would be
  }
}

namespace {

void slow_walls(const MechanismValues& v, RunSetup& s) { s.parting_time = v["growth_time"], s.meeting_time = v["collapse_time"]; }

std::shared_ptr<const LiquidLaw> liquid(const MechanismValues& v, const RunSetup& s) { return std::make_shared<KineticLiquid>(s.liquid, v["growth_time"], v["collapse_time"]); }

MechanismKey time_constant(const char* name, const char* doc) { return {.name = name, .unit = "s", .off = 0, .low = 0.05e-6, .high = 200e-6, .log_uniform = true, .least = 0, .greatest = 1, .doc = doc}; }

}  // namespace

MechanismEntry cavitation_kinetics() {
  return {.law = "p = p0 - K (e_v - alpha) - eta de_v/dt, the void alpha following the stretch beyond the cutoff with a time constant",
          .plain = "voids in the mercury that take time to open and close",
          .check = "see whether other records of the same mercury ask for the same time constants",
          .keys = {time_constant("growth_time", "of a void that grows: so long the mercury holds more than its cutoff"), time_constant("collapse_time", "of a void that closes")},
          .like_the_mesh = true,
          .cost = 1.2,
          .setup = slow_walls,
          .liquid = liquid};
}

}  // namespace calomel
