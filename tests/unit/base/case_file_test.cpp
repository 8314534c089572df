#include "base/case_file.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/input_file.hpp"
#include "base/json.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {

struct Inner {
  double decay = 0.13;
  std::array<double, 2> widths{0.1, 0.02};
  template <class V>
  void visit(V& v) {
    v("decay", decay, {.unit = "m", .range = above(0), .doc = "decay length"});
    v("widths", widths, {.unit = "m", .range = above(0), .doc = "two widths"});
  }
};

struct Load {
  std::string policy = "fixed";
  double peak_pressure = 25e6;
  int pulses = 8;
  bool quiet = false;
  std::optional<double> energy;
  std::vector<std::string> exclude;
  Inner profile;
  template <class V>
  void visit(V& v) {
    v("policy", policy, {.doc = "what p0 follows", .choices = {"fixed", "gruneisen"}});
    v("peak_pressure", peak_pressure, {.unit = "Pa", .range = above(0), .doc = "peak"});
    v("pulses", pulses, {.range = at_least(1), .doc = "number"});
    v("quiet", quiet, {.doc = "say little"});
    v.renamed("silent", "load.quiet = true | false says it now");
    v("energy", energy, {.unit = "J", .range = above(0), .doc = "deposited"});
    v("exclude", exclude, {.doc = "sensors"});
    v.table("profile", profile, "shape");
  }
};

struct Named {
  std::string name;
  int pulses = 1;
  Inner profile;
  template <class V>
  void visit(V& v) {
    v("name", name, {.doc = "name"});
    v("pulses", pulses, {.doc = "number"});
    v.table("profile", profile, "shape");
  }
};

std::string message_of(const std::string& text) {
  CaseFile file = CaseFile::from_text(text);
  Load load;
  try {
    file.read("load", load);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST(CaseFile, ReadsEveryKindOfField) {
  CaseFile file = CaseFile::from_text(
      "[load]\npolicy='gruneisen'\npeak_pressure=3e7\npulses=4\nquiet=true\nenergy=1\nexclude=['A','B']\n[load.profile]\ndecay=1\nwidths=[1, 2.5]\n");
  Load load;
  file.read("load", load);
  EXPECT_EQ(load.policy, "gruneisen");
  EXPECT_EQ(load.peak_pressure, 3e7);
  EXPECT_EQ(load.pulses, 4);
  EXPECT_TRUE(load.quiet);
  EXPECT_EQ(load.energy, 1.0);
  EXPECT_EQ(load.exclude, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(load.profile.widths[1], 2.5);
}

TEST(CaseFile, NamesTheNearestKey) {
  const auto m = message_of("\n[load]\npeak_presure = 1e6\n");
  EXPECT_THAT(m, HasSubstr("case.toml:3:1"));
  EXPECT_THAT(m, HasSubstr("load.peak_presure"));
  EXPECT_THAT(m, HasSubstr("did you mean \"peak_pressure\"?"));
}

TEST(CaseFile, ReportsValueAndRange) {
  const auto m = message_of("[load]\npeak_pressure = -3\n");
  EXPECT_THAT(m, HasSubstr("case.toml:2:"));
  EXPECT_THAT(m, HasSubstr("-3"));
  EXPECT_THAT(m, HasSubstr("> 0"));
  EXPECT_THAT(m, HasSubstr("[Pa]"));
}

TEST(CaseFile, NamesTheReplacementOfARemovedKey) {
  const auto m = message_of("[load]\npulses = 2\nsilent = true\n");
  EXPECT_THAT(m, HasSubstr("case.toml:3:"));
  EXPECT_THAT(m, HasSubstr("load.silent"));
  EXPECT_THAT(m, HasSubstr("no longer read"));
  EXPECT_THAT(m, HasSubstr("take it out: load.quiet = true | false says it now"));
  EXPECT_THAT(message_of("[load]\nsilnt = true\n"), testing::Not(HasSubstr("silent")));  // the message does not suggest it either
  EXPECT_EQ(echo(Load{}).contains("silent"), false);
}

TEST(CaseFile, RejectsWrongTypes) {
  EXPECT_THAT(message_of("[load]\npulses = 2.5\n"), HasSubstr("a whole number is expected"));
  EXPECT_THAT(message_of("[load]\npeak_pressure = 'high'\n"), HasSubstr("a number is expected"));
  EXPECT_THAT(message_of("[load]\npolicy = 'fixd'\n"), HasSubstr("did you mean \"fixed\"?"));
  EXPECT_THAT(message_of("[load.profile]\nwidths = [1]\n"), HasSubstr("2 numbers are expected, 1 given"));
  EXPECT_THAT(message_of("[load]\npeak_pressure = nan\n"), HasSubstr("out of range"));
  EXPECT_THAT(message_of("load = 3\n"), HasSubstr("a table is expected"));
}

TEST(CaseFile, KeepsTheOrderOfTheFile) {
  const CaseFile file = CaseFile::from_text("[parameter.zeta]\nmin=1\n[parameter.alpha]\nmin=2\n[parameter.mid]\nmin=3\n");
  EXPECT_EQ(file.names("parameter"), (std::vector<std::string>{"zeta", "alpha", "mid"}));
}

TEST(CaseFile, NamesAnUnknownTable) {
  CaseFile file = CaseFile::from_text("[lod]\nx=1\n");
  const std::vector<std::string> known{"load", "time"};
  try {
    file.expect_all_read(known);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean \"load\"?"));
  }
}

TEST(CaseFile, SuggestsOnlyWhatIsNear) {
  EXPECT_THAT(message_of("[load]\nxylophone = 3\n"),
              testing::AllOf(HasSubstr("load.xylophone"), HasSubstr("allowed: "), HasSubstr("peak_pressure"), testing::Not(HasSubstr("did you mean"))));
  CaseFile file = CaseFile::from_text("length = 0.1\n[geometry]\nlength = 0.2\n");
  try {
    file.expect_all_read(std::vector<std::string>{"geometry", "sensor"});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean \"geometry.length\"?"));
  }
}

