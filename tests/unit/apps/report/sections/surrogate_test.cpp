#include "apps/report/sections/surrogate.hpp"

#include <gmock/gmock.h>

#include <variant>

#include "apps/report/data/study.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;

TEST(ReportSurrogates, ErrorsAreInMicrostrain) {
  const auto dir = scratch("surrogates");
  write_train(dir);
  const Table t = surrogate_table(read_study(dir), input());
  EXPECT_THAT(t.columns[4].title, HasSubstr("\u00b5\u03b5"));
  EXPECT_NEAR(std::get<double>(t.rows[0][4].value), 15.9, 1e-12);
  EXPECT_NEAR(std::get<double>(t.rows[1][5].value), 1.6 * 3.1, 1e-12);
}
