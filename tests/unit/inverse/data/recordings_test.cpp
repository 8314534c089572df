#include "inverse/data/recordings.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "base/random.hpp"
#include "inverse/data/record_rows.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::AllOf;
using testing::HasSubstr;

namespace {

/// Writes the text as recordings.csv and reads it.
Recordings read(const std::string& text, const std::string& unit = "strain", const std::string& file = "recordings.csv") {
  const auto path = scratch("read") / file;
  write_atomically(path, text);
  return read_recordings_file(path, unit);
}

std::string message_of(const std::string& text, const std::string& unit = "strain") {
  try {
    (void)read(text, unit);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

const std::string long_form =
    "sensor,pulse,time,strain\n"
    "B,7,0,1\nB,7,1e-6,2\nB,7,2e-6,3\n"
    "A,7,2e-6,6\nA,7,0,4\nA,7,1e-6,5\n"
    "A,3,0,7\nA,3,1e-6,8\nA,3,2e-6,9\n";

}  // namespace

TEST(Recordings, LongFormKeepsSensorsPulsesAndAbsence) {
  const auto r = read(long_form);
  EXPECT_EQ(r.conditions, (std::vector<std::string>{"default"}));
  EXPECT_EQ(r.sensors, (std::vector<std::string>{"B", "A"}));
  EXPECT_EQ(r.pulses, (std::vector<int>{3, 7}));
  EXPECT_EQ(r.time, (std::vector<double>{0, 1e-6, 2e-6}));
  EXPECT_FALSE(r.recorded(0, 0, 0));  // pulse 3 of B was never recorded
  EXPECT_EQ(r.values[r.at(0, 1, 1, 0)], 4);
  EXPECT_EQ(r.values[r.at(0, 1, 1, 2)], 6);
  EXPECT_EQ(r.values[r.at(0, 1, 0, 2)], 9);
  EXPECT_TRUE(r.warnings.empty());
  EXPECT_EQ(r.sensor_lines, (std::vector<int>{2, 5}));
}

TEST(Recordings, ColumnsMayStandInAnyOrderWithAnyOfTheSeparators) {
  for (const std::string s : {",", ";", "\t", "  "}) {
    const std::string text =
        fmt::format("# made by hand\n\ntime{0}condition{0}strain{0}sensor\n0{0}low{0}1{0}A\n1{0}low{0}2{0}A\r\n0{0}high{0}3{0}A\n1{0}high{0}4{0}A\n", s);
    const auto r = read(text);
    EXPECT_EQ(r.conditions, (std::vector<std::string>{"low", "high"})) << s;
    EXPECT_EQ(r.pulses, (std::vector<int>{0}));
    EXPECT_EQ(r.values, (std::vector<double>{1, 2, 3, 4}));
  }
}

TEST(Recordings, WideFormIsOnePulse) {
  const auto r = read("time [us],A,B\n0,0,0\n1,1e-5,2e-5\n2,2e-5,1e-5\n");
  EXPECT_EQ(r.sensors, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(r.pulses.size(), 1u);
  EXPECT_NEAR(r.time[2], 2e-6, 1e-18);
  EXPECT_EQ(r.values[r.at(0, 1, 0, 1)], 2e-5);
}

TEST(Recordings, MicrostrainIsConvertedOnce) {
  EXPECT_DOUBLE_EQ(read("time,A\n0,10\n1,20\n", "microstrain").values[1], 20e-6);
  EXPECT_EQ(read("time,A\n0,10\n1,20\n", "microstrain").unit, "strain");
  EXPECT_EQ(read("time,A\n0,10\n1,20\n", "kPa").unit, "kPa");
  EXPECT_EQ(read("time,A\n0,10\n1,20\n", "kPa").values[1], 20);
  EXPECT_THAT(message_of("sensor,time,microstrain\nA,0,1\n"), HasSubstr("recordings.unit"));
}

TEST(Recordings, DropoutsAreCountedInAWarning) {
  const auto r = read("sensor,pulse,time,strain\nA,0,0,1\nA,0,1,nan\nA,0,2,\nA,0,3,4\nA,1,0,1\nA,1,1,1\nA,1,3,1\n");
  EXPECT_THAT(r.warnings, testing::ElementsAre(HasSubstr("2 dropouts"), HasSubstr("1 samples are missing")));
  EXPECT_TRUE(std::isnan(r.values[r.at(0, 0, 0, 1)]));
  EXPECT_EQ(r.values[r.at(0, 0, 0, 3)], 4);
}

TEST(Recordings, ErrorsNameFileAndLine) {
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,1\nA,0,1,abc\n"), AllOf(HasSubstr("recordings.csv:3: "), HasSubstr("abc"), HasSubstr("strain")));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,inf\n"), HasSubstr("recordings.csv:2: "));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,zero,1\n"), AllOf(HasSubstr("recordings.csv:2: "), HasSubstr("zero")));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0.5,0,1\n"), AllOf(HasSubstr("recordings.csv:2: "), HasSubstr("0.5")));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,1\nA,0,1\n"), AllOf(HasSubstr("recordings.csv:3: "), HasSubstr("3 columns"), HasSubstr("4")));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,1\nA,0,1,1,1\n"), HasSubstr("recordings.csv:3: "));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,1\nA,0,1,1\nA,0,0,1\n"), AllOf(HasSubstr("recordings.csv:4: "), HasSubstr("twice")));
  // a second series that is not the longest
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,1\nA,0,1,1\nA,0,2,1\nB,0,0,1\nB,0,0,1\n"),
              AllOf(HasSubstr("recordings.csv:6: "), HasSubstr("twice")));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,1\nA,0,1,1\nA,0,2,1\nA,0,3.5,1\n"), AllOf(HasSubstr("recordings.csv:5: "), HasSubstr("irregular")));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\nA,0,0,1\nA,0,1,1\nA,0,2,1\nB,0,0,1\nB,0,0.5,1\n"),
              AllOf(HasSubstr("recordings.csv:6: "), HasSubstr("grid")));
  EXPECT_THAT(message_of("time,A\n0,1\n1,2\n1,3\n"), AllOf(HasSubstr("recordings.csv:4: "), HasSubstr("increase")));
  EXPECT_THAT(message_of("time,A,A\n0,1,1\n"), AllOf(HasSubstr("recordings.csv:1: "), HasSubstr("twice")));
  EXPECT_THAT(message_of("0,1\n1,2\n"), AllOf(HasSubstr("recordings.csv:1: "), HasSubstr("missing header")));
  EXPECT_THAT(message_of("alpha,beta\n1,2\n"), AllOf(HasSubstr("recordings.csv:"), HasSubstr("missing header")));
  EXPECT_THAT(message_of(""), AllOf(HasSubstr("recordings.csv:1: "), HasSubstr("empty")));
  EXPECT_THAT(message_of("sensor,pulse,time,strain\n"), HasSubstr("no row"));
  EXPECT_THAT(message_of("sensor,pulse,time,strain,gain\nA,0,0,1,1\n"), AllOf(HasSubstr("recordings.csv:1: "), HasSubstr("2")));
}

