#include "forward/repeatability.hpp"

#include <gtest/gtest.h>

#include "tests/unit/forward/small_case.hpp"

using namespace calomel;
using calomel::testing::small_case;

namespace {
const FloorOptions options{.members = 4, .mesh_jitter = 0.15, .window = 10e-6};
}

TEST(Floor, DependsOnTheSeedAloneNotOnThreads) {
  const ForwardCase c = small_case();
  const auto one = measure_floor(c, {}, options, 7, 1), two = measure_floor(c, {}, options, 7, 2), other = measure_floor(c, {}, options, 8, 2);
  EXPECT_EQ(one.sd, two.sd);
  EXPECT_NE(one.sd, other.sd);
}

TEST(Floor, HasAWindowForEveryStretchOfTheRecord) {
  const ForwardCase c = small_case();
  const auto floor = measure_floor(c, {}, options, 7, 2);
  ASSERT_EQ(floor.window_begin.size(), std::size_t(std::ceil(c.time.end / options.window - 1e-9)));
  EXPECT_EQ(floor.window_begin.front(), 0);
  EXPECT_DOUBLE_EQ(floor.window_end.back(), c.time.end);
  EXPECT_EQ(floor.sd.size(), floor.window_begin.size() * c.sensors.size());
  EXPECT_GT(floor.mean, 0);
  EXPECT_GE(floor.worst, floor.mean);
}

TEST(Floor, GrowsWithTheJitterOfTheMesh) {
  const ForwardCase c = small_case();
  FloorOptions still = options;
  still.mesh_jitter = 0;
  EXPECT_GT(measure_floor(c, {}, options, 7, 2).mean, measure_floor(c, {}, still, 7, 2).mean);
}

TEST(Floor, NeedsThreeMembers) {
  FloorOptions few = options;
  few.members = 2;
  EXPECT_THROW((void)measure_floor(small_case(), {}, few, 7, 1), ContractFailure);
}
