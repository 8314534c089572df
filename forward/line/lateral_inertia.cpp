#include "forward/line/lateral_inertia.hpp"

#include <cmath>

#include "forward/line/pochhammer_chree.hpp"

namespace calomel {

namespace {

void disperse(const MechanismValues& v, const BarOptions& bar, std::span<const double> omega, std::span<std::complex<double>> wavenumber) {
  const double poisson = v["poisson"], scale = *bar.radius / bar.wave_speed;
  if (!(poisson >= 0 && poisson < 0.5)) throw NumericsError("lateral_inertia: Poisson's ratio " + number_text(poisson) + " is not in 0 to below 0.5");
  const PochhammerChreeMode mode(poisson, scale * omega.back());
  for (std::size_t i = 0; i < omega.size(); ++i) wavenumber[i] /= mode.speed(scale * omega[i]);
}

}  // namespace

LineMechanismEntry lateral_inertia() {
  return {.law = "k = omega / c(omega), c the phase speed of Pochhammer and Chree's first longitudinal mode",
          .keys = {{.name = "poisson", .unit = "", .off = 0, .low = 0.2, .high = 0.4, .least = 0, .greatest = 0.49, .doc = "Poisson's ratio of the bar"}},
          .needs = "line.radius",
          .plain = "the bar's inertia across its axis",
          .check = "compare Poisson's ratio with that of the bar's material",
          .wavenumber = disperse};
}

}  // namespace calomel
