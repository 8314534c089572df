#include "forward/mechanism/beam_profile.hpp"
#include "forward/mechanism/bubbly_liquid.hpp"
#include "forward/mechanism/cavitation_kinetics.hpp"
#include "forward/mechanism/interface.hpp"
#include "forward/mechanism/liquid_viscosity.hpp"
#include "forward/mechanism/mechanism.hpp"
#include "forward/mechanism/nonlinear_eos.hpp"
#include "forward/mechanism/previous_pulses.hpp"
#include "forward/mechanism/rear_reflection.hpp"
#include "forward/mechanism/sensor_response.hpp"
#include "forward/mechanism/static_pressure.hpp"
#include "forward/mechanism/structural_damping.hpp"
#include "forward/mechanism/thermal_stress.hpp"
#include "forward/mechanism/wall_thinning.hpp"

namespace calomel {

const Registry<MechanismEntry>& mechanisms() {
  static const Registry<MechanismEntry> all = [] {
    Registry<MechanismEntry> r("mechanism");
    const auto add = [&r](const char* name, MechanismEntry entry) {
      const std::string law = entry.law;
      r.add(name, law, std::move(entry));
    };
    add("bubbly_liquid", bubbly_liquid());
    add("cavitation_kinetics", cavitation_kinetics());
    add("liquid_viscosity", liquid_viscosity());
    add("structural_damping", structural_damping());
    add("nonlinear_eos", nonlinear_eos());
    add("thermal_stress", thermal_stress());
    add("beam_profile", beam_profile());
    add("previous_pulses", previous_pulses());
    add("rear_reflection", rear_reflection());
    add("interface", interface());
    add("sensor_response", sensor_response());
    add("wall_thinning", wall_thinning());
    add("static_pressure", static_pressure());
    return r;
  }();
  return all;
}

}  // namespace calomel
