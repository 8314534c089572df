// `calomel challenge` as a whole: a suite made on a coarse grid, made again after a kill, diagnoses that fail, scores.
#include <set>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::Json;
using calomel::read_json;
using calomel::read_text;
using calomel::scratch;
using calomel::write_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

namespace {

const std::string tiny = " --out suite --none 1 --single 0 --outside 0 --sensor 1 --pair 0 --grid 0.5e-3 --threads 2";

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

/// A suite of two cases with nothing concealed, whose records are not there.
fs::path suite_without_records(const std::string& name) {
  const auto dir = scratch(name);
  for (const char* one : {"case_001", "case_002"}) {
    fs::create_directories(dir / "suite" / "cases" / one);
    std::ofstream(dir / "suite" / "cases" / one / "case.toml")
        << slice_case << "[parameter.density]\nmin = 12000\nmax = 14500\n[recordings]\nfile = \"recordings.csv\"\n";
    fs::create_directories(dir / "suite" / "truth");
    std::ofstream(dir / "suite" / "truth" / (std::string(one) + ".toml")) << "family = \"none\"\n[strength]\ndecimated = 0.0\n[parameter]\ndensity = 13400.0\n";
  }
  return dir;
}

void put_diagnosis(const fs::path& suite, const std::string& name, const std::string& verdict, const std::vector<std::string>& mechanisms) {
  const Json density{{"density", {{"mean", 13450}, {"sd", 100}}}};
  write_json(suite / "results" / name / "diagnosis.json", {{"verdict", verdict},
                                                           {"mechanisms", mechanisms},
                                                           {"ranking", {{{"name", "none"}, {"probability", 1.0}, {"parameters", Json::array()}}}},
                                                           {"fit", {{"before", {{"heldout_nrmse", 0.1}}}, {"after", {{"heldout_nrmse", 0.1}}}}},
                                                           {"base_parameters", {{"before", density}, {"after", density}}},
                                                           {"runs", 100},
                                                           {"status", "done"},
                                                           {"wall_s", 10.0}});
}

}  // namespace

TEST(ChallengeVerb, MakesCasesThatTheProgramReadsAndKeepsTheTruthApart) {
  const auto dir = scratch("challenge_make");
  const std::string words = "challenge make --seed 3" + tiny;
  const auto made = run(dir, words);
  ASSERT_EQ(made.status, 0) << made.said;
  EXPECT_THAT(made.said, HasSubstr("2 cases in suite, 2 made now"));
  EXPECT_EQ(names_in(dir / "suite" / "cases"), (std::set<std::string>{"case_001", "case_002"}));
  std::multiset<std::string> families;
  for (const char* name : {"case_001", "case_002"}) {
    EXPECT_EQ(names_in(dir / "suite" / "cases" / name), (std::set<std::string>{"case.toml", "recordings.csv"}));
    const std::string truth = read_text(dir / "suite" / "truth" / (std::string(name) + ".toml"));
    families.insert(truth.find("family = \"sensor\"") != std::string::npos ? "sensor"
                    : truth.find("family = \"none\"") != std::string::npos ? "none"
                                                                           : "other");
    const auto checked = run(dir, std::string("check suite/cases/") + name + "/case.toml");
    EXPECT_EQ(checked.status, 0) << checked.said;
    EXPECT_THAT(read_text(dir / "suite" / "cases" / name / "case.toml"), Not(HasSubstr("gauge_fault")));
  }
  EXPECT_EQ(families, (std::multiset<std::string>{"none", "sensor"}));

  const auto before = fs::last_write_time(dir / "suite" / "cases" / "case_001" / "recordings.csv");
  const auto again = run(dir, words);
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.said, HasSubstr("0 made now"));
  EXPECT_EQ(fs::last_write_time(dir / "suite" / "cases" / "case_001" / "recordings.csv"), before);
  const auto other = run(dir, "challenge make --seed 4" + tiny);
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.said, HasSubstr("the seed"));
}

