#include "apps/report/traces.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "base/json.hpp"
#include "tests/unit/apps/report_reading.hpp"
#include "tests/unit/apps/report_study.hpp"

using namespace calomel;
using namespace calomel::testing_report;

TEST(ReportTraces, ThinningKeepsTheGreatestAndLeastValue) {
  std::vector<double> t, y;
  for (int i = 0; i < 10007; ++i) t.push_back(i), y.push_back(std::sin(i * 0.01));
  y[5003] = 40, y[5004] = -50;
  const Thinning thin(t.size(), 500);
  const auto times = thin.times(t), values = thin.extremes(y);
  ASSERT_EQ(times.size(), values.size());
  EXPECT_LE(values.size(), 502u);
  EXPECT_EQ(*std::max_element(values.begin(), values.end()), 40);
  EXPECT_EQ(*std::min_element(values.begin(), values.end()), -50);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_EQ(std::set<double>(times.begin(), times.end()).size(), times.size());
  for (std::size_t n = 501; n < 540; ++n) {  // whatever the size of the last window
    const Thinning odd(n, 500);
    EXPECT_EQ(odd.times(std::span(t).first(n)).size(), odd.extremes(std::span(y).first(n)).size()) << n;
  }
}

TEST(ReportTraces, InterpolationGivesSamplesExactlyAndNothingOutside) {
  const std::vector<double> t{0, 1, 2}, y{5, 7, std::nan("")}, at{-0.5, 0, 0.5, 1, 1.5, 2.5};
  const auto v = interpolated(t, y, at);
  EXPECT_TRUE(std::isnan(v[0]));
  EXPECT_EQ(v[1], 5);
  EXPECT_EQ(v[2], 6);
  EXPECT_EQ(v[3], 7);  // although its neighbour is absent
  EXPECT_TRUE(std::isnan(v[4]));
  EXPECT_TRUE(std::isnan(v[5]));
}

TEST(ReportTraces, ALongStudyIsThinnedUntilThePageFits) {
  const auto dir = scratch("long");
  auto in = input();
  const auto sensors = in.sensors;
  for (int copy = 1; copy < 20; ++copy)
    for (auto s : sensors) s.name += std::to_string(copy), in.sensors.push_back(s);
  write_calibration(dir, in, "enc", 2e-7);  // 120 sensors of 3001 samples
  const std::string page = report_of(dir, in);
  EXPECT_LT(page.size(), 10'000'000u);
  const Json data = data_of(page);
  EXPECT_TRUE(data["histories"]["thinned"].get<bool>());
  EXPECT_EQ(data["histories"]["conditions"][0]["sensors"].size(), 120u);
}
