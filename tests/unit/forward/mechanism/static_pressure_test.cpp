#include "forward/mechanism/static_pressure.hpp"

#include <gtest/gtest.h>

#include "forward/target/built_in_model.hpp"
#include "tests/unit/forward/target/small_case.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

ForwardCase with(double pressure, double cutoff) {
  ForwardCase c = small_case("[mechanism.static_pressure]\nenabled = true\npressure = " + number_text(pressure) + "\n");
  c.mercury.tensile_cutoff = cutoff;
  return c;
}

std::vector<double> histories(const ForwardCase& c) {
  const auto p = BuiltInModel(c, {.pulses = 2}).evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return p.mean;
}

}  // namespace

// The motion depends on the sum only: the histories have the same bytes however the sum is divided between cutoff and pressure.
TEST(StaticPressure, OnlyItsSumWithTheCutoffIsInTheMotion) {
  const auto sum = histories(with(0, 3.5e5));
  EXPECT_EQ(histories(with(2e5, 1.5e5)), sum);
  EXPECT_EQ(histories(with(3.5e5, 0)), sum);
  EXPECT_NE(histories(with(0, 1.5e5)), sum);  // control
  EXPECT_NE(histories(with(1e5, 3.5e5)), sum);
}

// The same holds where mercury meets a wall; a linear liquid remains linear.
TEST(StaticPressure, ReachesWallsAndLeavesALinearLiquidAlone) {
  const auto setup_of = [](const ForwardCase& c) {
    const BuiltInModel model(c, {.pulses = 1});
    return model.setup(model.forward_case(), model.mesh(), 0, {1.0});
  };
  const RunSetup s = setup_of(with(2e5, 1.5e5));
  EXPECT_EQ(s.liquid.tensile_cutoff, 3.5e5);
  EXPECT_EQ(s.wetted_cutoff, 3.5e5);
  ForwardCase linear = with(2e5, 1.5e5);
  linear.mercury.law = "linear";
  EXPECT_TRUE(std::isinf(setup_of(linear).liquid.tensile_cutoff));
}

TEST(StaticPressure, IsReportedAsTheEffectiveCutoff) {
  const auto notes = BuiltInModel(with(2e5, 1.5e5), {.pulses = 1}).describe().notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const auto& n) { return n.find("effective tensile cutoff 350000 Pa") != std::string::npos; }));
  for (const auto& n : BuiltInModel(small_case(), {.pulses = 1}).describe().notes) EXPECT_EQ(n.find("effective tensile cutoff"), std::string::npos);
}