TEST(Recordings, ALineOfWordsMayStandAboveTheLongForm) {
  const auto r = read("Run 7 of the morning\n" + long_form);
  EXPECT_EQ(r.sensors, (std::vector<std::string>{"B", "A"}));
  EXPECT_THAT(r.warnings, testing::ElementsAre(HasSubstr("1 lines before the header")));
  EXPECT_EQ(read("Logger\nTime,11:57\nDate,2020\ntime,A\n0,1\n1,2\n").time, (std::vector<double>{0, 1}));
}

TEST(Recordings, UnitsMayStandInTheHeader) {
  EXPECT_EQ(read("time [us] A B\n0 1 2\n1 3 4\n").time, (std::vector<double>{0, 1e-6}));
  const auto wide = read("time,A [um/m],B [um/m]\n0,1,2\n1,3,4\n", "microstrain");
  EXPECT_EQ(wide.sensors, (std::vector<std::string>{"A", "B"}));
  EXPECT_DOUBLE_EQ(wide.values[3], 4e-6);
  EXPECT_DOUBLE_EQ(read("sensor,time,strain [um/m]\nA,0,1\nA,1,2\n", "microstrain").values[1], 2e-6);
  EXPECT_EQ(read("time,A [top],B [rear]\n0,1,2\n1,3,4\n").sensors, (std::vector<std::string>{"A [top]", "B [rear]"}));  // the columns have names but no units
  EXPECT_THAT(message_of("time,A [um/m],B [m/m]\n0,1,2\n", "microstrain"), AllOf(HasSubstr("recordings.csv:1: "), HasSubstr("B [m/m]"), HasSubstr("one unit")));
}

