#include "forward/mechanism/bubbly_liquid.hpp"

#include <fmt/format.h>

namespace calomel {

BubblyLiquid::BubblyLiquid(const Riemer& liquid, const KellerMiksis& b, double alpha0, InstructionSet isa) : kernel_(&bubble_kernel(isa)) {
  const double coupling = 3 * alpha0 * liquid.bulk_modulus / (b.density * b.radius * b.radius * b.radius);  // dp/dR / (rho R) = coupling R
  numbers_ = {.density = b.density,
              .sound_speed = b.sound_speed,
              .radius = b.radius,
              .ambient = b.ambient,
              .polytropic = b.polytropic,
              .surface_tension = b.surface_tension,
              .viscosity = b.viscosity,
              .gas_at_rest = b.gas_pressure(b.radius),
              .bulk_modulus = liquid.bulk_modulus,
              .tensile_cutoff = liquid.tensile_cutoff,
              .liquid_viscosity = liquid.viscosity,
              .alpha0 = alpha0,
              .greatest_alpha = greatest_alpha,
              .coupling = coupling,
              .greatest_step = 0.4 / std::sqrt(b.natural_squared() + coupling * b.radius)};
}

void BubblyLiquid::initialise(std::span<const Vec3> centres, double* state, std::size_t stride) const {
  for (std::size_t i = 0; i < centres.size(); ++i) state[i] = numbers_.radius, state[stride + i] = 0, state[2 * stride + i] = 0;
}

void BubblyLiquid::advance(const LiquidPoints& points) const {
  const BubbleFailure failure = kernel_->advance(numbers_, points);
  const auto& [reason, point, radius] = failure;
  if (reason == BubbleFailure::vanished) throw LiquidPointError("a bubble collapses to nothing", point);
  if (reason == BubbleFailure::too_violent) throw LiquidPointError("a bubble's collapse is too violent to follow", point);
  if (reason == BubbleFailure::too_much_gas) {
    const double x = radius / numbers_.radius, alpha = numbers_.alpha0 * x * x * x;
    throw LiquidPointError(fmt::format("the bubbles fill {:.3g} of the mercury (alpha0 = {:.3g}, R = {:.3g} m): the law holds to {}", alpha, numbers_.alpha0,
                                       radius, greatest_alpha),
                           point);
  }
}

namespace {

// Mercury near 330 K (physics.md section 2).
constexpr double surface_tension = 0.47;  // N/m
constexpr double viscosity = 1.3e-3;      // Pa s

std::shared_ptr<const LiquidLaw> bubbly_law(const MechanismValues& v, const RunSetup& s) {
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
          .plain = "gas bubbles in the mercury",
          .check = "find out whether the mercury contained gas during these pulses, injected or carried over, and how much",
          .keys = {{.name = "alpha0",
                    .unit = "",
                    .off = 0,
                    .low = 1e-5,
                    .high = 1e-2,
                    .log_uniform = true,
                    .least = 0,
                    .greatest = 0.1,
                    .doc = "share of the volume that is gas at rest"},
                   {.name = "radius",
                    .unit = "m",
                    .off = 1e-4,
                    .low = 1e-5,
                    .high = 5e-4,
                    .log_uniform = true,
                    .decides = false,
                    .shapes = true,
                    .least = 1e-6,
                    .greatest = 1e-2,
                    .doc = "of the bubbles at rest, R0"},
                   {.name = "ambient_pressure",
                    .unit = "Pa",
                    .off = 1e5,
                    .low = 1e5,
                    .high = 4e5,
                    .decides = false,
                    .least = 1e3,
                    .greatest = 1e7,
                    .doc = "absolute pressure at rest, p_a"},
                   {.name = "polytropic",
                    .unit = "",
                    .off = 1.16,
                    .low = 1,
                    .high = 1.67,
                    .decides = false,
                    .least = 1,
                    .greatest = 1.67,
                    .doc = "exponent kappa of the gas"},
                   {.name = "thermal_viscosity",
                    .unit = "Pa s",
                    .off = 0.5,
                    .low = 0.05,
                    .high = 5,
                    .log_uniform = true,
                    .decides = false,
                    .shapes = true,
                    .least = 0,
                    .doc = "represents the loss of heat, b_th rho R0^2 / 2, in the bubble's damping"}},
          .cost = 2.5,
          .liquid = bubbly_law};
}

}  // namespace calomel
