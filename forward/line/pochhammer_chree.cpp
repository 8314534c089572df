#include "forward/line/pochhammer_chree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <optional>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr double asymptotic = 500;

/// z J0(z) / J1(z) of w = z^2; for w < 0 y I0(y) / I1(y), y^2 = -w. Its series near 0: 2 - w/4 - w^2/96 - w^3/1536.
double phi(double w) {
  if (std::abs(w) < 1e-2) return 2 - w / 4 - w * w / 96 - w * w * w / 1536 - w * w * w * w / 23040;
  const double z = std::sqrt(std::abs(w));
  if (w < 0 && z > asymptotic) return z + 0.5 + 0.375 / z;  // to a few parts in z^-3; I0 itself overflows at 713
  return w > 0 ? z * boost::math::cyl_bessel_j(0, z) / boost::math::cyl_bessel_j(1, z) : z * boost::math::cyl_bessel_i(0, z) / boost::math::cyl_bessel_i(1, z);
}

}  // namespace

double pochhammer_chree(double Omega, double ratio, double poisson) {
  const double O2 = Omega * Omega, k = O2 / (ratio * ratio);
  const double x = O2 * (1 + poisson) * (1 - 2 * poisson) / (1 - poisson) - k, y = 2 * O2 * (1 + poisson) - k;  // squares
  return (2 * x * (y + k) - (y - k) * (y - k) * phi(x) - 4 * k * x * phi(y)) / (O2 * O2);
}

namespace {

/// The root nearest to `middle` by steps either way; none within `farthest`.
std::optional<double> root_near(double Omega, double middle, double poisson) {
  constexpr double away = 2.5e-4, farthest = 0.02;
  const auto f = [&](double c) { return pochhammer_chree(Omega, c, poisson); };
  const double at_middle = f(middle);
  for (double d = away; d <= farthest; d += away)
    for (const double side : {-1.0, 1.0}) {
      const double at = f(middle + side * d);
      if (std::signbit(at) == std::signbit(at_middle)) continue;
      const double low = side < 0 ? middle - d : middle + d - away, high = low + away;
      std::uintmax_t most = 60;
      const auto bracket =
          boost::math::tools::toms748_solve(f, low, high, side < 0 ? at : f(low), side < 0 ? f(high) : at, boost::math::tools::eps_tolerance<double>(46), most);
      return 0.5 * (bracket.first + bracket.second);
    }
  return std::nullopt;
}

}  // namespace

PochhammerChreeMode::PochhammerChreeMode(double poisson, double greatest) {
  expect(poisson >= 0 && poisson < 0.5 && greatest >= 0, "Poisson's ratio is 0 to below 0.5");
  Omega_ = {0};
  speed_ = {1};
  // From the line through the last two roots outwards in small steps to the next change of sign; the second mode is at least a twelfth of the speed away. Of a
  // small ratio the speed falls within a short stretch: where no root is near, the step is halved.
  constexpr double slow = 0.02, fast = 0.1, bend = 4, shortest = 1e-5;
  double step = slow;
  while (poisson > 0 && Omega_.back() < greatest) {
    const std::size_t n = Omega_.size();
    step = std::min(2 * step, Omega_.back() < bend - 1e-9 ? slow : fast);
    const double rise = n > 1 ? (speed_[n - 1] - speed_[n - 2]) / (Omega_[n - 1] - Omega_[n - 2]) : 0;
    std::optional<double> root;
    while (!(root = root_near(Omega_.back() + step, speed_.back() + rise * step, poisson)))
      if ((step /= 2) < shortest)
        throw NumericsError(fmt::format("the first Pochhammer-Chree mode is lost at Omega = {:.3g} (Poisson's ratio {:.4g})", Omega_.back(), poisson));
    Omega_.push_back(Omega_.back() + step);
    speed_.push_back(*root);
  }
  // Slopes of the cubics from three neighbours, exact for parabolas; even in Omega at 0.
  const std::size_t n = Omega_.size();
  slope_.assign(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double h0 = Omega_[i] - Omega_[i - 1], h1 = Omega_[i + 1] - Omega_[i];
    slope_[i] = ((speed_[i] - speed_[i - 1]) / h0 * h1 + (speed_[i + 1] - speed_[i]) / h1 * h0) / (h0 + h1);
  }
  if (n > 1) slope_[n - 1] = (speed_[n - 1] - speed_[n - 2]) / (Omega_[n - 1] - Omega_[n - 2]);
}

double PochhammerChreeMode::speed(double Omega) const {
  if (Omega >= Omega_.back()) return speed_.back();
  const auto i = std::size_t(std::upper_bound(Omega_.begin(), Omega_.end(), Omega) - Omega_.begin()) - 1;
  const double h = Omega_[i + 1] - Omega_[i], w = (Omega - Omega_[i]) / h, w2 = w * w, w3 = w2 * w;
  return (2 * w3 - 3 * w2 + 1) * speed_[i] + (w3 - 2 * w2 + w) * h * slope_[i] + (3 * w2 - 2 * w3) * speed_[i + 1] + (w3 - w2) * h * slope_[i + 1];
}

double love_speed(double Omega, double poisson) { return std::sqrt(std::max(0.0, 1 - 0.5 * poisson * poisson * Omega * Omega)); }

}  // namespace calomel
