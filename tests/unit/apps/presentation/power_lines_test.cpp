// The sentences about the power of a planned experiment.
#include "apps/presentation/power_lines.hpp"

#include <gmock/gmock.h>

#include <cmath>

using namespace calomel;
using ::testing::ElementsAre;

TEST(PowerLines, ANumberALineAndGaugesTogether) {
  const Detectable beam{.mechanism = "beam_profile",
                        .place = {},
                        .of_gauge = false,
                        .number = "beam_profile.offset_z",
                        .off = 0,
                        .from = 8.9e-4,
                        .farthest = 5e-3,
                        .share = 0.178,
                        .limited_by = {}};
  const Detectable layer{.mechanism = "interface",
                         .place = "top",
                         .of_gauge = false,
                         .number = "interface.strength",
                         .off = 1e6,
                         .from = {},
                         .farthest = 1e3,
                         .share = 2,
                         .limited_by = "wall_thinning (top)"};
  Detectable gain{.mechanism = "sensor_response",
                  .place = "T1",
                  .of_gauge = true,
                  .number = "sensor_response.gain",
                  .off = 1,
                  .from = 1.05,
                  .farthest = 1.15,
                  .share = 0.33,
                  .limited_by = {}};
  PlanPower planned{.plan = {"as planned", {}}, .numbers = {beam, layer, gain}};
  gain.place = "T2";
  gain.from = 1.11;
  gain.share = 0.73;
  planned.numbers.push_back(gain);
  PlanPower more = planned;
  more.plan.name = "with another";
  more.gain = std::log(2.0);
  EXPECT_THAT(power_lines({planned, more}),
              ElementsAre("power: beam_profile.offset_z could be named from 0.00089 on (off at 0, range to 0.005)",
                          "power: interface.strength (top) could not be named up to 1e+03: the records would not distinguish it from wall_thinning (top)",
                          "power: sensor_response.gain of one gauge could be named at 2 of 2 gauges, from 1.05 on at T1, 1.11 at T2 (off at 1, range to 1.15)",
                          "power: as planned: 3 of 4 numbers could be named within their ranges",
                          "power: with another: 3 of 4, strengths needed 0.5 times those as planned (geometric mean)"));
  planned.numbers[3].from.reset();
  planned.numbers[3].share = 2;
  EXPECT_EQ(power_lines({planned})[2],
            "power: sensor_response.gain of one gauge could be named at 1 of 2 gauges, from 1.05 on at T1 (off at 1, range to 1.15)");
}