TEST(Recordings, SayWhatTheyCannotBe) {
  EXPECT_THAT(message_of("time [min],A\n0,1\n1,2\n"), AllOf(HasSubstr("recordings.csv:1: "), HasSubstr("time [min]"), HasSubstr("s, ms, us, ns")));
  EXPECT_THAT(message_of(std::string("time,A\n\0\0\1\2", 11)), HasSubstr("no text file"));
  EXPECT_THAT(message_of("sensor,pulse,time,stress\nA,0,0,1\nA,0,1,2\n"), AllOf(HasSubstr("called stress"), HasSubstr("recordings.unit")));
  EXPECT_EQ(read("sensor,pulse,time,pressure\nA,0,0,1\nA,0,1,2\n", "Pa").unit, "Pa");
}

TEST(Recordings, AFileThatIsNotThereIsAnErrorOfTheCase) {
  CaseFile file = CaseFile::from_text("[case]\nname = 'x'\n[recordings]\nfile = 'recs.csv'\n");
  const auto options = read_recording_options(file);
  try {
    file.locating([&] { (void)read_recordings("/nowhere/recs.csv", options); });
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("case.toml:4"), HasSubstr("recs.csv")));
  }
}

TEST(Recordings, RoundedTimesAreMetOnAnEvenGrid) {
  std::string text = "sensor,pulse,time,strain\n";  // 3.3 us printed in whole microseconds
  for (int i = 0; i < 200; ++i) text += fmt::format("A,0,{:.6f},{}\n", 3.3e-6 * i, i);
  const auto r = read(text);
  ASSERT_EQ(r.time.size(), 200u);
  EXPECT_NEAR(r.time[1] - r.time[0], 3.3e-6, 1e-9);
  EXPECT_NEAR(r.time[199], 199 * 3.3e-6, 1e-6);
  EXPECT_THAT(r.warnings, testing::ElementsAre(HasSubstr("rounded")));
}

TEST(Recordings, NoiseIsANumberOrATable) {
  CaseFile one = CaseFile::from_text("[recordings]\nfile = 'a.csv'\nunit = 'microstrain'\nnoise = 2.0\n");
  EXPECT_DOUBLE_EQ(read_recording_options(one).noise_of("A").value(), 2);  // in the unit of the data
  CaseFile table = CaseFile::from_text("[recordings]\nfile = 'a.csv'\nunit = 'kPa'\n[recordings.noise]\nA = 0.5\nB = 3\n");
  const auto options = read_recording_options(table);
  EXPECT_EQ(options.noise_of("A"), 0.5);
  EXPECT_EQ(options.noise_of("B"), 3);
  EXPECT_FALSE(options.noise_of("C").has_value());
  EXPECT_EQ(echo(options)["noise"]["B"], 3);
  CaseFile bad = CaseFile::from_text("[recordings]\nfile = 'a.csv'\n[recordings.noise]\nA = -0.5\n");
  EXPECT_THROW((void)read_recording_options(bad), InputError);
  CaseFile unknown = CaseFile::from_text("[recordings]\nfile = 'a.csv'\nnoize = 1\n");
  EXPECT_THROW((void)read_recording_options(unknown), InputError);
  CaseFile window = CaseFile::from_text("[recordings]\nfile = 'a.csv'\nbegin = 2.0\nend = 1.0\n");
  EXPECT_THROW((void)read_recording_options(window), InputError);
}

/// recordings.nc of a text file in this unit, as `calomel import --unit` makes it.
std::filesystem::path write_as(const std::filesystem::path& dir, const std::string& unit) {
  const auto text = dir / "text.csv";
  write_atomically(text, "sensor,pulse,time,strain\nA,0,0,5\nA,0,1,6\n");
  const std::vector<std::filesystem::path> files{text};
  return import_recordings(files, {.unit = unit}, dir).path;
}

