#include "apps/report/sections/floor.hpp"

#include <gmock/gmock.h>

#include <string>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(ReportFloor, IsShownOrTheCommandThatMeasuresIt) {
  const auto dir = scratch("floor");
  const auto in = input();
  write_study(dir, in);
  const std::string text = markup(report_of(dir, in));
  EXPECT_THAT(text, HasSubstr("here <strong>6.1\u00a0%</strong> of the signal on average over the gauges, 9.2\u00a0% at the worst (&lt;b&gt;"));
  EXPECT_THAT(text, HasSubstr("<strong>9.2</strong>"));
  EXPECT_THAT(text, HasSubstr("0.035"));  // single against double precision [%]
  EXPECT_THAT(text, HasSubstr("left out: that mesh would have too many elements"));
  EXPECT_THAT(text, Not(HasSubstr("No repeatability floor")));

  // Without a campaign the floor comes from check --floor; without that, the page names the command.
  std::filesystem::remove(dir / "campaign.json");
  EXPECT_THAT(markup(report_of(dir, in)), HasSubstr("calomel check slice.toml --floor"));
  write_json(dir / "floor.json", repeatability(in));
  EXPECT_THAT(markup(report_of(dir, in)), HasSubstr("9.2\u00a0% at the worst"));
}

TEST(ReportFloor, ItsTablesEqualTheSummary) {
  const auto dir = scratch("floor_csv");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  const Json all = read_json(dir / "campaign.json")["floor"];
  const auto rows = csv_of(dir / "report_csv/floor.csv");
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(number_in(rows, 0, "mean"), all["mean"].get<double>());
  EXPECT_EQ(number_in(rows, 1, "worst"), all["comparisons"][0]["worst"].get<double>());
  EXPECT_EQ(rows[3][1], "");  // the comparison that was left out has no numbers
  const auto gauges = csv_of(dir / "report_csv/floor_by_gauge.csv");
  EXPECT_THAT(gauges[0], ElementsAre("gauge", "floor", "single_runs", "precision"));
  const auto windows = csv_of(dir / "report_csv/floor_by_window.csv");
  ASSERT_EQ(windows.size(), 3u);
  for (std::size_t s = 0; s < in.sensors.size(); ++s) {
    EXPECT_EQ(gauges[s + 1][0], in.sensors[s].name);
    EXPECT_EQ(number_in(gauges, s, "floor"), all["sensors"][s]["relative"].get<double>());
    EXPECT_EQ(number_in(gauges, s, "single_runs"), all["comparisons"][0]["sensors"][s]["relative"].get<double>());
    EXPECT_EQ(windows[2][s + 2], number_text(all["sensors"][s]["sd"][1].get<double>()));
  }
}
