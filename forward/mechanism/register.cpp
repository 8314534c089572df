#include <limits>

#include "forward/mechanism/mechanism.hpp"

namespace calomel {

namespace {
constexpr double none = std::numeric_limits<double>::infinity();

struct Switch {
  bool enabled = false;
  template <class V>
  void visit(V& v) {
    v("enabled", enabled, {.doc = "part of the base model"});
  }
};
}

const Registry<MechanismEntry>& mechanisms() {
  static const Registry<MechanismEntry> all = [] {
    Registry<MechanismEntry> r("mechanism");
    const auto add = [&r](const char* name, const char* law, std::vector<MechanismKey> keys) { r.add(name, law, {law, std::move(keys), false}); };
    add("bubbly_liquid", "p = max(p0 - K (e_v - alpha + alpha0), -sigma_c), alpha = alpha0 (R/R0)^3 by Keller and Miksis",
        {{"alpha0", "", 0, 1e-5, 1e-2, true}, {"radius", "m", 1e-4, 1e-5, 5e-4, true}, {"ambient_pressure", "Pa", 1e5, 1e5, 4e5}, {"polytropic", "", 1.16, 1, 1.67}, {"thermal_viscosity", "Pa s", 0.5, 0, 10}});
    add("cavitation_kinetics", "the void grows and collapses with time constants", {{"growth_time", "s", 0, 0, 200e-6}, {"collapse_time", "s", 0, 0, 200e-6}});
    add("liquid_viscosity", "zeta is added to the regularising viscosity", {{"zeta", "Pa s", 0, 1, 1e4, true}});
    add("structural_damping", "Rayleigh damping a M + b K of the steel", {{"mass", "1/s", 0, 0, 1e4}, {"stiffness", "s", 0, 0, 1e-6}});
    add("nonlinear_eos", "p = (K/m) ((1 - e)^m - 1) of Tait's form", {{"exponent", "", 1, 1, 14}});
    add("thermal_stress", "sigma = C : (e - a dT) in the heated steel", {{"delta_t", "K", 0, 0, 2}, {"decay", "m", 0.05, 0.02, 0.1}});
    add("beam_profile", "offset, width, strength and length of the pulse",
        {{"offset_y", "m", 0, -5e-3, 5e-3}, {"offset_z", "m", 0, -5e-3, 5e-3}, {"width_ratio_y", "", 1, 0.85, 1.15}, {"width_ratio_z", "", 1, 0.85, 1.15}, {"energy_ratio", "", 1, 0.97, 1.03}, {"pulse_length", "s", 0.7e-6, 0, 2e-6}});
    add("previous_pulses", "ring-down of earlier pulses in up to 8 wet modes", {{"amplitude", "", 0, -1, 1}});
    add("rear_reflection", "(1 - r) p' = (1 + r) rho c v_n at the rear face", {{"coefficient", "", 0, -1, 1}});
    add("interface", "a wetted face opens at a normal traction and closes without rebound", {{"strength", "Pa", none, 0, 1.5e6}, {"begin", "m", 0, 0, 1}, {"end", "m", 1, 0, 1}});
    add("sensor_response", "gain, low pass, delay, angle, transverse part and offset of each gauge",
        {{"gain", "", 1, 0.85, 1.15}, {"low_pass", "Hz", none, 20e3, 500e3}, {"delay", "s", 0, -2e-6, 2e-6}, {"angle", "deg", 0, -10, 10}, {"transverse", "", 0, -0.05, 0.05}, {"offset", "", 0, -1e-4, 1e-4}});
    add("wall_thinning", "a wall is thinner from inside over a stretch", {{"fraction", "", 0, 0, 0.5}, {"begin", "m", 0, 0, 1}, {"end", "m", 1, 0, 1}});
    add("static_pressure", "a cover pressure shifts the effective cutoff", {{"pressure", "Pa", 0, 0, 4e5}});
    return r;
  }();
  return all;
}

std::vector<std::string> read_mechanisms(CaseFile& file) {
  std::vector<std::string> notes;
  file.accept("mechanism");
  for (const auto& name : file.names("mechanism")) {
    const std::string path = "mechanism." + name;
    const MechanismEntry& entry = file.locating([&]() -> const MechanismEntry& {
      try {
        return mechanisms().get(name, path);
      } catch (const InputError& e) {
        auto parts = e.parts();
        parts.value.clear();
        throw InputError(parts);
      }
    });
    std::vector<std::string> known{"enabled", "wall", "parameter"};
    for (const auto& k : entry.keys) known.push_back(k.name);
    for (const auto& key : file.names(path))
      if (std::find(known.begin(), known.end(), key) == known.end())
        throw file.located(InputError({.problem = "unknown key of this mechanism", .key = path + '.' + key, .range = join(known), .suggestion = "did you mean \"" + nearest_name(key, known) + "\"?"}));
    Switch on;
    known.erase(known.begin());
    file.read(path, on, known);
    if (on.enabled && !entry.built)
      throw file.located(InputError({.problem = "this mechanism is not built yet in this version, so it cannot be enabled",
                                     .key = path + ".enabled",
                                     .value = "true",
                                     .suggestion = "remove the line; a listed mechanism without it is accepted"}));
    if (!entry.built) notes.push_back("mechanism." + name + ": not built yet, not offered");
  }
  return notes;
}

}  // namespace calomel