// The values of another model have a unit of their own, whatever the name of a column.
TEST(Recordings, OfAnotherModelAreTakenAsTheyAre) {
  const auto path = scratch("as_it_is") / "recordings.csv";
  write_atomically(path, "sensor,pulse,time,microstrain\nA,0,0,5\nA,0,1,6\n");
  RecordingOptions options{.unit = "microstrain", .noise = 2};
  EXPECT_DOUBLE_EQ(read_recordings(path, options).values[1], 6e-6);
  EXPECT_DOUBLE_EQ(*read_recordings(path, options).noise_of("A", options), 2e-6);
  options.as_it_is = true;
  const auto r = read_recordings(path, options);
  EXPECT_EQ(r.values, (std::vector<double>{5, 6}));
  EXPECT_EQ(r.unit, "microstrain");
  EXPECT_DOUBLE_EQ(*r.noise_of("A", options), 2);
  // The unit that the file declares is checked: strain and microstrain are one quantity, others are not. The noise that the case gives is converted with the
  // values.
  options.unit = "strain";
  EXPECT_DOUBLE_EQ(read_recordings(path, options).values[1], 6e-6);
  EXPECT_DOUBLE_EQ(*read_recordings(path, options).noise_of("A", options), 2e-6);
  options.unit = "V";
  EXPECT_THROW((void)read_recordings(path, options), InputError);
  const auto file = write_as(path.parent_path(), "microstrain");
  options.unit = "microstrain";
  EXPECT_NEAR(read_recordings(file, options).values[1], 6, 1e-12);
  options.unit = "V";
  EXPECT_THROW((void)read_recordings(file, options), InputError);
  EXPECT_EQ(read_recordings(write_as(path.parent_path(), "V"), options).values[1], 6);
  EXPECT_EQ(read_recordings(write_as(path.parent_path(), "Volts"), options).values[1], 6);  // in the form that LabVIEW writes
  EXPECT_NEAR(read_recordings(write_as(path.parent_path(), "mV"), options).values[1], 6e-3, 1e-15);
}

TEST(Recordings, UnitsAreReadAsFilesSpellThem) {
  for (const auto& [word, quantity, size] : std::vector<std::tuple<std::string, std::string, double>>{{"V", "voltage", 1},
                                                                                                      {"Volts", "voltage", 1},
                                                                                                      {"volt", "voltage", 1},
                                                                                                      {"mV", "voltage", 1e-3},
                                                                                                      {"Millivolts", "voltage", 1e-3},
                                                                                                      {"kPa", "pressure", 1e3},
                                                                                                      {"MPa", "pressure", 1e6},
                                                                                                      {"mPa", "pressure", 1e-3},
                                                                                                      {"mbar", "pressure", 1e2},
                                                                                                      {"kilopascal", "pressure", 1e3},
                                                                                                      {"1", "strain", 1},
                                                                                                      {"Strain", "strain", 1},
                                                                                                      {"Microstrain", "strain", 1e-6},
                                                                                                      {"uE", "strain", 1e-6},
                                                                                                      {"um/m", "strain", 1e-6},
                                                                                                      {"\xc2\xb5\xce\xb5", "strain", 1e-6},
                                                                                                      {"mm", "length", 1e-3},
                                                                                                      {"m/s", "velocity", 1},
                                                                                                      {"mm/s", "velocity", 1e-3},
                                                                                                      {"ms", "time", 1e-3},
                                                                                                      {"\xc2\xb5s", "time", 1e-6},
                                                                                                      {"Seconds", "time", 1},
                                                                                                      {"sec", "time", 1}}) {
    const auto unit = reading_unit(word);
    ASSERT_TRUE(unit) << word;
    EXPECT_EQ(unit->quantity, quantity) << word;
    EXPECT_DOUBLE_EQ(unit->size, size) << word;
  }
  for (const char* word : {"", "S", "furlong", "v", "kpa", "counts", "xV"}) EXPECT_FALSE(reading_unit(word)) << word;
}

TEST(Recordings, OffsetWindowAndExclusionAreApplied) {
  const auto path = scratch("window") / "recordings.csv";
  write_atomically(path, "time,A,B\n0,0,10\n1,1,11\n2,2,12\n3,3,13\n4,4,14\n");
  const auto r = read_recordings(path, {.trigger_offset = 1, .begin = 0, .end = 2, .exclude = {"A"}});
  EXPECT_EQ(r.sensors, (std::vector<std::string>{"B"}));
  EXPECT_EQ(r.time, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(r.values, (std::vector<double>{11, 12, 13}));
  EXPECT_THROW((void)read_recordings(path, {.exclude = {"C"}}), InputError);
  EXPECT_THROW((void)read_recordings(path, {.exclude = {"A", "B"}}), InputError);
  EXPECT_THROW((void)read_recordings(path, {.begin = 9}), InputError);
}

TEST(Recordings, SensorsAreHeldAgainstTheCase) {
  const auto r = read(long_form);
  const std::vector<std::string> all{"A", "B", "C"}, few{"B"};
  EXPECT_THAT(match_sensors(r, all, "case.toml", "recordings.csv"), testing::ElementsAre(HasSubstr("C is declared but not recorded")));
  EXPECT_THAT(match_sensors(r, all, "case.toml", "recordings.csv", std::vector<std::string>{"C"}),
              testing::ElementsAre(HasSubstr("C is left out by recordings.exclude")));
  try {
    (void)match_sensors(r, few, "case.toml", "recordings.csv");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("recordings.csv:5: "), HasSubstr("\"A\""), HasSubstr("case.toml")));
  }
}

