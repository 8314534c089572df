#include "apps/report/parts/table.hpp"

#include <gmock/gmock.h>

using namespace calomel;

TEST(ReportCsv, QuotesWhatMustBeQuoted) {
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"x\""), "\"say \"\"x\"\"\"");
  EXPECT_EQ(csv_field("plain"), "plain");
}
