#include <gmock/gmock.h>

#include <algorithm>

#include "apps/report/table.hpp"
#include "base/netcdf_file.hpp"
#include "tests/unit/apps/report_reading.hpp"
#include "tests/unit/apps/report_study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;

TEST(ReportCsv, ScoresEqualTheSummary) {
  const auto dir = scratch("scores");
  const auto in = input();
  write_study(dir, in);
  write_calibration(dir, in, "spe");
  const auto paths = write_tables_csv(dir, in);
  const Json enc = read_json(dir / "enc.json"), spe = read_json(dir / "spe.json");
  for (const std::string key : {"accuracy", "mae"}) {
    const auto csv = csv_of(dir / "report_csv" / (key + ".csv"));
    ASSERT_EQ(csv.size(), in.sensors.size() + 1);
    for (std::size_t i = 0; i < in.sensors.size(); ++i) {
      EXPECT_EQ(csv[i + 1][0], in.sensors[i].name);
      EXPECT_EQ(number_in(csv, i, "enc"), enc["sensors"][i][key].get<double>());
      EXPECT_EQ(number_in(csv, i, "spe"), spe["sensors"][i][key].get<double>());
      EXPECT_EQ(number_in(csv, i, "nominal"), enc["sensors"][i]["nominal_" + key].get<double>());
    }
  }
  for (const auto& p : paths) EXPECT_TRUE(std::filesystem::exists(p)) << p;
}

TEST(ReportCsv, ParametersRoundsCandidatesAndTracesEqualTheSummary) {
  const auto dir = scratch("tables");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  const Json enc = read_json(dir / "enc.json");
  const auto parameters = csv_of(dir / "report_csv/parameters.csv");
  for (std::size_t i = 0; i < in.parameters.size(); ++i) {
    EXPECT_EQ(number_in(parameters, i, "enc"), enc["theta"][in.parameters[i].name].get<double>());
    EXPECT_EQ(number_in(parameters, i, "max"), in.parameters[i].max);
  }
  EXPECT_DOUBLE_EQ(number_in(parameters, 3, "enc"), 10345.0 * 2020.0);  // impedance
  EXPECT_DOUBLE_EQ(number_in(parameters, 3, "nominal"), 13500.0 * 1450.0);

  const auto rounds = csv_of(dir / "report_csv/rounds.csv");
  ASSERT_EQ(rounds.size(), enc["rounds"].size() + 1);
  for (std::size_t i = 0; i < enc["rounds"].size(); ++i) {
    EXPECT_EQ(number_in(rounds, i, "objective"), enc["rounds"][i]["objective"].get<double>());
    EXPECT_EQ(number_in(rounds, i, "density"), enc["rounds"][i]["theta"]["density"].get<double>());
  }
  const auto candidates = csv_of(dir / "report_csv/candidates.csv");
  for (std::size_t i = 0; i < enc["candidates"].size(); ++i)
    EXPECT_EQ(number_in(candidates, i, "objective_model"), enc["candidates"][i]["objective_model"].get<double>());
  const auto traces = csv_of(dir / "report_csv/convergence.csv");
  EXPECT_EQ(traces.size(), 1u + 4 * 101);
  EXPECT_EQ(number_in(traces, 101, "objective"), enc["optimizers"][1]["trace"][0].get<double>());
  const auto failed = csv_of(dir / "report_csv/failed_runs.csv");
  EXPECT_EQ(failed.size(), 4u);
  EXPECT_EQ(number_in(failed, 0, "run"), 3);
}

TEST(ReportCsv, HistoriesAreWholeAndInMicrostrain) {
  const auto dir = scratch("histories");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  const auto csv = csv_of(dir / "report_csv/histories.csv");
  EXPECT_THAT(csv[0], ElementsAre("condition", "sensor", "time_s", "measured_mean", "band_low", "band_high", "nominal", "enc"));
  ASSERT_EQ(csv.size(), 1 + in.sensors.size() * 601);
  const NetcdfReader file(dir / "enc.nc");
  const auto calibrated = file.doubles("calibrated"), mean = file.doubles("record_mean");
  for (const std::size_t k : {0u, 100u, 500u}) {
    EXPECT_DOUBLE_EQ(number_in(csv, 601 + k, "enc"), calibrated[601 + k] * 1e6);
    EXPECT_DOUBLE_EQ(number_in(csv, 601 + k, "measured_mean"), mean[501 + k] * 1e6);
  }
  EXPECT_EQ(csv[1 + 601][1], in.sensors[1].name);
  EXPECT_EQ(csv[1 + 501][3], "");            // after the end of the records
  EXPECT_EQ(csv[1 + 5 * 601 + 205][3], "");  // within the last sensor's dropout
  EXPECT_NE(csv[1 + 5 * 601 + 205][7], "");  // where the simulation goes on
}

TEST(ReportCsv, ATableOfAStageThatIsGoneDoesNotStay) {
  const auto dir = scratch("stale");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  ASSERT_TRUE(std::filesystem::exists(dir / "report_csv/accuracy.csv"));
  std::filesystem::remove(dir / "enc.json");
  const auto paths = write_tables_csv(dir, in);
  EXPECT_FALSE(std::filesystem::exists(dir / "report_csv/accuracy.csv"));
  EXPECT_EQ(std::count(paths.begin(), paths.end(), dir / "report_csv/accuracy.csv"), 0);
}

TEST(ReportCsv, QuotesWhatMustBeQuoted) {
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"x\""), "\"say \"\"x\"\"\"");
  EXPECT_EQ(csv_field("plain"), "plain");
}