TEST(Recordings, OfAModelOutsideAreThoseAtItsTimes) {
  std::string dense = "time,A,B\n", half = dense, own = dense;
  for (int i = 0; i < 9; ++i)
    dense += fmt::format("{},{},{}\n", 0.25 * i, i, 10 * i), half += fmt::format("{},1,2\n", i + 0.5), own += fmt::format("{},1,2\n", i);
  std::vector<std::string> warnings;
  const auto r = at_times_of(read(dense), 0, 1, warnings);
  EXPECT_EQ(r.time, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(r.values, (std::vector<double>{0, 4, 8, 0, 40, 80}));
  EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("6 of 9 record times")));
  warnings.clear();
  EXPECT_EQ(at_times_of(read(half), 0, 1, warnings).time.size(), 9u);
  EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("interpolated")));
  warnings.clear();
  EXPECT_EQ(at_times_of(read(own), 0, 1, warnings).time.size(), 9u);
  EXPECT_EQ(at_times_of(read(own), 0, 0.5, warnings).time.size(), 9u);  // the sparse record has every second time
  EXPECT_TRUE(warnings.empty());
}

TEST(Recordings, RoundTripThroughNetcdf) {
  const auto dir = scratch("roundtrip");
  auto r = read("condition,sensor,pulse,time,strain\nlow,A,2,0,1e-5\nlow,A,2,1,2e-5\nlow,B,4,0,3e-5\nlow,B,4,1,nan\nhigh,A,2,0,5e-5\nhigh,A,2,1,6e-5\n");
  write_recordings(dir / "recordings.nc", r);
  const auto back = read_recordings_file(dir / "recordings.nc");
  EXPECT_EQ(back.conditions, r.conditions);
  EXPECT_EQ(back.sensors, r.sensors);
  EXPECT_EQ(back.pulses, r.pulses);
  EXPECT_EQ(back.time, r.time);
  EXPECT_EQ(back.unit, "strain");
  ASSERT_EQ(back.values.size(), r.values.size());
  for (std::size_t i = 0; i < r.values.size(); ++i) EXPECT_TRUE(back.values[i] == r.values[i] || (std::isnan(back.values[i]) && std::isnan(r.values[i])));
  EXPECT_THAT(back.warnings, testing::ElementsAre(HasSubstr("1 dropouts")));
  EXPECT_THROW((void)read_recordings_file(dir / "recordings.nc", "microstrain"), InputError);  // the file declares strain

  r = read(long_form);
  write_recordings(dir / "plain.nc", r);
  const NetcdfReader file(dir / "plain.nc");
  EXPECT_EQ(file.dimensions("strain"), (std::vector<std::string>{"sensor", "pulse", "time"}));
  EXPECT_EQ(file.attribute("units", "time"), "s");
  EXPECT_EQ(file.attribute("units", "strain"), "1");
}

TEST(Recordings, NetcdfDimensionsMayStandInAnotherOrder) {
  const auto path = scratch("order") / "recordings.nc";
  {
    NetcdfWriter w(path);
    w.dimension("time", 2);
    w.dimension("sensor", 3);
    const std::vector<double> time{0, 1}, strain{1, 2, 3, 4, 5, 6};
    const std::vector<std::string> names{"A", "B", "C"};
    w.variable("time", {"time"}, time, {{"units", "ms"}});
    w.variable("sensor", {"sensor"}, names);
    w.variable("strain", {"time", "sensor"}, strain, {{"units", "microstrain"}});
    w.commit();
  }
  const auto r = read_recordings_file(path);
  EXPECT_DOUBLE_EQ(r.time[1], 1e-3);
  EXPECT_DOUBLE_EQ(r.values[r.at(0, 2, 0, 1)], 6e-6);
  EXPECT_DOUBLE_EQ(r.values[r.at(0, 1, 0, 0)], 2e-6);
}

