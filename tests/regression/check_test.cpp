// `calomel check` as a whole: a screenful for people, the resolved case as JSON when it is requested.
#include <algorithm>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using ::testing::HasSubstr;
using ::testing::Not;

namespace {

const std::string more = R"([parameter.density]
min = 13000.0
max = 13600.0
[mechanism.liquid_viscosity]
enabled = true
[mechanism.structural_damping]
enabled = true
mass = 100.0
[campaign]
runs = 40
)";

}  // namespace

TEST(Check, PrintsThePlannedRunsAndTheirCostInAScreenful) {
  const auto dir = folder_with("check", {{"case.toml", slice_case + more}});
  const auto out = printed(dir, "check case.toml");
  EXPECT_EQ(out.status, 0);
  EXPECT_LT(std::count(out.said.begin(), out.said.end(), '\n'), 20);
  EXPECT_THAT(out.said, Not(HasSubstr("{")));
  for (const char* part : {"case: slice, box in plane strain", "elements", "steps of",
                           "load: ", "pulse: ", "mechanisms: liquid_viscosity (at its off values), structural_damping\n",
                           "parameters: density 1.3e+04 to 1.36e+04", "study: campaign of 40 ensemble means of 8", "calibrate by enc", "cost on "})
    EXPECT_THAT(out.said, HasSubstr(part));
  EXPECT_THAT(run(dir, "check case.toml").said, HasSubstr("warning: "));  // warnings go where errors go
  EXPECT_EQ(printed(dir, "check case.toml --quiet").said, out.said);      // what was requested is no note
  EXPECT_FALSE(std::filesystem::exists(dir / "case.out"));
}

TEST(Check, RefusesAPulseThatMissesTheTarget) {
  const auto dir = folder_with("check_beam", {{"case.toml", slice_case + more}});
  const auto out = run(dir, "check case.toml --set load.profile.center=[0,27]");
  EXPECT_EQ(out.status, 2);
  EXPECT_THAT(out.said,
              testing::AllOf(HasSubstr("load.profile.center"), HasSubstr("heats nothing"), HasSubstr("the target reaches from z = 0 to"), HasSubstr("metres")));
}

TEST(Check, WarnsOfImplausibleNumbers) {
  const auto dir = folder_with("check_units", {{"case.toml", slice_case + more}});
  EXPECT_THAT(run(dir, "check case.toml --set load.peak_pressure=25").said, HasSubstr("load.peak_pressure = 25 Pa is next to nothing"));
  EXPECT_THAT(run(dir, "check case.toml --set geometry.element_size=2").said, HasSubstr("larger than the target"));
}

TEST(Check, ComparesTimesAndUnitsWithTheRecords) {
  std::string records = "sensor,pulse,time_s,strain\n";
  for (const char* pulse : {"1", "2"})
    for (int i = 0; i <= 20; ++i) records += std::string("A,") + pulse + ',' + std::to_string(i) + "e-6," + std::to_string(i) + "e-7\n";
  const auto dir = folder_with("check_records", {{"case.toml", slice_case + more + "[recordings]\nfile = \"records.csv\"\n"}, {"records.csv", records}});
  EXPECT_THAT(run(dir, "check case.toml --set time.end=1e-4").said, HasSubstr("ends at 0.0001 s and the records at 2e-05 s"));
  EXPECT_THAT(printed(dir, "check case.toml").said, HasSubstr("a diagnosis makes at most 2000 runs"));
  EXPECT_THAT(run(dir, "check case.toml --set errors.band=20").said, testing::AllOf(HasSubstr("errors.band = 20 Hz"), HasSubstr("from 2.5e+04 Hz on")));
  EXPECT_THAT(run(dir, "check case.toml --set recordings.unit=microstrian").said,
              testing::AllOf(HasSubstr("recordings.unit"), HasSubstr("did you mean \"microstrain\"?")));
}

TEST(Check, RefusesMicrostrainDeclaredAsStrain) {
  std::string records = "sensor,pulse,time_s,strain\n";
  for (const char* pulse : {"1", "2"})
    for (int i = 0; i <= 20; ++i) records += std::string("A,") + pulse + ',' + std::to_string(i) + "e-6," + std::to_string(i) + "\n";
  const auto dir = folder_with("check_microstrain", {{"case.toml", slice_case + more + "[recordings]\nfile = \"records.csv\"\n"}, {"records.csv", records}});
  const auto out = run(dir, "check case.toml");
  EXPECT_EQ(out.status, 2);
  EXPECT_THAT(out.said, testing::AllOf(HasSubstr("recordings.unit"), HasSubstr("root mean square strain of 11.7"), HasSubstr("write unit = \"microstrain\"")));
  EXPECT_EQ(run(dir, "check case.toml --set recordings.unit=microstrain").status, 0);
}

TEST(Check, WarnsOnceOfMissingRecords) {
  std::string records = "sensor,pulse,time_s,strain\n";
  for (const char* pulse : {"1", "2"})
    for (int i = 0; i <= 20; ++i)
      if (*pulse == '1' || i != 7) records += std::string("A,") + pulse + ',' + std::to_string(i) + "e-6," + std::to_string(i) + "e-7\n";
  const auto dir = folder_with("check_missing", {{"case.toml", slice_case + more + "[recordings]\nfile = \"records.csv\"\n"}, {"records.csv", records}});
  const auto said = run(dir, "check case.toml").said;
  const auto first = said.find("1 samples are missing");
  ASSERT_NE(first, std::string::npos) << said;
  EXPECT_EQ(said.find("samples are missing", first + 5), std::string::npos) << said;
}

TEST(Check, PrintsTheResolvedCaseOnRequest) {
  const auto dir = folder_with("check_resolved", {{"case.toml", slice_case + more}});
  const auto out = printed(dir, "check case.toml --resolved --set campaign.runs=41");
  EXPECT_EQ(out.status, 0);
  const auto json = calomel::Json::parse(out.said);  // nothing else on stdout
  EXPECT_EQ(json["material"]["mercury"]["density"], 13500.0);
  EXPECT_EQ(json["campaign"]["runs"], 41);
  EXPECT_EQ(json["solver"]["precision"], "double");
  EXPECT_THAT(run(dir, "check case.toml --resolved").said, HasSubstr("cost on "));
}
