#include "apps/report/sections/parameters.hpp"

#include <gmock/gmock.h>

#include <string>
#include <variant>
#include <vector>

#include "apps/report/data/study.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;

TEST(ReportComparison, TheParameterTableHasTheNominalValuesFirstAndMapsStandardDeviations) {
  const auto dir = two_methods("sds");
  const Table t = parameter_table(read_study(dir), input());
  std::vector<std::string> keys;
  for (const auto& c : t.columns) keys.push_back(c.key);
  EXPECT_THAT(keys, testing::ElementsAre("parameter", "unit", "nominal", "enc", "map", "map_sd", "enc_change_percent", "map_change_percent", "min", "max"));
  EXPECT_EQ(std::get<double>(t.rows[1][5].value), 400);
  for (const auto& row : t.rows) EXPECT_EQ(row.size(), t.columns.size());
}
