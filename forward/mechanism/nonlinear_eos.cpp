#include "forward/mechanism/nonlinear_eos.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

double StiffeningLiquid::greatest_stiffness() const {
  const double k = liquid_.bulk_modulus;
  return k * std::pow(1 + exponent_ * greatest_pressure_ / k, (exponent_ - 1) / exponent_);
}

void StiffeningLiquid::advance(const LiquidPoints& points) const {
  const double k = liquid_.bulk_modulus, rate = points.dt > 0 ? liquid_.viscosity / points.dt : 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const double e = points.strain[i] - points.heating[i] / k;
    // (1 - e)^m - 1 without the loss of digits at small e; nothing is left to expand beyond e = 1.
    const double elastic = k / exponent_ * std::expm1(exponent_ * std::log1p(-std::min(e, 1 - 1e-15)));
    if (!(elastic <= greatest_pressure_))
      throw LiquidPointError(
          fmt::format("the mercury comes under {:.4g} Pa: its step is stable to {:.4g} Pa, four times the heating pressure", elastic, greatest_pressure_), i);
    points.pressure[i] = std::max(elastic - rate * (points.strain[i] - points.strain_before[i]), -liquid_.tensile_cutoff);
  }
}

namespace {

constexpr double of_heating = 4;         ///< a wave meets another or a wall: twice; both: four times
constexpr double without_heating = 3e8;  ///< Pa, of a run without heat

std::shared_ptr<const LiquidLaw> liquid(const MechanismValues& v, const RunSetup& s) {
  const double heating = s.p0.empty() ? 0 : *std::max_element(s.p0.begin(), s.p0.end()), energy = *std::max_element(s.energies.begin(), s.energies.end());
  double before = 0;
  for (const auto& stress : s.initial_stress) before = std::max(before, -(stress[0] + stress[1] + stress[2]) / 3);
  const double greatest = of_heating * (heating * energy + before);
  return std::make_shared<StiffeningLiquid>(s.liquid, v["exponent"], greatest > 0 ? greatest : without_heating);
}

}  // namespace

MechanismEntry nonlinear_eos() {
  return {
      .law = "p = max((K/m) ((1 - e)^m - 1) - eta de_v/dt, -sigma_c), e = e_v - p0/K",
      .plain = "mercury that stiffens under pressure",
      .check = "check the peak pressure of the case, for stiffening shows at high pressure only",
      .keys = {{.name = "exponent", .unit = "", .off = 1, .low = 1, .high = 14, .least = 1, .greatest = 30, .doc = "m; 10.8 for mercury, whose B/A is 7.8"}},
      .cost = 1.9,
      .liquid = liquid};
}

}  // namespace calomel
