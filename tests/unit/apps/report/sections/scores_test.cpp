#include "apps/report/sections/scores.hpp"

#include <gmock/gmock.h>

#include <string>

#include "apps/report/data/study.hpp"
#include "apps/report/sections/header.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

TEST(ReportTables, BoldMarksWhereTheCalibratedSimulationIsAsGoodAsTheNominalOne) {
  const auto dir = scratch("bold");
  const auto in = input();
  write_calibration(dir, in, "enc");  // accuracy 92.25 - 7 s against 70.5; mae 12.125 + 2 s against 18.75
  const Study study = read_study(dir);
  const Table accuracy = score_table(study, in, "accuracy"), mae = score_table(study, in, "mae");
  for (std::size_t s = 0; s < in.sensors.size(); ++s) {
    EXPECT_EQ(accuracy.rows[s][2].strong, 92.25 - 7.0 * double(s) >= 70.5) << s;
    EXPECT_EQ(mae.rows[s][2].strong, 12.125 + 2.0 * double(s) <= 18.75) << s;
  }
  EXPECT_TRUE(accuracy.rows[3][2].strong && !accuracy.rows[4][2].strong);
  EXPECT_THAT(accuracy.html().str(), HasSubstr("<td><strong>92.2</strong></td>"));
  EXPECT_THAT(accuracy.html().str(), HasSubstr("Average"));
}

TEST(ReportTables, CaptionsOfScoresStateACorrectionForTheMesh) {
  const auto dir = scratch("mesh");
  const auto in = input();
  write_calibration(dir, in, "enc");
  write_calibration(dir, in, "map");
  EXPECT_TRUE(mesh_table(read_study(dir), in).empty());
  EXPECT_THAT(score_table(read_study(dir), in, "accuracy").caption, testing::Not(HasSubstr("mesh")));
  Json enc = read_json(dir / "enc.json");
  enc["mesh"] = {{"relative_difference", 0.11}, {"working_mesh", {{"accuracy", 51.5}, {"mae", 18.5}, {"nominal_accuracy", 44.0}, {"nominal_mae", 25.0}}}};
  write_json(dir / "enc.json", enc);
  const Study study = read_study(dir);
  const Table mesh = mesh_table(study, in);
  ASSERT_EQ(mesh.rows.size(), 2u);
  EXPECT_THAT(mesh.csv(), HasSubstr("51.5"));
  EXPECT_THAT(mesh.csv(), HasSubstr("0.11"));
  EXPECT_THAT(score_table(study, in, "mae").html().str(), testing::Not(HasSubstr("51.5")));
  EXPECT_THAT(score_table(study, in, "accuracy").caption, HasSubstr("Simulations of ENC and the nominal one are corrected for the mesh"));
  EXPECT_THAT(score_table(study, in, "accuracy").caption, HasSubstr("the others are on the case\u2019s mesh"));
  const std::string page = header_html(study, in).str();
  EXPECT_THAT(page, HasSubstr("These scores are corrected for the mesh by runs on finer meshes; on the case\u2019s own mesh it is 51.5\u00a0% and 18.5"));
  EXPECT_EQ(page.find("These scores are corrected"), page.rfind("These scores are corrected"));  // MAP is not corrected
}

TEST(ReportTables, NominalScoresBeyondTheEmulatorAreMarked) {
  const auto dir = scratch("nominal_outside");
  write_calibration(dir, input(), "enc");
  EXPECT_THAT(headline_table(read_study(dir), input()).note, Not(HasSubstr("outside the emulator")));
  Json enc = read_json(dir / "enc.json");
  enc["mesh"] = {{"nominal_inside_emulator", false}, {"working_mesh", {{"accuracy", 50.0}, {"mae", 20.0}}}};
  write_json(dir / "enc.json", enc);
  const Study study = read_study(dir);
  EXPECT_THAT(headline_table(study, input()).note, HasSubstr("The nominal point lies outside the emulator\u2019s box (ENC)"));
  EXPECT_THAT(score_table(study, input(), "accuracy").note, HasSubstr("outside the emulator"));
  EXPECT_THAT(mesh_table(study, input()).note, HasSubstr("outside the emulator"));
}

TEST(ReportTables, CaptionsNameTheMeshOfEverySimulation) {
  const auto dir = two_methods("meshes");
  EXPECT_THAT(headline_table(read_study(dir), input()).caption, Not(HasSubstr("mesh")));
  Json enc = read_json(dir / "enc.json"), map = read_json(dir / "map.json");
  map["scores_on"] = "the finest mesh of the emulator";
  write_json(dir / "map.json", map);
  EXPECT_THAT(headline_table(read_study(dir), input()).caption,
              HasSubstr("Simulations of MAP are runs on the finest mesh of the emulator; the others are on the case\u2019s mesh."));
  enc["mesh"] = {{"working_mesh", {{"accuracy", 50.0}, {"mae", 20.0}}}};
  write_json(dir / "enc.json", enc);
  EXPECT_THAT(headline_table(read_study(dir), input()).caption,
              HasSubstr("by runs on finer meshes; those of MAP are runs on the finest mesh of the emulator."));
}
