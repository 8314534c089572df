#pragma once
/// The first longitudinal mode of an elastic round bar.
#include <vector>

namespace calomel {

/// Left side of Pochhammer and Chree's frequency equation, which vanishes for a wave of phase speed c = `ratio` c0 at frequency Omega = omega a / c0 (a the
/// radius, c0 = sqrt(E / rho)); with x^2 = Omega^2 (c0/cL)^2 - kappa^2, y^2 = Omega^2 (c0/cT)^2 - kappa^2, kappa = Omega / ratio and phi(z^2) = z J0(z) /
/// J1(z):
///   2 x^2 (y^2 + kappa^2) - (y^2 - kappa^2)^2 phi(x^2) - 4 kappa^2 x^2 phi(y^2),
/// real for negative squares too, over Omega^4 [-]. Pochhammer 1876, Chree 1889; as in Graff, Wave Motion in Elastic Solids, 1975, equation 8.2.36, times x.
double pochhammer_chree(double Omega, double ratio, double poisson);

/// Phase speed of the first mode over c0 on 0 <= Omega <= greatest: 1 - nu^2 Omega^2 / 4 at low frequency (Rayleigh), Rayleigh's surface speed at high. As nu
/// goes to 0 so does the dispersion below Omega = 1.84, where the mode then turns down in a corner; below nu = 0.01 the corner is passed straight on, along c0.
class PochhammerChreeMode {
 public:
  /// poisson: 0 to below 0.5. Errors: NumericsError when the mode cannot be followed.
  PochhammerChreeMode(double poisson, double greatest);
  /// c/c0 at Omega in 0 ... greatest, the nearest end outside; cubic between the roots, off by less than 2e-6.
  [[nodiscard]] double speed(double Omega) const;

 private:
  std::vector<double> Omega_, speed_, slope_;
};

/// c/c0 of Love's rod, whose sections also move across: omega^2 (1 + nu^2 a^2 k^2 / 2) = c0^2 k^2 of a round bar, so (1 - nu^2 Omega^2 / 2)^1/2; 0 from Omega =
/// sqrt 2 / nu on, where it carries no waves (Love 1927, section 278).
double love_speed(double Omega, double poisson);

}  // namespace calomel
