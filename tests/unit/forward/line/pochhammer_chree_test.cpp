#include "forward/line/pochhammer_chree.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace calomel {
namespace {

TEST(PochhammerChree, FirstModeIsRayleighsAtLowFrequency) {
  // c/c0 = 1 - nu^2 Omega^2 / 4: Rayleigh, Theory of Sound, section 157. The next term is of order Omega^4.
  for (const double nu : {0.1, 0.29, 0.45}) {
    const PochhammerChreeMode mode(nu, 1);
    for (const double Omega : {0.02, 0.06, 0.1})
      EXPECT_NEAR((1 - mode.speed(Omega)) / (nu * nu * Omega * Omega / 4), 1, 0.5 * Omega * Omega + 1e-6) << nu << ", " << Omega;
  }
}

TEST(PochhammerChree, FirstModeIsRayleighsSurfaceWaveAtHighFrequency) {
  const double nu = 0.29;
  // Rayleigh's equation: (2 - s)^2 = 4 sqrt(1 - s) sqrt(1 - s m), s = (c/cT)^2, m = (cT/cL)^2 = (1 - 2 nu)/(2 - 2 nu).
  double low = 0.5, high = 0.999;
  const double m = (1 - 2 * nu) / (2 - 2 * nu);
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high);
    ((2 - s) * (2 - s) < 4 * std::sqrt(1 - s) * std::sqrt(1 - s * m) ? low : high) = s;
  }
  const double surface = std::sqrt(low) / std::sqrt(2 * (1 + nu));
  EXPECT_NEAR(PochhammerChreeMode(nu, 60).speed(60), surface, 0.003 * surface);  // a curved surface, curvature of order 1/Omega
}

TEST(PochhammerChree, FirstModeSolvesTheFrequencyEquationBetweenItsRoots) {
  const PochhammerChreeMode mode(0.285, 6);
  for (double Omega = 0.033; Omega < 4; Omega += 0.05) {
    const double c = mode.speed(Omega), e = 2e-6;
    EXPECT_LT(pochhammer_chree(Omega, c - e, 0.285) * pochhammer_chree(Omega, c + e, 0.285), 0) << Omega;
    EXPECT_GT(std::abs(pochhammer_chree(Omega, c - 1e-3, 0.285)), 50 * std::abs(pochhammer_chree(Omega, c, 0.285)))
        << Omega;  // the control: another speed does not
  }
}

TEST(PochhammerChree, FirstModeIsFollowedForAnyPoissonsRatio) {
  for (const double nu : {0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.33, 0.4, 0.45, 0.49}) {
    const PochhammerChreeMode mode(nu, 25);
    const double shear = 1 / std::sqrt(2 * (1 + nu));
    EXPECT_NEAR(mode.speed(0.1), 1 - nu * nu * 0.0025, 1e-5) << nu;
    EXPECT_LT(mode.speed(25), shear) << nu;  // slower than shear waves: the surface wave, not a higher mode
    EXPECT_GT(mode.speed(25), 0.85 * shear) << nu;
  }
  EXPECT_NEAR(PochhammerChreeMode(0.001, 25).speed(25), 1, 1e-3);  // the corner at 1.84 is passed
}

// A fit begins at a ratio of 0, and a record in steps of 50 ns on a thick bar requests Omega of some hundreds, where the Bessel functions overflow.
TEST(PochhammerChree, FirstModeIsFollowedFromTheSmallestRatioToTheHighestFrequency) {
  for (const double nu : {0.001, 0.002, 0.005, 0.01, 0.012, 0.014, 0.016, 0.018})
    EXPECT_LT(PochhammerChreeMode(nu, 80).speed(80), 1.001) << nu;  // of the smallest the corner at 1.84 is passed
  for (const double nu : {0.05, 0.29, 0.49}) {
    const PochhammerChreeMode mode(nu, 900);
    EXPECT_NEAR(mode.speed(900), mode.speed(450), 2e-3) << nu;  // the surface wave's
  }
}

TEST(PochhammerChree, WithoutPoissonsRatioDoesNotDisperse) {
  const PochhammerChreeMode mode(0, 5);
  for (const double Omega : {0.0, 0.3, 2.0, 5.0, 7.0}) EXPECT_EQ(mode.speed(Omega), 1);
}

TEST(PochhammerChree, LovesRodIsItsBeginning) {
  const PochhammerChreeMode mode(0.29, 1);
  EXPECT_NEAR(love_speed(0.1, 0.29), mode.speed(0.1), 1e-6);
  EXPECT_GT(std::abs(love_speed(1, 0.29) - mode.speed(1)), 1e-3);
}

}  // namespace
}  // namespace calomel
