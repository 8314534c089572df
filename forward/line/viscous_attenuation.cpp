#include "forward/line/viscous_attenuation.hpp"

namespace calomel {

namespace {

void attenuate(const MechanismValues& v, const BarOptions&, std::span<const double> omega, std::span<std::complex<double>> wavenumber) {
  const double theta = v["time"];
  if (!(theta >= 0)) throw NumericsError("viscous_attenuation: the time " + number_text(theta) + " s is below 0");
  for (std::size_t i = 0; i < omega.size(); ++i) wavenumber[i] /= std::sqrt(std::complex<double>(1, omega[i] * theta));
}

}  // namespace

LineMechanismEntry viscous_attenuation() {
  return {.law = "sigma = E (e + theta de/dt): k = (omega / c0) (1 + i omega theta)^-1/2",
          .keys = {{.name = "time",
                    .unit = "s",
                    .off = 0,
                    .low = 1e-9,
                    .high = 1e-6,
                    .log_uniform = true,
                    .least = 0,
                    .greatest = 1,
                    .doc = "theta, viscosity over Young's modulus"}},
          .plain = "losses in the bar",
          .check = "see whether the wave loses as much again on its next passage through the bar",
          .wavenumber = attenuate};
}

}  // namespace calomel
