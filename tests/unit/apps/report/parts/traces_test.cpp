#include "apps/report/parts/traces.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "apps/report/data/study.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;

namespace {

std::vector<std::string> keys_of(const Json& histories) {
  std::vector<std::string> keys;
  for (const auto& s : histories["series"]) keys.push_back(s["key"].get<std::string>());
  return keys;
}

}  // namespace

TEST(ReportTraces, ALongStudyIsThinnedUntilThePageFits) {
  const auto dir = scratch("long");
  auto in = input();
  const auto sensors = in.sensors;
  for (int copy = 1; copy < 20; ++copy)
    for (auto s : sensors) {
      s.name += std::to_string(copy);
      in.sensors.push_back(s);
    }
  write_calibration(dir, in, "enc", 2e-7);  // 120 sensors of 3001 samples
  const std::string page = report_of(dir, in);
  EXPECT_LT(page.size(), 10'000'000u);
  const Json data = data_of(page);
  EXPECT_TRUE(data["histories"]["thinned"].get<bool>());
  EXPECT_EQ(data["histories"]["conditions"][0]["sensors"].size(), 120u);
}

TEST(ReportDiagnosis, DrawsEveryRecordWithBaseExplanationAndPrediction) {
  const auto dir = scratch("histories");
  const auto in = input();
  const Json named = diagnosis_histories_json(diagnosed(dir, "named"), in, 3000);
  EXPECT_THAT(keys_of(named), ElementsAre("measured", "base", "explained", "held_out_explained", "held_out_base"));
  EXPECT_EQ(named["series"][2]["label"], "simulation with beam_profile");
  EXPECT_FALSE(named["series"][3]["hidden"].get<bool>());
  EXPECT_TRUE(named["series"][4]["hidden"].get<bool>());
  ASSERT_EQ(named["conditions"][0]["sensors"].size(), in.sensors.size());
  EXPECT_EQ(named["scores"]["F"], "misfit 20.0\u00a0% \u2192 6.0\u00a0%, left out 25.0\u00a0% \u2192 12.5\u00a0%");
  const auto gauge = named["conditions"][0]["sensors"][2];
  EXPECT_NEAR(gauge["base"][200].get<double>(), 0.6e6 * wave(2e-4, 2, 1), 0.1);
  EXPECT_NEAR(gauge["measured"][200].get<double>(), 1e6 * wave(2e-4, 2, 1), 0.1);

  const Json unknown = diagnosis_histories_json(diagnosed(dir, "unknown"), in, 3000);
  EXPECT_EQ(unknown["series"][2]["label"], "simulation with beam_profile (nearest, not named)");
  const Json none = diagnosis_histories_json(diagnosed(dir, "none"), in, 3000);
  EXPECT_THAT(keys_of(none), ElementsAre("measured", "base", "held_out_base"));
  EXPECT_FALSE(none["series"][2]["hidden"].get<bool>());
  EXPECT_EQ(none["scores"]["F"], "misfit 20.0\u00a0%, left out 25.0\u00a0%");
}
