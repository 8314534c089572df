#include "apps/report/data/series.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <vector>

using namespace calomel;

TEST(ReportSeries, ThinningKeepsTheGreatestAndLeastValue) {
  std::vector<double> t, y;
  for (int i = 0; i < 10007; ++i) {
    t.push_back(i);
    y.push_back(std::sin(i * 0.01));
  }
  y[5003] = 40;
  y[5004] = -50;
  const Thinning thin(t.size(), 500);
  const auto times = thin.times(t), values = thin.extremes(y);
  ASSERT_EQ(times.size(), values.size());
  EXPECT_LE(values.size(), 502u);
  EXPECT_EQ(*std::max_element(values.begin(), values.end()), 40);
  EXPECT_EQ(*std::min_element(values.begin(), values.end()), -50);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_EQ(std::set<double>(times.begin(), times.end()).size(), times.size());
  for (std::size_t n = 501; n < 540; ++n) {  // for every size of the last window
    const Thinning odd(n, 500);
    EXPECT_EQ(odd.times(std::span(t).first(n)).size(), odd.extremes(std::span(y).first(n)).size()) << n;
  }
}

TEST(ReportSeries, InterpolationGivesSamplesExactlyAndNothingOutside) {
  const std::vector<double> t{0, 1, 2}, y{5, 7, std::nan("")}, at{-0.5, 0, 0.5, 1, 1.5, 2.5};
  const auto v = interpolated(t, y, at);
  EXPECT_TRUE(std::isnan(v[0]));
  EXPECT_EQ(v[1], 5);
  EXPECT_EQ(v[2], 6);
  EXPECT_EQ(v[3], 7);  // although its neighbour is NaN
  EXPECT_TRUE(std::isnan(v[4]));
  EXPECT_TRUE(std::isnan(v[5]));
}
