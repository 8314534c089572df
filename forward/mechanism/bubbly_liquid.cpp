#include "forward/mechanism/bubbly_liquid.hpp"

#include <fmt/format.h>

namespace calomel {

void BubblyLiquid::initialise(std::span<const Vec3> centres, double* state, std::size_t stride) const {
  for (std::size_t i = 0; i < centres.size(); ++i) state[i] = bubble_.radius, state[stride + i] = 0, state[2 * stride + i] = 0;
}

void BubblyLiquid::advance(const LiquidPoints& points) const {
  for (std::size_t i = 0; i < points.count; ++i) try {
      advance_point(points, i);
    } catch (const NumericsError& e) {
      throw LiquidPointError(e.what(), i);
    }
}

void BubblyLiquid::advance_point(const LiquidPoints& points, std::size_t i) const {
  double &radius = points.state[i], &rate = points.state[points.stride + i], &heating_before = points.state[2 * points.stride + i];
  const double strain = points.strain[i], before = points.strain_before[i], heating = points.heating[i];
  const double r0 = bubble_.radius, k = liquid_.bulk_modulus, dt = points.dt;
  const double slope = dt > 0 ? (strain - before) / dt : 0, heating_slope = dt > 0 ? (heating - heating_before) / dt : 0;
  const auto alpha = [&](double r) { const double x = r / r0; return alpha0_ * x * x * x; };
  const auto pressure = [&](double e_v, double p0, double r) { return liquid_.pressure(p0, e_v - alpha(r) + alpha0_, slope); };

  const bool at_rest = strain == 0 && before == 0 && heating == 0 && heating_before == 0 && radius == r0 && rate == 0;
  if (!at_rest && dt > 0) {
    const double coupling = 3 * alpha0_ * k / (bubble_.density * r0 * r0 * r0);  // dp/dR / (rho R) = coupling R
    const double greatest_step = 0.4 / std::sqrt(bubble_.natural_squared() + coupling * r0);
    const auto after = advance_bubble(
        bubble_, {radius, rate}, dt, greatest_step, [&](double t, double r) { return pressure(before + slope * t, heating_before + heating_slope * t, r); },
        [&](double r) { return coupling * r; });
    radius = after.radius, rate = after.rate;
    if (alpha(radius) > greatest_alpha)
      throw NumericsError(fmt::format("the bubbles fill {:.3g} of the mercury (alpha0 = {:.3g}, R = {:.3g} m): the law holds to {}", alpha(radius), alpha0_, radius, greatest_alpha));
  }
  heating_before = heating;
  points.pressure[i] = pressure(strain, heating, radius);
}

namespace {

// Mercury near 330 K (physics.md section 2).
constexpr double surface_tension = 0.47;   // N/m
constexpr double viscosity = 1.3e-3;       // Pa s

std::shared_ptr<const LiquidLaw> liquid(const MechanismValues& v, const RunSetup& s) {
  const KellerMiksis bubble{.density = s.liquid_density,
                            .sound_speed = std::sqrt(s.liquid.bulk_modulus / s.liquid_density),
                            .radius = v["radius"],
                            .ambient = v["ambient_pressure"],
                            .polytropic = v["polytropic"],
                            .surface_tension = surface_tension,
                            .viscosity = viscosity + v["thermal_viscosity"]};
  return std::make_shared<BubblyLiquid>(s.liquid, bubble, v["alpha0"]);
}

}  // namespace

MechanismEntry bubbly_liquid() {
  return {.law = "p = max(p0 - K (e_v - alpha + alpha0) - eta de_v/dt, -sigma_c), alpha = alpha0 (R/R0)^3 by Keller and Miksis",
          .keys = {{.name = "alpha0", .unit = "", .off = 0, .low = 1e-5, .high = 1e-2, .log_uniform = true, .least = 0, .greatest = 0.1, .doc = "share of the volume that is gas at rest"},
                   {.name = "radius", .unit = "m", .off = 1e-4, .low = 1e-5, .high = 5e-4, .log_uniform = true, .decides = false, .least = 1e-6, .greatest = 1e-2, .doc = "of the bubbles at rest, R0"},
                   {.name = "ambient_pressure", .unit = "Pa", .off = 1e5, .low = 1e5, .high = 4e5, .decides = false, .least = 1e3, .greatest = 1e7, .doc = "absolute pressure at rest, p_a"},
                   {.name = "polytropic", .unit = "", .off = 1.16, .low = 1, .high = 1.67, .decides = false, .least = 1, .greatest = 1.67, .doc = "exponent kappa of the gas"},
                   {.name = "thermal_viscosity", .unit = "Pa s", .off = 0.5, .low = 0, .high = 10, .decides = false, .least = 0, .doc = "stands for the loss of heat, b_th rho R0^2 / 2, in the bubble's damping"}},
          .cost = 9,
          .liquid = liquid};
}

}  // namespace calomel
