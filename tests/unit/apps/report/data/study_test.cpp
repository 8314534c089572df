#include "apps/report/data/study.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;

TEST(ReportStudy, PredictedBandsContainDrawsAndErrors) {
  const auto dir = scratch("posterior_bands");
  const auto in = input();
  write_sample_and_predictions(dir, in, ridge_draws());
  const Study study = read_study(dir);
  ASSERT_TRUE(study.predictive.has_value());
  const Histories& h = *study.predictive;
  const std::size_t at = 2 * h.record_time.size() + 150;  // the third gauge
  const double y = wave(150e-6, 2, 1), sd = std::abs(y) * 0.1 / std::sqrt(3.0);
  EXPECT_NEAR(h.predicted[at], y, 1e-9);
  EXPECT_NEAR(h.draws_high[at] - h.draws_low[at], 0.18 * std::abs(y), 0.003 * std::abs(y));  // 90 % of an even range of 20 %
  EXPECT_NEAR(h.predicted_high[at] - y, 1.645 * std::hypot(sd, 20e-6), 0.02 * std::hypot(sd, 20e-6));
  const std::string page = report_of(dir, in);
  const Json data = data_of(page)["predictive"];
  EXPECT_EQ(data["conditions"][0]["sensors"][2]["name"], "F");
  EXPECT_EQ(data["series"].size(), 3u);
  EXPECT_EQ(data["scores"]["F"], "100\u00a0% of the record inside");
  EXPECT_THAT(page, HasSubstr("id=\"predictive-plots\""));
  // Without errors only the narrow band is shown, without a share inside.
  write_sample_and_predictions(dir, in, ridge_draws(), false);
  const Json narrow = data_of(report_of(dir, in))["predictive"];
  EXPECT_EQ(narrow["series"].size(), 2u);
  EXPECT_TRUE(narrow["scores"].empty());
}
