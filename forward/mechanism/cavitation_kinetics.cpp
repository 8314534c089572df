#include "forward/mechanism/cavitation_kinetics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calomel {

namespace {

/// The step of every point: `grown(state, x)` moves the point's state on under a stretch of x beyond the cutoff and gives the void's share.
template <class Grown>
void advance_voids(const Riemer& liquid, const LiquidPoints& points, const Grown& grown) {
  const double k = liquid.bulk_modulus, dt = points.dt, lag = dt > 0 ? liquid.viscosity / (k * dt) : 0;
  const double cutoff = std::min(liquid.tensile_cutoff, 1e30);  // finite, so that mercury which never gives way needs no case of its own
  for (std::size_t i = 0; i < points.count; ++i) {
    const double stretch = points.strain[i] + lag * (points.strain[i] - points.strain_before[i]) - points.heating[i] / k, x = stretch - cutoff / k,
                 alpha = grown(points.state[i], x);
    points.pressure[i] = alpha > 0 ? -cutoff - k * (x - alpha) : -k * stretch;  // the cutoff itself, to the bit, where the void is as large as it would be
  }
}

}  // namespace

void KineticLiquid::advance(const LiquidPoints& points) const {
  const auto left = [&](double tau) { return tau > 0 ? std::exp(-points.dt / tau) : 0; };  // of a difference after the step
  const double after_growth = left(growth_time_), after_collapse = left(collapse_time_);
  advance_voids(liquid_, points, [&](double& alpha, double x) { return alpha = std::max(0.0, x + (alpha - x) * (x > alpha ? after_growth : after_collapse)); });
}

NucleatedLiquid::NucleatedLiquid(const Riemer& liquid, double density, double nuclei_spacing)
    : liquid_(liquid), rate_(std::sqrt(2 * liquid.bulk_modulus / (3 * density)) / (std::cbrt(3 / (4 * std::numbers::pi)) * nuclei_spacing)) {}

void NucleatedLiquid::advance(const LiquidPoints& points) const {
  const double step = rate_ * points.dt;
  advance_voids(liquid_, points, [step](double& radius, double x) {
    const double before = radius * radius * radius, moved = step * std::sqrt(std::abs(x - before));
    radius = x > before ? radius + moved : std::max(0.0, radius - moved);
    double alpha = radius * radius * radius;
    if (x > before ? alpha > x : alpha < x) {  // never past the balance
      alpha = std::max(0.0, x);
      radius = std::cbrt(alpha);
    }
    return alpha;
  });
}

namespace {

void slow_walls(const MechanismValues& v, RunSetup& s) { s.parting_time = v["growth_time"], s.meeting_time = v["collapse_time"]; }

std::shared_ptr<const LiquidLaw> cavitating_law(const MechanismValues& v, const RunSetup& s) {
  const double spacing = v["nuclei_spacing"];
  if (spacing == 0) return std::make_shared<KineticLiquid>(s.liquid, v["growth_time"], v["collapse_time"]);
  if (v["growth_time"] > 0 || v["collapse_time"] > 0)
    throw InputError({.problem = "voids follow either time constants or the inertia of the mercury about their nuclei",
                      .key = "mechanism.cavitation_kinetics.nuclei_spacing",
                      .value = number_text(spacing),
                      .suggestion = "leave it at 0, or growth_time and collapse_time"});
  return std::make_shared<NucleatedLiquid>(s.liquid, s.liquid_density, spacing);
}

MechanismKey time_constant(const char* name, const char* doc) {
  return {.name = name, .unit = "s", .off = 0, .low = 0.05e-6, .high = 200e-6, .log_uniform = true, .least = 0, .greatest = 1, .doc = doc, .law = "lag"};
}

}  // namespace

MechanismEntry cavitation_kinetics() {
  return {.law =
              "p = p0 - K (e_v - alpha) - eta de_v/dt, the void alpha following the stretch beyond the cutoff with a time constant, or as nuclei grow against "
              "the mercury's inertia",
          .plain = "voids in the mercury that open and close slowly",
          .check = "see whether other records of the same mercury require the same times, or the same nuclei",
          .keys = {time_constant("growth_time", "of a void that grows: so long the mercury holds more than its cutoff"),
                   time_constant("collapse_time", "of a void that closes"),
                   {.name = "nuclei_spacing",
                    .unit = "m",
                    .off = 0,
                    .low = 1e-4,
                    .high = 1e-2,
                    .log_uniform = true,
                    .least = 0,
                    .greatest = 1,
                    .doc = "mean distance of the nuclei from which voids grow, n^(-1/3) of n in a volume: the mercury's inertia about each holds it up; in "
                           "place of the two times",
                    .law = "inertia"}},
          .like_the_mesh = true,
          .cost = 1.2,
          .setup = slow_walls,
          .liquid = cavitating_law};
}

}  // namespace calomel
