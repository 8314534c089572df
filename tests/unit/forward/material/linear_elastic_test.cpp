#include "forward/material/linear_elastic.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace calomel;

TEST(LinearElastic, LameConstantsGiveBackYoungsModulus) {
  for (const double nu : {-0.5, 0.0, 0.29, 0.45}) {
    const auto s = LinearElastic::from_young(193e9, nu);
    EXPECT_NEAR(s.young(), 193e9, 1e-3);
    EXPECT_NEAR(s.lambda / (2 * (s.lambda + s.mu)), nu, 1e-12);
  }
}

// 316L: c_L 5 637 m/s, Z 44.87 MRayl (physics.md section 2).
TEST(LinearElastic, TheDefaultSteelHasThePublishedWaveSpeedAndImpedance) {
  const SteelOptions o;
  const double speed = std::sqrt(LinearElastic::from_young(o.young, o.poisson).longitudinal_modulus() / o.density);
  EXPECT_NEAR(speed, 5637, 1);
  EXPECT_NEAR(speed * o.density, 44.87e6, 0.01e6);
}
