#include "apps/report/sections/sensitivity_tables.hpp"

#include <gmock/gmock.h>

#include <string>
#include <variant>

#include "apps/report/data/study.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;

TEST(ReportSensitivity, TablesHoldTheNumbersOfTheSummary) {
  const auto dir = scratch("sensitivity_tables");
  const auto in = input();
  write_sensitivity(dir, in);
  const Study study = read_study(dir);
  const Table by_record = total_order_table(study, "record");
  ASSERT_EQ(by_record.rows.size(), in.sensors.size() + 1);
  EXPECT_EQ(std::get<std::string>(by_record.rows[0][3].value), "0.65 (0.64 to 0.66)");
  EXPECT_TRUE(by_record.rows[0][3].strong);
  EXPECT_FALSE(by_record.rows[0][2].strong);
  EXPECT_EQ(std::get<std::string>(by_record.rows.back()[0].value), "all records");
  write_tables_csv(dir, in);
  const auto csv = csv_of(dir / "report_csv" / "sensitivity.csv");
  ASSERT_EQ(csv.size(), 1 + 3 * (in.sensors.size() + 1));
  EXPECT_EQ(csv[1][0], "all records");
  EXPECT_EQ(number_in(csv, 3, "first_order"), -0.02);  // gauge B: below 0 and not clipped
  const auto effects = csv_of(dir / "report_csv" / "sensitivity_morris.csv");
  ASSERT_EQ(effects.size(), 1 + 9 * in.sensors.size());
  EXPECT_NEAR(number_in(effects, 1, "mu_star"), 20, 1e-9);  // microstrain
  EXPECT_NEAR(number_in(effects, 4, "mu_star"), 1, 1e-9);   // microseconds
}
