#pragma once
/// Mercury that gives way below a tensile cutoff (Riemer 2005, as quoted by Radaideh et al., section 2.2):
///   p = max(p0 - K e_v - eta de_v/dt, -sigma_c),  K = rho c^2,
/// pressure p [Pa] positive in compression, volumetric strain e_v [-] positive in expansion, no shear, reversible:
/// when e_v comes back the ordinary equation of state resumes. eta is inside the max(), so the law is monotone and
/// the viscosity can only dissipate.
#include <algorithm>

#include "base/options.hpp"
#include "base/registry.hpp"

namespace calomel {

struct Riemer {
  double bulk_modulus;    ///< K [Pa]
  double tensile_cutoff;  ///< sigma_c >= 0 [Pa]; infinite: a linear liquid
  double viscosity;       ///< eta [Pa s]

  [[nodiscard]] double pressure(double p0, double e_v, double rate) const { return std::max(p0 - bulk_modulus * e_v - viscosity * rate, -tensile_cutoff); }
  /// Pressure without viscosity: what is stored.
  [[nodiscard]] double elastic_pressure(double p0, double e_v) const { return std::max(p0 - bulk_modulus * e_v, -tensile_cutoff); }
  /// Stored energy per volume [J/m^3], with -elastic_pressure as its derivative by e_v.
  [[nodiscard]] double stored_energy(double p0, double e_v) const {
    const double stretch = e_v - p0 / bulk_modulus, limit = tensile_cutoff / bulk_modulus;
    return stretch <= limit ? 0.5 * bulk_modulus * stretch * stretch : tensile_cutoff * (stretch - 0.5 * limit);
  }
};

/// `[material.mercury]`.
struct MercuryOptions {
  std::string law = "riemer";
  double density = 13500;                // kg/m^3, nominal of the published study
  double sound_speed = 1450;             // m/s
  double tensile_cutoff = 1.5e5;         // Pa
  double regularising_viscosity = 2000;  // Pa s, physics.md section 1
  double least_mesh_viscosity = 0.1;     // eta >= this rho c h
  double quadratic_viscosity = 0;        // b2 of q = rho (b2 h de_v/dt)^2
  double collapse_viscosity = 0.5;       // b of q = -b rho c h de_v/dt
  double wall_film = 0;                  // m
  double hourglass = 0.0005;             // share of the greatest dilatational stiffness
  double thermal_expansion = 1.8e-4;     // 1/K
  double specific_heat = 138.3;          // J/(kg K), Vukalovich tables at 333 K
  template <class V>
  void visit(V& v) {
    v("law", law, {.doc = "constitutive law of the liquid", .choices = {"riemer", "linear"}});
    v("density", density, {.unit = "kg/m^3", .range = above(0), .doc = "density of the liquid"});
    v("sound_speed", sound_speed, {.unit = "m/s", .range = at_least(0), .doc = "speed of sound in the liquid"});
    v("tensile_cutoff", tensile_cutoff, {.unit = "Pa", .range = at_least(0), .doc = "tension at which the liquid cavitates"});
    v("regularising_viscosity", regularising_viscosity,
      {.unit = "Pa s", .range = at_least(0), .doc = "fixed viscosity eta inside the cutoff, the same for every mesh"});
    v("least_mesh_viscosity", least_mesh_viscosity, {.range = between(0, 1), .doc = "eta is at least this times rho c h, h the liquid's element size"});
    v("quadratic_viscosity", quadratic_viscosity,
      {.range = between(0, 5), .doc = "b2 of the quadratic bulk viscosity rho (b2 h rate)^2 in compression; 0 = none"});
    v("collapse_viscosity", collapse_viscosity,
      {.range = between(0, 2),
       .doc = "b of the viscosity b rho c h against compression of liquid that has been at the cutoff: its closing is inelastic on any mesh; 0 = none"});
    v("wall_film", wall_film,
      {.unit = "m",
       .range = between(-1e-3, 1e-3),
       .doc =
           "mercury that remains on a wetted wall when it cavitates there: the cavity opens that far from the wall; at most 0.6 of half an element. Below 0, "
           "for estimates alone, the wall is the lighter"});
    v("hourglass", hourglass, {.range = between(0, 1), .doc = "hourglass stiffness of the liquid relative to its dilatational stiffness"});
    v("thermal_expansion", thermal_expansion, {.unit = "1/K", .range = above(0), .doc = "volumetric expansion coefficient beta of Gamma = beta c^2 / c_p"});
    v("specific_heat", specific_heat, {.unit = "J/(kg K)", .range = above(0), .doc = "specific heat c_p of Gamma = beta c^2 / c_p"});
  }
};

/// Laws of the liquid by name: from the options to Riemer's parameters ("linear" is Riemer's law with no cutoff).
using RiemerFactory = Riemer (*)(const MercuryOptions&, double viscosity);
const Registry<RiemerFactory>& liquid_laws();

}  // namespace calomel
