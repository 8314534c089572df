#include "apps/report/sections/comparison.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <variant>

#include "apps/report/data/study.hpp"
#include "apps/report/report.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

TEST(ReportComparison, DifferencesBeyondTwoStandardDeviationsAreBold) {
  const auto dir = two_methods("apart");
  const Table t = agreement_table(read_study(dir));  // cutoff 85642 and 53300, density 10345 and 7720, sound speed 2020 and 2449
  ASSERT_EQ(t.columns.size(), 3u);
  EXPECT_NEAR(std::get<double>(t.rows[1][2].value), (7720 - 10345) / 400.0, 1e-12);
  EXPECT_TRUE(t.rows[1][2].strong);
  EXPECT_THAT(t.note, HasSubstr("ENC lies outside the posterior"));
  Json map = read_json(dir / "map.json");
  map["theta"] = read_json(dir / "enc.json")["theta"];
  map["theta"]["density"] = 10345 + 300;
  write_json(dir / "map.json", map);
  const Table near = agreement_table(read_study(dir));
  EXPECT_NEAR(std::get<double>(near.rows[1][2].value), 0.75, 1e-12);
  EXPECT_FALSE(near.rows[1][2].strong);
  EXPECT_THAT(near.note, testing::AllOf(HasSubstr("ENC lies within the posterior"), Not(HasSubstr("outside"))));
}

// Without correlation d^2 is the sum of the squares in each parameter's deviation.
TEST(ReportComparison, AnswersHaveTheirPlaceInThePosterior) {
  const auto dir = two_methods("place");
  const Table t = place_table(read_study(dir));
  ASSERT_EQ(t.rows.size(), 1u);
  const double d = std::sqrt(std::pow((85642.0 - 53300) / 1000, 2) + std::pow((10345.0 - 7720) / 400, 2) + std::pow((2020.0 - 2449) / 50, 2));
  EXPECT_NEAR(std::get<double>(t.rows[0][1].value), d, 1e-9);
  EXPECT_TRUE(t.rows[0][1].strong);
  Json map = read_json(dir / "map.json");
  map["theta"] = read_json(dir / "enc.json")["theta"];
  map["theta"]["density"] = 10345 + 300;
  write_json(dir / "map.json", map);
  const Table near = place_table(read_study(dir));
  EXPECT_NEAR(std::get<double>(near.rows[0][1].value), 0.75, 1e-12);
  EXPECT_FALSE(near.rows[0][1].strong);
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"), HasSubstr("Share of it that lies nearer"));
  map.erase("covariance");
  write_json(dir / "map.json", map);
  EXPECT_TRUE(place_table(read_study(dir)).empty());
}

TEST(ReportComparison, ANestedModelHasOneRow) {
  const auto dir = two_methods("hypotheses");
  EXPECT_TRUE(hypothesis_table(read_study(dir)).empty());
  Json map = read_json(dir / "map.json");
  map["nested_model"] = {{"with", "base.out"},
                         {"added", {"width", "offset"}},
                         {"log_bayes_factor", 30.0},
                         {"low", 28.6},
                         {"high", 31.4},
                         {"chi2", 90.0},
                         {"nested_chi2", 150.0},
                         {"emulator_variance", 0.125},
                         {"nested_emulator_variance", 0.25},
                         {"verdict", "favoured"},
                         {"sentence", "the records favour width and offset over base.out"}};
  write_json(dir / "map.json", map);
  const Table t = hypothesis_table(read_study(dir));
  ASSERT_EQ(t.rows.size(), 1u);
  ASSERT_EQ(t.rows[0].size(), t.columns.size());
  EXPECT_EQ(std::get<std::string>(t.rows[0][1].value), "width, offset");
  const double numbers[] = {30, 28.6, 31.4, 90, 150, 0.125, 0.25};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(std::get<double>(t.rows[0][2 + i].value), numbers[i]) << t.columns[2 + i].key;
  EXPECT_EQ(t.note, "the records favour width and offset over base.out");
}

TEST(ReportComparison, OneCalibrationIsNotCompared) {
  const auto dir = scratch("one");
  write_calibration(dir, input(), "enc");
  EXPECT_TRUE(agreement_table(read_study(dir)).empty());
  EXPECT_TRUE(effort_table(read_study(dir)).empty());
}