TEST(CaseFile, ReportsAWrongOverrideAndNotTheLineThatItReplaces) {
  const auto path = std::filesystem::temp_directory_path() / ("calomel_case_file_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(path) << "[load]\npeak_pressure = 1e6\n";
  CaseFile file(path, std::vector<std::string>{"load.peak_pressure=high"});
  Load load;
  try {
    file.read("load", load);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("--set load.peak_pressure=high"), testing::Not(HasSubstr(":2:"))));
  }
  std::filesystem::remove(path);
}

TEST(CaseFile, AnOverrideFindsAnElementOfAListByItsName) {
  const auto path = std::filesystem::temp_directory_path() / ("calomel_case_file_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(path) << "[[load]]\nname = \"A\"\n[[load]]\nname = \"B\"\npulses = 3\n";
  const auto with = [&](const std::string& override_text) { return CaseFile(path, std::vector<std::string>{override_text}); };
  const auto error = [&](const std::string& override_text) -> std::string {
    try {
      (void)with(override_text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  for (const char* override_text : {"load.B.pulses=5", "load[1].pulses=5"}) {
    CaseFile file = with(override_text);
    Named a, b;
    file.read("load[0]", a);
    file.read("load[1]", b);
    EXPECT_EQ(a.pulses, 1);
    EXPECT_EQ(b.pulses, 5);
  }
  CaseFile file = with("load.A.profile.decay=0.2");
  Named a;
  file.read("load[0]", a);
  EXPECT_EQ(a.profile.decay, 0.2);
  EXPECT_THAT(error("load.C.pulses=5"), testing::AllOf(HasSubstr("no element has this name"), HasSubstr("\"C\""), HasSubstr("A, B")));
  EXPECT_THAT(error("load.B=5"), HasSubstr("load.B.KEY=VALUE"));
  std::filesystem::remove(path);
}

TEST(CaseFile, ShowsNumbersAsTheyAreWritten) { EXPECT_THAT(message_of("[load.profile]\nwidths = [0.1, 0.05, 1]\n"), HasSubstr("[0.1, 0.05, 1]")); }

TEST(CaseFile, RequestsADecimalPoint) {
  try {
    (void)CaseFile::from_text("[load]\npeak_pressure = 0,18\n");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("case.toml:2:"), HasSubstr("decimal point")));
  }
}

TEST(UnreadableFile, NamesKeyPathAndTheNearestThatIsThere) {
  const auto folder = std::filesystem::temp_directory_path() / ("calomel_unreadable_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "sensors.csv") << "x";
  EXPECT_THAT(unreadable_file("sensors", folder / "sensor.csv").what(),
              testing::AllOf(HasSubstr("sensors = "), HasSubstr("sensor.csv"), HasSubstr("did you mean \"sensors.csv\"?")));
  EXPECT_THAT(unreadable_file("sensors", folder / "gauges.txt").what(), testing::AllOf(HasSubstr("check the name"), testing::Not(HasSubstr("did you mean"))));
  EXPECT_THAT(unreadable_file("sensors", folder).what(), HasSubstr("this is a directory"));
  EXPECT_THROW((void)input_file("load.file", folder), InputError);
  EXPECT_EQ(input_file("sensors", folder / "sensors.csv").get(), 'x');
  std::filesystem::remove_all(folder);
}

TEST(NameSuggestion, ANameThatBeginsAKnownOneIsNear) {
  const std::vector<std::string> known{"band", "gain_sd", "baseline"};
  EXPECT_EQ(name_suggestion("gain", known), "did you mean \"gain_sd\"?");
  EXPECT_EQ(name_suggestion("bend", known), "did you mean \"band\"?");
}

TEST(CaseFile, SetsANumberByPath) {
  Load load;
  NumberVisitor v("profile.decay");
  load.visit(v);
  ASSERT_NE(v.number, nullptr);
  *v.number = 7;
  EXPECT_EQ(load.profile.decay, 7);
  EXPECT_THAT(v.known, testing::Contains("profile.widths.1"));
}

TEST(CaseFile, EchoesInOrder) {
  EXPECT_EQ(echo(Load{}).dump(),
            R"({"policy":"fixed","peak_pressure":25000000.0,"pulses":8,"quiet":false,"exclude":[],"profile":{"decay":0.13,"widths":[0.1,0.02]}})");
}
