#include "apps/report/parts/numbers.hpp"

#include <gmock/gmock.h>

#include <cmath>

using namespace calomel;

TEST(ReportTables, NumbersReadAsAPersonWouldWriteThem) {
  EXPECT_EQ(number_html(0, 4).str(), "0");
  EXPECT_EQ(number_html(1450, 4).str(), "1450");
  EXPECT_EQ(number_html(13546.4, 4).str(), "13\u202f546");
  EXPECT_EQ(number_html(0.5, 4).str(), "0.5");
  EXPECT_EQ(number_html(-0.12345, 3).str(), "\u22120.123");
  EXPECT_EQ(number_html(2.0897e7, 4).str(), "2.09\u00b710<sup>7</sup>");
  EXPECT_EQ(number_html(7e-7, 4).str(), "7\u00b710<sup>\u22127</sup>");
  EXPECT_EQ(number_html(9999.96, 5).str(), "10\u202f000");
  EXPECT_EQ(fixed_html(-0.04, 1).str(), "0.0");
  EXPECT_EQ(number_html(std::nan(""), 4).str(), "\u2013");
}
