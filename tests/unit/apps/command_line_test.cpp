#include "apps/command_line.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "base/artefact.hpp"
#include "base/parallel.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {

ExitStatus nothing(const CommandLine&) { return ExitStatus::done; }
const std::vector<Verb> verbs{{"list", "names", Takes::nothing, nothing},       {"campaign", "runs", Takes::case_file, nothing},
                              {"calibrate", "fits", Takes::case_file, nothing}, {"simulate", "one run", Takes::case_file, nothing},
                              {"import", "recordings", Takes::files, nothing},  {"challenge", "suites", Takes::suite, nothing}};

CommandLine parsed(std::vector<std::string> words) {
  CommandLine command;
  std::ostringstream out;
  EXPECT_TRUE(parse(words, verbs, command, out));
  EXPECT_EQ(out.str(), "");
  return command;
}

std::string refused(std::vector<std::string> words) {
  CommandLine command;
  std::ostringstream out;
  try {
    (void)parse(words, verbs, command, out);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

std::string printed(std::vector<std::string> words) {
  CommandLine command;
  std::ostringstream out;
  EXPECT_FALSE(parse(words, verbs, command, out));
  return out.str();
}

}  // namespace

TEST(CommandLine, HasTheDefaultsOfThePage) {
  const auto c = parsed({"campaign", "some/where/case.toml"});
  EXPECT_EQ(c.verb, "campaign");
  EXPECT_EQ(c.case_file, "some/where/case.toml");
  EXPECT_EQ(c.out, "some/where/case.out");
  EXPECT_EQ(c.seed, 1u);
  EXPECT_EQ(c.threads, default_threads());
  EXPECT_FALSE(c.quiet);
  EXPECT_FALSE(c.fresh);
}

TEST(CommandLine, TakesOptionsInAnyOrder) {
  const auto c = parsed({"campaign", "--set", "a.b=1", "case.toml", "--quiet", "--set", "c.d=[1, 2]", "--threads", "3", "--seed", "18446744073709551615",
                         "--out", "x", "--fresh"});
  EXPECT_EQ(c.case_file, "case.toml");
  EXPECT_THAT(c.overrides, testing::ElementsAre("a.b=1", "c.d=[1, 2]"));
  EXPECT_EQ(c.threads, 3);
  EXPECT_EQ(c.seed, 18446744073709551615u);
  EXPECT_EQ(c.out, "x");
  EXPECT_TRUE(c.quiet);
  EXPECT_TRUE(c.fresh);
}

TEST(CommandLine, OverridesKeepBracketsCommasAndNegativeNumbers) {
  const auto c = parsed({"campaign", "case.toml", "--set", "a=[1,2]", "--set", "sensor[1].gain=-2", "--set=b=-1e-3"});
  EXPECT_THAT(c.overrides, testing::ElementsAre("a=[1,2]", "sensor[1].gain=-2", "b=-1e-3"));
}

TEST(CommandLine, AnUnknownVerbIsRefusedWithTheNearest) {
  EXPECT_THAT(refused({"campain", "case.toml"}), testing::AllOf(HasSubstr("campain"), HasSubstr("did you mean \"campaign\"?")));
}

TEST(CommandLine, WhatTheParserRefusesIsAnInputError) {
  EXPECT_THAT(refused({}), HasSubstr("--help"));
  EXPECT_THAT(refused({"campaign"}), HasSubstr("CASE"));
  EXPECT_THAT(refused({"campaign", "case.toml", "--outt", "x"}), testing::AllOf(HasSubstr("--outt"), HasSubstr("did you mean \"--out\"?")));
  EXPECT_THAT(refused({"campaign", "case.toml", "--seed", "x"}), HasSubstr("a whole number from 0 to 2^64 - 1, not x"));
  EXPECT_THAT(refused({"campaign", "case.toml", "--threads", "0"}), HasSubstr("--threads"));
  EXPECT_THAT(refused({"campaign", "case.toml", "--threads", "many"}), HasSubstr("--threads"));
  EXPECT_THAT(refused({"campaign", "case.toml", "--seed", "-1"}), HasSubstr("--seed"));
  EXPECT_THAT(refused({"campaign", "case.toml", "other.toml"}), HasSubstr("other.toml"));
  EXPECT_THAT(refused({"campaign", "case.toml", "--fields"}), HasSubstr("--fields"));  // another verb's
  EXPECT_THAT(refused({"calibrate", "case.toml", "--method", "magic"}), HasSubstr("magic"));
  EXPECT_THAT(refused({"import", "a.csv"}), HasSubstr("--out"));
}

TEST(CommandLine, VerbsHaveTheirOwnOptions) {
  EXPECT_THAT(parsed({"calibrate", "case.toml"}).methods, testing::ElementsAre("enc"));
  EXPECT_THAT(parsed({"calibrate", "case.toml", "--method", "map"}).methods, testing::ElementsAre("map"));
  EXPECT_THAT(parsed({"calibrate", "case.toml", "--method", "all"}).methods, testing::ElementsAre("all"));
  EXPECT_TRUE(parsed({"simulate", "case.toml", "--fields"}).fields);
  EXPECT_THAT(parsed({"import", "a.csv", "b.csv", "--out", "x"}).files, testing::ElementsAre("a.csv", "b.csv"));
}

TEST(CommandLine, ChallengeHasWordsOfItsOwn) {
  const auto make = parsed(
      {"challenge", "make", "--out", "dir", "--seed", "7", "--suite", "quick", "--none", "3", "--effects", "beam,slot", "--grid", "5e-4", "--threads", "2"});
  EXPECT_EQ(make.verb, "challenge");
  EXPECT_EQ(make.challenge.action, "make");
  EXPECT_EQ(make.challenge.directory, "dir");
  EXPECT_EQ(make.seed, 7u);
  EXPECT_EQ(make.challenge.suite, "quick");
  EXPECT_EQ(make.challenge.none, 3);
  EXPECT_FALSE(make.challenge.single.has_value());
  EXPECT_THAT(make.challenge.effects, testing::ElementsAre("beam", "slot"));
  EXPECT_EQ(make.challenge.grid, 5e-4);
  const auto run = parsed({"challenge", "run", "dir", "--set", "a.b=[1, 2]", "--set", "c=3", "--discard-runs", "--quiet"});
  EXPECT_EQ(run.challenge.action, "run");
  EXPECT_THAT(run.overrides, testing::ElementsAre("a.b=[1, 2]", "c=3"));
  EXPECT_TRUE(run.challenge.discard_runs && run.quiet);
  EXPECT_FALSE(run.challenge.new_rule);
  EXPECT_EQ(parsed({"challenge", "score", "dir", "--json", "x.json"}).challenge.json, "x.json");
  EXPECT_THAT(refused({"challenge"}), HasSubstr("calomel challenge --help"));
  EXPECT_THAT(refused({"challenge", "make", "--out", "dir"}), testing::AllOf(HasSubstr("--seed"), HasSubstr("calomel challenge make --help")));
  EXPECT_THAT(refused({"challenge", "score", "dir", "--seed", "1"}), HasSubstr("--seed"));
  EXPECT_THAT(refused({"challenge", "run"}), HasSubstr("DIR"));
  EXPECT_THAT(printed({"challenge", "--help"}), testing::AllOf(HasSubstr("make"), HasSubstr("run"), HasSubstr("score")));
  EXPECT_THAT(printed({"challenge", "make", "--help"}), testing::AllOf(HasSubstr("--suite"), HasSubstr("--generator")));
}

TEST(CommandLine, HelpNamesEveryVerbAndVersionItself) {
  for (const auto& v : verbs) EXPECT_THAT(printed({"--help"}), HasSubstr(v.name));
  EXPECT_THAT(printed({"campaign", "--help"}), testing::AllOf(HasSubstr("--set"), HasSubstr("--fresh"), HasSubstr("CASE")));
  EXPECT_EQ(printed({"--version"}), std::string("calomel ") + version + "\n");
}
