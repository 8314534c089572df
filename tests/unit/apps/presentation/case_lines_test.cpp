#include "apps/presentation/case_lines.hpp"

#include <gmock/gmock.h>

#include "tests/slice_case.hpp"

using namespace calomel;
using calomel::testing::folder_with;
using calomel::testing::slice_case;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

namespace {

StudyCase study(const std::string& more = "", const std::vector<std::string>& set = {}) {
  return StudyCase::read(folder_with("case_lines", {{"case.toml", slice_case + more}}) / "case.toml", set);
}

/// Made up: nothing is meshed or run.
Description made_up() {
  Description d;
  d.facts = {{"case", "slice, box in plane strain"}, {"model", "1200 elements"}};
  d.cost = RunCost{.run_threads = 1};
  return d;
}

}  // namespace

TEST(CaseLines, ThePlanListsFactsStudyAndCost) {
  const auto c = study("[parameter.density]\nmin = 13000\nmax = 13600\n[campaign]\nruns = 40\n");
  const Description d = made_up();
  EXPECT_THAT(
      plan_lines({.study = c, .model = d, .cost = StudyCost{.run = 30, .campaign = 720, .floor = 12000}, .threads = 4}),
      ElementsAre("case: slice, box in plane strain", "model: 1200 elements",
                  "study: campaign of 40 ensemble means of 8 (chebyshev), train " + c.surrogate.kind + ", calibrate by enc, report",
                  "cost on 4 threads: one run about 30 s; the campaign of 40 ensemble means over 1 parameters about 12 min, its repeatability floor 3 h 20 min",
                  "a single run is too small to gain by more than 1 thread"));
}

TEST(CaseLines, ThePlanLeavesOutWhatTheCaseDoesNotHave) {
  const auto c = study("", {"campaign.floor=false"});
  const Description d = made_up();
  const auto lines = plan_lines({.study = c, .model = d, .cost = StudyCost{}, .threads = 1});
  for (const char* absent : {"recordings: ", "a single run"}) EXPECT_THAT(lines, Not(Contains(StartsWith(absent))));
  EXPECT_THAT(lines, Contains(HasSubstr("a repeatability floor")));
  EXPECT_THAT(plan_lines({.study = c, .model = d}), ElementsAre("case: slice, box in plane strain", "model: 1200 elements")) << "runs that cost nothing";
}

TEST(CaseLines, ThePlanListsRecords) {
  const auto c = study();
  const Description d = made_up();
  Problem problem;
  problem.observations.resize(7);
  problem.time.resize(50);
  EXPECT_THAT(plan_lines({.study = c, .model = d, .problem = &problem}), Contains("recordings: 7 records, compared at 50 times"));
}

TEST(CaseLines, ATargetIsDescribedByItsFacts) {
  const auto lines = [](const std::string& more, const std::vector<std::string>& set = {}) { return fact_lines(study(more, set).simulator->describe().facts); };
  EXPECT_THAT(
      lines("[parameter.density]\nmin = 13000\nmax = 13600\n"),
      ElementsAre("case: slice, box in plane strain",
                  MatchesRegex("model: [0-9]+ elements, [0-9]+ nodes, [0-9]+ steps of .* s, .* sensors at .* times, about .* MB"), StartsWith("load: "),
                  MatchesRegex("pulse: .* J deposited in a slice .* mm thick; regularising viscosity .* Pa s.*"),
                  MatchesRegex("mesh: scaled Jacobian at least 1.000, aspect ratio at most .*, shortest edge .* mm, 2 elements through the thinnest wall.*"),
                  "parameters: density 1.3e+04 to 1.36e+04"));
  const auto more = lines("[[condition]]\nname = \"low\"\npeak_pressure = 1e7\n[[condition]]\nname = \"high\"\npeak_pressure = 2e7\n", {"solver.subcycles=4"});
  EXPECT_THAT(more, Contains("conditions: low, high"));
  EXPECT_THAT(more, Not(Contains(StartsWith("parameters: "))));
  EXPECT_THAT(more, Not(Contains(StartsWith("mechanisms: "))));
}

TEST(CaseLines, AnUnusedNominalValueIsReportedAtItsPlaceWithTheKeyToSet) {
  const std::string density = "[parameter.density]\nmin = 13000\nmax = 13600\n";
  EXPECT_THAT(nominals_left_out(study(density)), IsEmpty());
  EXPECT_THAT(nominals_left_out(study(density + "nominal = 13500.0\n")), IsEmpty());  // what the table says
  const auto warnings = nominals_left_out(study(density + "nominal = 13100\n"));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].parts().key, "parameter.density.nominal");
  EXPECT_THAT(warnings[0].what(), HasSubstr("set material.mercury.density itself, which is 13500: --set material.mercury.density=13100"));
  EXPECT_GT(warnings[0].parts().line, 30);
}
