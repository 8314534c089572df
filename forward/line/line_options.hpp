#pragma once
/// The description of a line in a case file: a bar or a pipe, and where its histories are read.
#include <optional>
#include <string>

#include "base/options.hpp"

namespace calomel {

/// `[line]` with kind = "bar": the wave that passes a first gauge, where it is measured ([drive]), runs on without changing its shape.
struct BarOptions {
  std::string kind = "bar";
  double wave_speed = 0;
  std::optional<double> radius;
  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "bar or pipe", .required = true, .choices = {"bar", "pipe"}});
    v("wave_speed", wave_speed, {.unit = "m/s", .range = above(0), .doc = "c0 = sqrt(E / rho), of long waves", .required = true});
    v("radius", radius, {.unit = "m", .range = above(0), .doc = "of the round bar; lateral_inertia needs it"});
  }
};

/// `[line]` with kind = "pipe": reservoir, pipe and closing valve, elastic, with quasi-steady friction.
struct PipeOptions {
  std::string kind = "pipe";
  double length = 0, diameter = 0, wave_speed = 0, velocity = 0, reservoir_pressure = 0;
  double density = 998.2;
  double viscosity = 1.002e-3;
  std::optional<double> friction_factor;
  double roughness = 0;
  double rise = 0;
  double outlet_pressure = 0;
  double closure_begin = 0, closure_time = 0, closure_exponent = 1;
  int cells = 64;
  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "bar or pipe", .required = true, .choices = {"bar", "pipe"}});
    v("length", length, {.unit = "m", .range = above(0), .doc = "from the reservoir to the valve", .required = true});
    v("diameter", diameter, {.unit = "m", .range = above(0), .doc = "inner", .required = true});
    v("wave_speed", wave_speed, {.unit = "m/s", .range = above(0), .doc = "of pressure waves in the filled pipe", .required = true});
    v("velocity", velocity, {.unit = "m/s", .range = at_least(0), .doc = "of the steady flow towards the valve", .required = true});
    v("reservoir_pressure", reservoir_pressure,
      {.unit = "Pa", .range = at_least(-101325), .doc = "over the atmosphere's, at the pipe's end", .required = true});
    v("density", density, {.unit = "kg/m^3", .range = above(0), .doc = "of the liquid; default: water at 20 C"});
    v("viscosity", viscosity, {.unit = "Pa s", .range = at_least(0), .doc = "of the liquid; default: water at 20 C"});
    v("friction_factor", friction_factor, {.range = between(0, 1), .doc = "Darcy's, of turbulent flow; default: Haaland's of the steady flow"});
    v("roughness", roughness, {.range = between(0, 0.1), .doc = "of the wall, over the diameter"});
    v("rise", rise, {.unit = "m", .doc = "height of the valve over the reservoir's end"});
    v("outlet_pressure", outlet_pressure, {.unit = "Pa", .range = at_least(-101325), .doc = "behind the valve, over the atmosphere's"});
    v("closure_begin", closure_begin, {.unit = "s", .doc = "when the valve begins to close"});
    v("closure_time", closure_time, {.unit = "s", .range = at_least(0), .doc = "that it takes; 0 = at once"});
    v("closure_exponent", closure_exponent, {.range = between(0.05, 20), .doc = "opening = (1 - time/closure_time)^exponent"});
    v("cells", cells, {.range = between(2, 100000), .doc = "of the grid; a step is the wave's time through one"});
  }
};

/// `[[station]]`: where a history is read along the line.
struct StationOptions {
  std::string name;
  double distance = 0;
  double gain = 1, delay = 0, offset = 0;
  template <class V>
  void visit(V& v) {
    v("name", name, {.doc = "name, as in the recordings", .required = true});
    v("distance", distance, {.unit = "m", .range = at_least(0), .doc = "from the driven gauge of a bar, from the reservoir of a pipe", .required = true});
    v("gain", gain, {.doc = "reading per value"});
    v("delay", delay, {.unit = "s", .doc = "by which its clock lags"});
    v("offset", offset, {.doc = "added to the reading, in its unit"});
  }
  /// Errors: InputError when the name is empty.
  void validate() const {
    if (name.empty()) throw InputError({.problem = "a station needs a name", .key = "name", .value = "\"\""});
  }
};

}  // namespace calomel
