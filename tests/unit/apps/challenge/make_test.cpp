// A suite on disk: cases are whole or absent, what is there is kept, truth stands apart; all of a suite's diagnoses by one rule.
#include "apps/challenge/make.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "apps/challenge/child.hpp"
#include "apps/challenge/rule.hpp"
#include "apps/challenge/run.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/scratch.hpp"

namespace calomel::challenge {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const SuiteOptions three{.none = 2, .sensor = 1};

/// Stands for the generator: copies the SPEC, and fails or is interrupted at the calls that are named.
struct FakeGenerator {
  int calls = 0;
  int fails_at = -1, dies_at = -1;
  bool leaves_half = false;  ///< at fails_at and dies_at: with case.toml written

  bool operator()(const fs::path& spec, const fs::path& into, const fs::path& truth, const fs::path&) {
    const bool last = ++calls == fails_at || calls == dies_at;
    EXPECT_FALSE(fs::exists(into)) << "a folder of its own";
    fs::create_directories(into);
    if (!last || leaves_half) std::ofstream(into / "case.toml") << "# a case\n";
    if (calls == dies_at) throw Interrupted();
    if (calls == fails_at) return false;
    std::ofstream(into / "recordings.csv") << "sensor,pulse,time,strain\n";
    fs::copy_file(spec, truth);
    return true;
  }
};

std::string refused(const std::function<void()>& body) {
  try {
    body();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Make, KeepsTruthApartFromWhatAUserWouldHave) {
  const auto dir = scratch("make");
  FakeGenerator generator;
  const auto summary = make_suite(three, 1, dir, std::ref(generator));
  EXPECT_EQ(summary.cases, 3u);
  EXPECT_EQ(summary.made, 3u);
  EXPECT_THAT(cases_in(dir), ElementsAre("case_001", "case_002", "case_003"));
  for (const auto& name : cases_in(dir)) {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(dir / "cases" / name)) files.push_back(entry.path().filename());
    EXPECT_THAT(files, testing::UnorderedElementsAre("case.toml", "recordings.csv"));
    EXPECT_TRUE(fs::exists(dir / "truth" / (name + ".toml")));
    EXPECT_EQ(read_text(dir / "truth" / (name + ".spec.toml")),
              draw_spec(std::size_t(name.back() - '1'), cases_of(three, 1)[std::size_t(name.back() - '1')], 1, three));
  }
  EXPECT_FALSE(fs::exists(dir / "making"));
}

TEST(Make, CutOffAtAnyCaseGoesOnWithTheNext) {
  for (const bool half : {false, true})
    for (int dies_at = 1; dies_at <= 3; ++dies_at) {
      const auto dir = scratch("make_cut_off");
      FakeGenerator first{.dies_at = dies_at, .leaves_half = half};
      EXPECT_THROW((void)make_suite(three, 1, dir, std::ref(first)), Interrupted);
      std::size_t whole = 0;
      for (int k = 1; k <= 3; ++k) {
        const std::string name = case_name(std::size_t(k - 1));
        EXPECT_EQ(fs::exists(dir / "cases" / name), fs::exists(dir / "cases" / name / "recordings.csv"));
        whole += fs::exists(dir / "cases" / name);
      }
      EXPECT_EQ(whole, std::size_t(dies_at - 1));
      FakeGenerator second;
      EXPECT_EQ(make_suite(three, 1, dir, std::ref(second)).made, 4u - std::size_t(dies_at));
      EXPECT_EQ(second.calls, 4 - dies_at) << "what is there is not made again";
      EXPECT_EQ(cases_in(dir).size(), 3u);
      EXPECT_EQ(make_suite(three, 1, dir, std::ref(second)).made, 0u);
    }
}

TEST(Make, AFailedCaseIsReportedAndTheOthersAreMade) {
  const auto dir = scratch("make_failed");
  FakeGenerator generator{.fails_at = 2, .leaves_half = true};
  const auto summary = make_suite(three, 1, dir, std::ref(generator));
  EXPECT_THAT(summary.failed, ElementsAre("case_002"));
  EXPECT_THAT(cases_in(dir), ElementsAre("case_001", "case_003"));
  FakeGenerator again;
  EXPECT_THAT(make_suite(three, 1, dir, std::ref(again)).failed, IsEmpty());
  EXPECT_EQ(again.calls, 1);
}

TEST(Make, AnotherSuiteInTheSamePlaceIsRefused) {
  const auto dir = scratch("make_other");
  FakeGenerator generator;
  (void)make_suite(three, 1, dir, std::ref(generator));
  EXPECT_THAT(refused([&] { (void)make_suite(three, 2, dir, std::ref(generator)); }), HasSubstr("the seed"));
  EXPECT_THAT(refused([&] { (void)make_suite({.none = 3, .sensor = 1}, 1, dir, std::ref(generator)); }), HasSubstr("suite.none"));
  EXPECT_EQ(generator.calls, 3);
  const SuiteLock other(dir, "make");
  EXPECT_THAT(refused([&] { (void)make_suite(three, 1, dir, std::ref(generator)); }), HasSubstr("another calomel"));
}

TEST(Make, NamesTheCommandThatBuildsAMissingGenerator) {
  const auto dir = scratch("generator");
  EXPECT_THAT(refused([&] { (void)find_generator("", dir / "bin" / "calomel"); }),
              testing::AllOf(HasSubstr("reference_generator"), HasSubstr("--target reference_generator"), HasSubstr("--generator PATH")));
  EXPECT_THAT(refused([&] { (void)find_generator(dir / "nowhere", dir / "calomel"); }),
              testing::AllOf(HasSubstr("nowhere"), HasSubstr("--target reference_generator")));
  // Each place where it is looked for.
  for (const auto& [program, generator] : std::vector<std::pair<fs::path, fs::path>>{{"a/calomel", "a/reference_generator"},
                                                                                     {"b/apps/calomel", "b/tests/proof/reference_generator"},
                                                                                     {"c/bin/calomel", "c/libexec/calomel/reference_generator"}}) {
    fs::create_directories((dir / program).parent_path());
    fs::create_directories((dir / generator).parent_path());
    std::ofstream(dir / generator) << "#!/bin/sh\n";
    EXPECT_EQ(find_generator("", dir / program), fs::canonical(dir / generator));
  }
}

TEST(Child, GivesTheStatusAndKeepsTheOutput) {
  const auto log = scratch_file("child.log");
  const std::vector<std::string> words{"-c", "echo out; echo err >&2; exit 7"};
  EXPECT_EQ(run_child("/bin/sh", words, log), 7);
  EXPECT_EQ(read_text(log), "out\nerr\n");
  EXPECT_EQ(last_line(log), "err");
  const std::vector<std::string> killed{"-c", "kill -9 $$"};
  EXPECT_EQ(run_child("/bin/sh", killed, log), 128 + 9);
  EXPECT_EQ(run_child("/no/such/program", words, log), 127);
}

/// A suite whose cases are there.
fs::path suite(const std::string& name) {
  const auto dir = scratch(name);
  FakeGenerator generator;
  (void)make_suite(three, 1, dir, std::ref(generator));
  return dir;
}

bool diagnosed(const fs::path&, const fs::path& into) {
  std::ofstream(into / "runs.journal") << "runs";
  write_json(into / "diagnosis.json", {{"verdict", "none"},
                                       {"mechanisms", Json::array()},
                                       {"ranking", Json::array()},
                                       {"fit", {{"before", {{"heldout_nrmse", 0.1}}}, {"after", {{"heldout_nrmse", 0.1}}}}},
                                       {"base_parameters", {{"before", Json::object()}, {"after", Json::object()}}},
                                       {"runs", 12}});
  return true;
}

TEST(Run, DiagnosesWhatHasNoDiagnosisAndGoesOnAfterAFailure) {
  const auto dir = suite("run");
  std::vector<std::string> said;
  const auto say = [&](const std::string& text) { said.push_back(text); };
  int calls = 0;
  const auto failing = [&](const fs::path& file, const fs::path& into) {
    ++calls;
    EXPECT_TRUE(fs::exists(file));
    if (into.filename() != "case_002") return diagnosed(file, into);
    std::ofstream(into / "diagnose.log") << "one\nthe computation failed: a step\n  shown = here\n          ^\n";
    return false;
  };
  const auto first = run_suite(dir, failing, false, say);
  EXPECT_EQ(first.diagnosed, 2u);
  EXPECT_THAT(first.failed, ElementsAre("case_002"));
  EXPECT_THAT(said,
              ElementsAre("case_001 (1 of 3): none, 12 runs", "case_002 (2 of 3) failed: the computation failed: a step", "case_003 (3 of 3): none, 12 runs"));
  EXPECT_TRUE(fs::exists(dir / "results" / "case_001" / "runs.journal"));
  calls = 0;
  const auto second = run_suite(
      dir, [&](const fs::path& f, const fs::path& into) { return ++calls, diagnosed(f, into); }, true, say);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(second.diagnosed, 1u);
  EXPECT_THAT(second.failed, IsEmpty());
  for (const auto& name : cases_in(dir)) EXPECT_FALSE(fs::exists(dir / "results" / name / "runs.journal"));
}

TEST(Run, InterruptedItGoesOnWithTheCaseThatWasUnderWay) {
  const auto dir = suite("run_interrupted");
  int calls = 0;
  const auto dying = [&](const fs::path& f, const fs::path& into) -> bool {
    if (++calls == 2) throw Interrupted();
    return diagnosed(f, into);
  };
  EXPECT_THROW((void)run_suite(dir, dying, false, [](const std::string&) {}), Interrupted);
  EXPECT_EQ(run_suite(dir, diagnosed, false, [](const std::string&) {}).diagnosed, 2u);
}

TEST(Run, ADirectoryWithoutCasesGivesTheCommandThatMakesThem) {
  EXPECT_THAT(refused([] { (void)cases_in(scratch_file("nowhere")); }), testing::AllOf(HasSubstr("nowhere"), HasSubstr("calomel challenge make")));
  EXPECT_THAT(refused([] { (void)cases_in(scratch("empty")); }), HasSubstr("calomel challenge make"));
}

TEST(Rule, OneForASuite) {
  const auto dir = scratch("rule");
  Rule rule{.gates = gates_json({}), .diagnosis = {{"max_runs", 2000}}, .version = "1"};
  EXPECT_FALSE(record_rule(dir, rule, "build one", false));
  fs::create_directories(dir / "results" / "case_001");
  EXPECT_FALSE(record_rule(dir, rule, "build one", false));
  EXPECT_TRUE(record_rule(dir, rule, "build two", false)) << "another build is reported";
  EXPECT_FALSE(record_rule(dir, rule, "build one", false)) << "once";
  EXPECT_EQ(read_json(dir / "rule.json")["programs"].size(), 2u);

  // Each part of it counts.
  std::vector<Rule> others(4, rule);
  others[0].gates = gates_json({.lead = 31});
  others[1].diagnosis["max_runs"] = 100;
  others[2].overrides = {"errors.band=1e4"};
  others[3].version = "2";
  const char* named[]{"gates.lead", "diagnosis.max_runs", "overrides", "version"};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_THAT(refused([&] { (void)record_rule(dir, others[k], "build one", false); }), testing::AllOf(HasSubstr(named[k]), HasSubstr("--new-rule"))) << k;
  EXPECT_TRUE(fs::exists(dir / "results" / "case_001"));

  EXPECT_FALSE(record_rule(dir, others[0], "build one", true));
  EXPECT_FALSE(fs::exists(dir / "results"));
  EXPECT_TRUE(fs::exists(dir / "results.old-1" / "case_001"));
  EXPECT_TRUE(fs::exists(dir / "rule.json.old-1"));
  fs::create_directories(dir / "results" / "case_001");
  EXPECT_FALSE(record_rule(dir, others[0], "build one", true)) << "the same line goes on where it was cut off";
  EXPECT_TRUE(fs::exists(dir / "results" / "case_001"));
  EXPECT_EQ(read_json(dir / "rule.json")["hash"], others[0].hash());
  EXPECT_NE(rule.hash(), others[0].hash());
}

TEST(Rule, ResultsOfAnUnknownRuleAreNotGoneOnWith) {
  const auto dir = scratch("rule_unknown");
  fs::create_directories(dir / "results");
  const Rule rule{.gates = gates_json({}), .diagnosis = Json::object(), .version = "1"};
  EXPECT_THAT(refused([&] { (void)record_rule(dir, rule, "build", false); }), HasSubstr("rule.json"));
  EXPECT_FALSE(record_rule(dir, rule, "build", true));
  EXPECT_TRUE(fs::exists(dir / "results.old-1"));
}

}  // namespace
}  // namespace calomel::challenge