TEST(ChallengeVerb, InterruptedWhileItMakesACaseItResumes) {
  const auto dir = scratch("challenge_killed");
  const std::vector<std::string> words{"challenge", "make",     "--seed", "5",      "--out", "suite",  "--none", "2",         "--single", "0",      "--outside",
                                       "0",         "--sensor", "0",      "--pair", "0",     "--grid", "0.5e-3", "--threads", "1",        "--quiet"};
  const int status = stop_program(start_program(dir, words), SIGKILL, 1,
                                  [&] { return fs::exists(dir / "suite" / "making") && fs::exists(dir / "suite" / "truth" / "case_001.log"); });
  ASSERT_TRUE(status != -1 && WIFSIGNALED(status)) << "it ended before it could be killed";
  for (const auto& name : names_in(dir / "suite" / "cases")) EXPECT_TRUE(fs::exists(dir / "suite" / "cases" / name / "recordings.csv")) << "whole or absent";
  std::string line;
  for (const auto& w : words) line += w + ' ';
  ASSERT_EQ(run(dir, line).status, 0);
  EXPECT_EQ(names_in(dir / "suite" / "cases"), (std::set<std::string>{"case_001", "case_002"}));
  EXPECT_FALSE(fs::exists(dir / "suite" / "making"));
  // The same bytes as without the kill.
  ASSERT_EQ(run(dir, with(line, "--out suite", "--out whole")).status, 0);
  for (const char* name : {"case_001", "case_002"})
    EXPECT_EQ(read_text(dir / "suite" / "cases" / name / "recordings.csv"), read_text(dir / "whole" / "cases" / name / "recordings.csv"));
}

TEST(ChallengeVerb, DrawsTheSpecsOfANamedSuiteAlone) {
  const auto dir = scratch("challenge_specs");
  ASSERT_EQ(run(dir, "challenge make --seed 1 --out suite --suite quick --specs").status, 0);
  EXPECT_EQ(names_in(dir / "suite" / "truth").size(), 6u);
  EXPECT_FALSE(fs::exists(dir / "suite" / "cases"));
}

TEST(ChallengeVerb, RefusesUnknownNamesWithTheKnownOnes) {
  const auto dir = scratch("challenge_refused");
  const auto refused = [&](const std::string& words) {
    const auto out = run(dir, "challenge " + words);
    EXPECT_EQ(out.status, 2) << words << ": " << out.said;
    return out.said;
  };
  EXPECT_THAT(refused("make --seed 1 --out suite --suite smal"), AllOf(HasSubstr("--suite"), HasSubstr("did you mean \"small\"?")));
  EXPECT_THAT(refused("make --out suite"), HasSubstr("--seed"));
  EXPECT_THAT(refused("make --seed 1"), HasSubstr("--out"));
  EXPECT_THAT(refused("make --seed 99999999999999999999 --out suite"), HasSubstr("2^64 - 1"));  // would be another seed without a word
  EXPECT_THAT(refused("make --seed 1 --out suite --none -1"), HasSubstr("--none"));
  EXPECT_THAT(refused("make --seed 1 --out suite --effects beem"), HasSubstr("did you mean \"beam\"?"));
  EXPECT_THAT(refused("make --seed 1 --out suite --generator nowhere"), AllOf(HasSubstr("nowhere"), HasSubstr("--target reference_generator")));
  EXPECT_THAT(refused("run nowhere"), AllOf(HasSubstr("nowhere"), HasSubstr("challenge make")));
  EXPECT_THAT(refused("score nowhere"), AllOf(HasSubstr("nowhere"), HasSubstr("challenge make")));
  EXPECT_THAT(refused(""), HasSubstr("calomel challenge --help"));
  EXPECT_THAT(refused("judge suite"), HasSubstr("--help"));
  EXPECT_FALSE(fs::exists(dir / "suite"));
}

