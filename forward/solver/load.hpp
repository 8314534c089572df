#pragma once
/// What sets the target in motion: the heat of a proton pulse (initial_pressure) or a measured stress on an end (end_stress).
#include <filesystem>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "base/registry.hpp"
#include "forward/material/riemer.hpp"
#include "forward/mesh/mesh.hpp"

namespace calomel {

/// Shape of the deposition: p0 = peak S(y, z) g(x) / max g, x the depth below the outer front face,
/// g = (1 + b (1 - exp(-x / x1))) exp(-x / decay), S = exp(-1/2 |(y - y0) / w_y|^n - 1/2 |(z - z0) / w_z|^n)
/// (physics.md section 2). In plane strain the y factor is 1.
struct ProfileOptions {
  std::array<double, 2> center{0.0, 0.0};      // (y0, z0)
  std::array<double, 2> widths{0.058, 0.020};  // (w_y, w_z)
  double decay = 0.13;
  double buildup = 1.5;
  double buildup_length = 0.02;
  double exponent = 2;
  double front = 0;  ///< x of the outer front face [m]; no key, the mesh has it
  template <class V>
  void visit(V& v) {
    v("center", center, {.unit = "m", .doc = "(y0, z0) of the beam's axis"});
    v("widths", widths, {.unit = "m", .range = above(0), .doc = "(w_y, w_z); standard deviations for exponent 2"});
    v("decay", decay, {.unit = "m", .range = above(0), .doc = "decay length along the beam"});
    v("buildup", buildup, {.range = at_least(0), .doc = "b of the build-up behind the front face"});
    v("buildup_length", buildup_length, {.unit = "m", .range = above(0), .doc = "x1 of the build-up"});
    v("exponent", exponent, {.range = between(1, 20), .doc = "n of the transverse shape"});
  }
  /// Value at a point, at most 1. `plane_strain` drops the y factor.
  [[nodiscard]] double shape(const Vec3& x, bool plane_strain) const;
  /// max over all depths of g.
  [[nodiscard]] double greatest() const;
};

/// `[load]`.
struct LoadOptions {
  std::string kind = "initial_pressure";
  std::string policy = "fixed";
  double pulse_length = 0.7e-6;
  std::optional<double> peak_pressure;
  std::optional<double> energy;
  ProfileOptions profile;
  std::string file;         // end_stress
  double stress_scale = 1;  // end_stress
  double factor = 1;        ///< on the heating pressure; no key, mechanisms set it
  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "what sets the target in motion", .choices = {"initial_pressure", "end_stress"}});
    v("policy", policy, {.doc = "p0 given (fixed) or recomputed with the parameters as Gamma q (gruneisen)", .choices = {"fixed", "gruneisen"}});
    v("pulse_length", pulse_length, {.unit = "s", .range = between(0, 1e-3), .doc = "time over which the pressure grows linearly"});
    v("peak_pressure", peak_pressure, {.unit = "Pa", .range = between(0, 1e9), .doc = "greatest heating pressure"});
    v("energy", energy, {.unit = "J", .range = above(0), .doc = "deposited energy, in place of peak_pressure"});
    v.table("profile", profile, "shape of the deposition");
    v("file", file, {.doc = "end_stress: text file with two columns, time [s] and stress (tension positive)"});
    v("stress_scale", stress_scale, {.unit = "Pa", .doc = "end_stress: factor from the file's second column to Pa"});
  }
  void validate() const;
};

/// In words, how the load follows the parameters: every report names it, because it changes what can be identified.
std::string policy_text(const LoadOptions& load);

/// Names and meaning of the loads.
const Registry<std::string>& loads();

constexpr double gruneisen_reach = 0.15;  ///< relative distance of the sound speed from its nominal value within which the policy "gruneisen" holds

/// Gruneisen coefficient beta c^2 / c_p [-].
double gruneisen(const MercuryOptions& m, double sound_speed);

/// Heating pressure of each element (mean over 2 x 2 x 2 points) and at each node, peak 1.
struct HeatingShape {
  std::vector<double> element;  ///< per mesh element, 0 in the steel [-]
  double integral;              ///< int shape dV over the mercury [m^3]
};
HeatingShape heating_shape(const Mesh& mesh, const ProfileOptions& profile);

/// A sampled history, linear between samples, its end values outside.
struct History {
  std::vector<double> time, value;
  [[nodiscard]] double at(double t) const;
};
/// Two columns (comma or space) with `#` comments. Errors: InputError with file and line.
History read_history(const std::filesystem::path& path);

}  // namespace calomel