TEST(Import, WideFilesBecomePulsesAndLongOnesKeepTheirs) {
  const auto dir = scratch("import");
  write_atomically(dir / "a.csv", "time,A,B\n0,1,2\n1,3,4\n");
  write_atomically(dir / "b.csv", "time,B\n0,5\n1,6\n");
  write_atomically(dir / "c.csv", "sensor,pulse,time,strain\nC,1,0,7\nC,1,1,8\n");
  const std::vector<std::filesystem::path> files{dir / "a.csv", dir / "b.csv", dir / "c.csv"};
  const auto summary = import_recordings(files, {}, dir / "out");
  EXPECT_TRUE(std::filesystem::exists(dir / "out" / "recordings.nc"));
  const auto r = read_recordings_file(summary.path);
  EXPECT_EQ(r.sensors, (std::vector<std::string>{"A", "B", "C"}));
  EXPECT_EQ(r.pulses, (std::vector<int>{0, 1}));
  EXPECT_EQ(r.values[r.at(0, 0, 0, 1)], 3);
  EXPECT_FALSE(r.recorded(0, 0, 1));
  EXPECT_EQ(r.values[r.at(0, 1, 1, 0)], 5);
  EXPECT_EQ(r.values[r.at(0, 2, 1, 1)], 8);
  // The merged file is imported again with another one, and the same samples are given twice.
  const std::vector<std::filesystem::path> again{summary.path, dir / "b.csv"}, twice{dir / "c.csv", dir / "c.csv"};
  EXPECT_EQ(import_recordings(again, {}, dir / "out2").recordings.pulses.size(), 3u);
  try {
    (void)import_recordings(twice, {}, dir / "out3");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("c.csv:2: "), HasSubstr("twice")));
  }
}

TEST(Import, LabviewHeaderGivesTheStep) {
  const auto path = scratch("labview") / "check.dat";
  std::string text =
      "LabVIEW "
      "Measurement,\nSeparator,Comma\nDecimal_Separator,.\nTime,11:57:49.6\n***End_of_Header***,\n,\nChannels,2,,\nSamples,5,5,\nY_Unit_Label,Volts,Volts,\n"
      "X0,0.0000E+0,0.0000E+0,\nDelta_X,3.300000E-7,3.300000E-7,\n***End_of_Header***,,,\nX_Value,Input bar signal,Output bar signal,Comment\n";
  for (int i = 0; i < 5; ++i) text += fmt::format("{:.6f},{},{}\n", 3.3e-7 * i, i, -i);
  write_atomically(path, text);
  const auto r = read_recordings_file(path);
  EXPECT_EQ(r.sensors, (std::vector<std::string>{"Input bar signal", "Output bar signal"}));
  EXPECT_EQ(r.unit, "Volts");
  EXPECT_NEAR(r.time[4], 4 * 3.3e-7, 1e-15);
  EXPECT_EQ(r.values[r.at(0, 1, 0, 3)], -3);
  // the header of an instrument, without the word LabVIEW
  const auto other = read("Scope 4\nTime,11:57\nOperator,me\nTime,A,B\n0,1,2\n1,3,4\n");
  EXPECT_EQ(other.values, (std::vector<double>{1, 3, 2, 4}));
  EXPECT_THAT(other.warnings, testing::ElementsAre(HasSubstr("3 lines")));
}

TEST(Recordings, AHundredThousandRowsAreReadAtOnce) {
  std::string text = "sensor,pulse,time,strain\n";
  RandomStream random(1, 0);
  for (int s = 0; s < 11; ++s)
    for (int p = 0; p < 18; ++p)
      for (int t = 0; t < 471; ++t) text += fmt::format("S{:02d},{},{:.6e},{:.6e}\n", s, p, t * 1e-6, 1e-4 * random.normal());
  const auto path = scratch("speed") / "recordings.csv";
  write_atomically(path, text);
  const auto start = std::chrono::steady_clock::now();
  const auto r = read_recordings_file(path);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(r.values.size(), 11u * 18 * 471);
  EXPECT_LT(seconds, 2.0);  // measured: about 0.03 s; the bound leaves room for a busy machine
  RecordProperty("seconds", std::to_string(seconds));
}