TEST(ChallengeVerb, FailedDiagnosesAreReportedAndOneRuleJudgesTheSuite) {
  const auto dir = suite_without_records("challenge_run");
  const auto first = run(dir, "challenge run suite --threads 1 --set diagnosis.leaders=3");
  EXPECT_EQ(first.status, 4) << first.said;
  EXPECT_THAT(first.said,
              AllOf(HasSubstr("case_001 (1 of 2) failed"), HasSubstr("case_002 (2 of 2) failed"), HasSubstr("recordings.csv"), HasSubstr("diagnose.log")));
  const Json rule = read_json(dir / "suite" / "rule.json");
  EXPECT_EQ(rule["rule"]["diagnosis"]["leaders"], 3);
  put_diagnosis(dir / "suite", "case_001", "none", {});
  const auto second = run(dir, "challenge run suite --threads 1 --set diagnosis.leaders=3");
  EXPECT_THAT(second.said, AllOf(Not(HasSubstr("case_001 (1 of 2)")), HasSubstr("case_002 (2 of 2) failed")));

  const auto other = run(dir, "challenge run suite --threads 1");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.said, AllOf(HasSubstr("diagnosis.leaders"), HasSubstr("--new-rule")));
  EXPECT_EQ(run(dir, "challenge run suite --threads 1 --new-rule").status, 4);
  EXPECT_TRUE(fs::exists(dir / "suite" / "results.old-1" / "case_001" / "diagnosis.json"));
  EXPECT_FALSE(fs::exists(dir / "suite" / "results" / "case_001" / "diagnosis.json"));
  EXPECT_EQ(run(dir, "challenge run suite --set nothing.at_all=1").status, 2);
}

TEST(ChallengeVerb, ScoresWhatThereIs) {
  const auto dir = suite_without_records("challenge_score");
  const auto suite = dir / "suite";
  const auto nothing = run(dir, "challenge score suite");
  EXPECT_EQ(nothing.status, 2);
  EXPECT_THAT(nothing.said, HasSubstr("challenge run"));
  put_diagnosis(suite, "case_001", "none", {});
  const auto one = run(dir, "challenge score suite");
  EXPECT_EQ(one.status, 0) << one.said;
  EXPECT_THAT(one.said, AllOf(HasSubstr("1 of 2 cases have no diagnosis"), HasSubstr("no rule.json")));
  put_diagnosis(suite, "case_002", "named", {"beam_profile"});
  const auto out = printed(dir, "challenge score suite --json all.json");
  EXPECT_EQ(out.status, 0);
  EXPECT_THAT(out.said, AllOf(HasSubstr("2 cases"), HasSubstr("1 beam_profile"), HasSubstr("false names where nothing is concealed"), HasSubstr("1 of 2"),
                              HasSubstr("NOT MET")));
  const Json json = read_json(dir / "all.json");
  EXPECT_EQ(json["confusion"]["none"]["named beam_profile"], 1);
  EXPECT_NEAR(json["gates"][0]["bound"].get<double>(), std::sqrt(0.95), 1e-9);  // 1 of 2: P(0 of 2) + P(1 of 2) = 1 - p^2 = 0.05
  EXPECT_EQ(read_json(suite / "score.json")["cases"], 1) << "--json leaves it alone";

  write_json(suite / "rule.json", {{"hash", "0123"}});
  ASSERT_EQ(run(dir, "challenge score suite").status, 0);
  const auto twice = run(dir, "challenge score suite --json twice.json --with suite/score.json");
  EXPECT_EQ(twice.status, 2);
  EXPECT_THAT(twice.said, AllOf(HasSubstr("suite/score.json"), HasSubstr("case_001"), HasSubstr("counted already")));
  fs::remove(suite / "rule.json");

  std::ofstream(suite / "results" / "case_002" / "diagnosis.json") << "{\"verdict\": ";
  const auto broken = run(dir, "challenge score suite");
  EXPECT_EQ(broken.status, 2);
  EXPECT_THAT(broken.said, HasSubstr("case_002/diagnosis.json"));
  fs::remove(suite / "truth" / "case_002.toml");
  EXPECT_EQ(run(dir, "challenge score suite").status, 2);
}
