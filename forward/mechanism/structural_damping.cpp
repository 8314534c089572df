#include "forward/mechanism/structural_damping.hpp"

#include <numbers>

namespace calomel {

namespace {

constexpr double apart = 5;  ///< frequencies of neighbouring branches

/// Branches of one share at frequency / apart, frequency and frequency * apart, together the ratio `loss` at `frequency` and little less a decade about it.
std::vector<RelaxingBranch> branches(double loss, double frequency) {
  const double factor_of_one = 0.5 + 2 * apart / (1 + apart * apart);  // loss factor, twice the ratio, of share 1 at the middle: sum of x / (1 + x^2)
  std::vector<RelaxingBranch> all;
  for (const double f : {frequency / apart, frequency, frequency * apart})
    all.push_back({.share = 2 * loss / factor_of_one, .time = 1 / (2 * std::numbers::pi * f)});
  return all;
}

}  // namespace

MechanismEntry structural_damping() {
  return {
      .law = "Rayleigh damping a M + b K of the steel, and three Maxwell branches about one frequency",
      .plain = "damping of the steel structure",
      .check = "hold the damping against the ring-down of the vessel, and look at its joints and supports",
      .keys =
          {{.name = "mass", .unit = "1/s", .off = 0, .low = 0, .high = 1e4, .screened = false, .least = 0, .doc = "a: damps slow motion, also of a rigid body"},
           {.name = "stiffness",
            .unit = "s",
            .off = 0,
            .low = 0,
            .high = 1e-6,
            .screened = false,
            .least = 0,
            .doc = "b: damps fast modes; shortens the stable step"},
           {.name = "loss",
            .unit = "",
            .off = 0,
            .low = 0,
            .high = 0.1,
            .least = 0,
            .greatest = 0.2,
            .doc = "damping ratio of the steel at `frequency`, much the same a decade about it; stiffens fast motion"},
           {.name = "frequency",
            .unit = "Hz",
            .off = 2e4,
            .low = 5e3,
            .high = 1e5,
            .log_uniform = true,
            .decides = false,
            .shapes = true,
            .least = 1,
            .greatest = 1e7,
            .doc = "about which `loss` acts"}},
      .like_the_mesh = true,
      .cost = 2.2,
      .setup = [](const MechanismValues& v, RunSetup& s) {
        s.steel_mass_damping += v["mass"];
        s.steel_stiffness_damping += v["stiffness"];
        if (v["loss"] != 0) s.steel_branches = branches(v["loss"], v["frequency"]);
      }};
}

}  // namespace calomel
