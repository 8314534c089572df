#include "apps/report/sections/sensitivity_totals.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <variant>

#include "apps/report/data/study.hpp"
#include "apps/report/sections/sensitivity_tables.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

namespace {

/// Writes the analysis of the other tests with two more quantities: dissipated energy with shares, and a time at the cutoff that does not vary.
void write_totals(const std::filesystem::path& dir) {
  write_sensitivity(dir, input());
  Json json = read_json(dir / "sensitivity.json");
  Json energy = json["quantities"][0], time = energy;
  energy["name"] = "dissipated_energy";
  energy["sensor"] = "";
  energy["unit"] = "J";
  energy["mean"] = 0.25;
  energy["sd"] = 0.05;
  energy["source"] = "a polynomial of order 3 fitted to 60 runs at pulse energy 1";
  energy["left_out_r2"] = 0.42;
  energy["note"] = "the polynomial does not follow <the runs>";
  energy["polynomial"]["left_out_r2"] = 0.42;
  for (auto& e : energy["morris"]) e["mu_star"] = 0.125;
  time["name"] = "time_at_cutoff";
  time["sensor"] = "";
  time["unit"] = "s";
  time["note"] = "it is 0 s in all 60 runs: it does not vary";
  time.erase("polynomial");
  for (auto& i : time["total_order"]) i["value"] = i["low"] = i["high"] = nullptr;
  for (auto& e : time["morris"]) e["mu_star"] = e["sigma"] = e["mu"] = 0.0;
  const Json whole = json["quantities"].back();
  json["quantities"].back() = energy;
  json["quantities"].push_back(time);
  json["quantities"].push_back(whole);
  write_json(dir / "sensitivity.json", json);
}

}  // namespace

TEST(ReportSensitivity, TotalsOfTheRunAreShownWithTheirPolynomialAndWhyThereAreNone) {
  const auto dir = scratch("sensitivity_totals");
  write_totals(dir);
  const std::string page = report_of(dir, input()), text = markup(page);
  EXPECT_THAT(text, HasSubstr("<strong>dissipated energy</strong>: 0.25\u00a0J in the mean, with a standard deviation of 0.05\u00a0J. Its shares are those of "
                              "a polynomial of order 3 fitted to 60 runs at pulse energy 1, left-out "
                              "R\u00b2 0.420. <strong>the polynomial does not follow &lt;the runs&gt;.</strong>"));
  EXPECT_THAT(text, HasSubstr("<strong>time at the cutoff</strong>: it is 0 s in all 60 runs: it does not vary.</p>"));
  EXPECT_THAT(text, HasSubstr("Total index of each parameter for the dissipated energy"));
  EXPECT_THAT(text, Not(HasSubstr("Total index of each parameter for the time at the cutoff")));
  EXPECT_THAT(text, HasSubstr("follows 18 of the 18 numbers")) << "a total's polynomial is no check of a surrogate";
  EXPECT_THAT(text, HasSubstr("<strong>sound_speed</strong> has a part in 70\u00a0%")) << "all records together stay what they are";
  const Table effects = morris_table(read_study(dir), input());
  const auto energy =
      std::find_if(effects.rows.begin(), effects.rows.end(), [](const auto& row) { return std::get<std::string>(row[0].value) == "dissipated energy"; });
  ASSERT_NE(energy, effects.rows.end());
  EXPECT_EQ(std::get<std::string>((*energy)[1].value), "the run");
  EXPECT_EQ(std::get<std::string>((*energy)[2].value), "J");
  EXPECT_EQ(std::get<double>((*energy)[5].value), 0.125) << "in joules";
  const Json drawn = data_of(page)["sensitivity"]["morris"];
  ASSERT_EQ(drawn.size(), 4u);
  EXPECT_EQ(drawn[3]["title"], "dissipated energy");
  EXPECT_EQ(drawn[3]["unit"], "J");
  EXPECT_EQ(drawn[3]["points"][0]["mu_star"], 0.125);
}

TEST(ReportSensitivity, WithoutTotalsThereIsNoPartOnThem) {
  const auto dir = scratch("sensitivity_no_totals");
  write_sensitivity(dir, input());
  EXPECT_THAT(markup(report_of(dir, input())), Not(HasSubstr("Dissipated energy")));
}
