#include "forward/line/lateral_inertia.hpp"
#include "forward/line/line_mechanism.hpp"
#include "forward/line/line_sensor_response.hpp"
#include "forward/line/unsteady_friction.hpp"
#include "forward/line/vapour_cutoff.hpp"
#include "forward/line/viscous_attenuation.hpp"
#include "forward/line/wall_viscoelasticity.hpp"

namespace calomel {

namespace {

void add(Registry<LineMechanismEntry>& r, const char* name, LineMechanismEntry entry) {
  const std::string law = entry.law;
  r.add(name, law, std::move(entry));
}

}  // namespace

const Registry<LineMechanismEntry>& bar_mechanisms() {
  static const Registry<LineMechanismEntry> all = [] {
    Registry<LineMechanismEntry> r("mechanism of a bar");
    add(r, "lateral_inertia", lateral_inertia());
    add(r, "viscous_attenuation", viscous_attenuation());
    add(r, "sensor_response", line_sensor_response({.lag_low = 1e-7, .lag_high = 1e-4, .pass_low = 5e3, .pass_high = 500e3}));
    return r;
  }();
  return all;
}

const Registry<LineMechanismEntry>& pipe_mechanisms() {
  static const Registry<LineMechanismEntry> all = [] {
    Registry<LineMechanismEntry> r("mechanism of a pipe");
    add(r, "vapour_cutoff", vapour_cutoff());
    add(r, "unsteady_friction", unsteady_friction());
    add(r, "wall_viscoelasticity", wall_viscoelasticity());
    add(r, "sensor_response", line_sensor_response({.lag_low = 1e-4, .lag_high = 1e-1, .pass_low = 5, .pass_high = 5e3}));
    return r;
  }();
  return all;
}

const Registry<LineMechanismEntry>& line_mechanisms(const std::string& kind) { return kind == "bar" ? bar_mechanisms() : pipe_mechanisms(); }

}  // namespace calomel
