// Requests as plain data: their text holds every digit and reads back.
#include "forward/simulation/run_request.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace calomel {
namespace {

RunRequest everything() {
  RunRequest r;
  r.numbers = {{"material.mercury.density", 13534.123456789012}, {"mechanism.vapour.pressure", -std::numeric_limits<double>::infinity()}};
  r.element_size = 1.0 / 3000;
  r.pulses = 3;
  r.energy_shift = 0.1;
  r.viscosity_factor = 0.5;
  r.jitter = MeshJitter{.share = 0.15, .seed = std::numeric_limits<std::uint64_t>::max(), .stream = 0xf100};
  r.refine = 2;
  r.precision = "double";
  r.wanted = {.mean = true, .pulses = true, .energy_balance = true, .totals = true};
  return r;
}

TEST(RunRequest, ReadsBackFromItsText) {
  EXPECT_EQ(request_of(text_of(everything())), everything());
  EXPECT_EQ(request_of(text_of(RunRequest{})), RunRequest{});
  RunRequest totals;
  totals.wanted = {.mean = false, .totals = true};
  EXPECT_EQ(request_of(text_of(totals)), totals);
}

TEST(RunRequest, TwoRunsHaveOneTextExactlyWhenTheyAreTheSame) {
  const RunRequest whole = everything();
  RunRequest other = whole;
  other.wanted = {};
  EXPECT_EQ(run_text(other), run_text(whole)) << "the wanted outputs are no part of the run";
  EXPECT_NE(text_of(other), text_of(whole));
  const auto changed = [&](auto&& change) {
    RunRequest r = whole;
    change(r);
    return run_text(r) != run_text(whole);
  };
  EXPECT_TRUE(changed([](RunRequest& r) { r.numbers["material.mercury.density"] = std::nextafter(13534.123456789012, 2e4); }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.element_size.reset(); }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.element_size = 0; }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.pulses = 4; }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.energy_shift.reset(); }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.viscosity_factor = 1; }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.jitter->stream = 1; }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.refine = 1; }));
  EXPECT_TRUE(changed([](RunRequest& r) { r.precision.clear(); }));
}

// A search may end as near to a bound at zero as that.
TEST(RunRequest, ANumberBelowTheSmallestNormalOneReadsBack) {
  RunRequest tiny;
  tiny.numbers = {{"mechanism.drag.coefficient", 3e-320}};
  EXPECT_EQ(request_of(text_of(tiny)), tiny);
}

TEST(RunRequest, ATextThatIsNoRunIsRefused) {
  for (const char* text : {"density", "density=", "density=heavy", "pulses=2.5", "jitter=0.1", "want=everything"})
    EXPECT_THROW((void)request_of(text), ContractFailure) << text;
}

TEST(RunRequest, HoldsTheParametersByTheirKeysWhateverTheirOrder) {
  const std::vector<Parameter> parameters{{.name = "x", .key = "z.x"}, {.name = "y", .key = "a.y"}};
  const RunRequest r = request_at(parameters, std::vector<double>{1.5, -2});
  EXPECT_EQ(r.numbers, (std::map<std::string, double>{{"a.y", -2}, {"z.x", 1.5}}));
  EXPECT_THAT(theta_at(parameters, r), testing::ElementsAre(1.5, -2));
  RunRequest lacking;
  lacking.numbers = {{"a.y", 1}};
  EXPECT_THROW((void)theta_at(parameters, lacking), ContractFailure);
}

TEST(Outputs, CoverWhatIsAmongThem) {
  const Outputs mean, pulses{.mean = true, .pulses = true}, totals{.mean = false, .totals = true};
  EXPECT_TRUE(pulses.cover(mean));
  EXPECT_FALSE(mean.cover(pulses));
  EXPECT_FALSE(pulses.cover(totals));
  EXPECT_TRUE(pulses.with(totals).cover(totals));
  EXPECT_FALSE((Outputs{.mean = false}).any());
}

}  // namespace
}  // namespace calomel
