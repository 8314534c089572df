#include "tests/unit/uq/sampler/calibration.hpp"

#include <gmock/gmock.h>

using namespace calomel;
using namespace calomel::testing;

// Longer: tests/bench/calibration_of_samplers.cpp.
TEST(SimulationBasedCalibration, RanksOfEverySamplerAreUniform) {
  for (const auto& kind : samplers().names()) {
    const auto ranks = calibration_ranks(kind, 120, 1);
    for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(uniformity(ranks[k], 5), 1e-3) << kind << ", coordinate " << k;
  }
}

TEST(SimulationBasedCalibration, ADroppedJacobianShowsInTheRanksOfItsCoordinate) {
  for (const auto& kind : samplers().names()) EXPECT_LT(uniformity(calibration_ranks(kind, 120, 1, false)[1], 5), 1e-3) << kind;
}
