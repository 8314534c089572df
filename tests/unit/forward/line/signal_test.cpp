#include "forward/line/signal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/scratch.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path written(const std::string& text) {
  const auto path = scratch_file("signal.txt");
  std::ofstream(path) << text;
  return path;
}

std::string error_of(const std::string& text, int column = 2, std::optional<double> interval = std::nullopt) {
  try {
    (void)read_signal(written(text), column, interval, "drive.file");
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Signal, ReadsTheColumnBelowAHeaderOfWords) {
  const auto path = written("Writer_Version,2\nSamples,3\n***End***,\n# comment\n0.0,1,10\n0.5,2,20\n1.0;3;30\n1.5 4 40 # end\n");
  const Signal s = read_signal(path, 3, {}, "drive.file");
  EXPECT_EQ(s.begin, 0);
  EXPECT_EQ(s.interval, 0.5);
  EXPECT_THAT(s.value, ElementsAre(10, 20, 30, 40));
  EXPECT_EQ(s.end(), 1.5);
}

TEST(Signal, ReportsFileAndLineOfAMistake) {
  EXPECT_THAT(error_of("0,1\n1,2\n2,3\n3.3,4\n4,5\n"), HasSubstr("signal.txt:4"));
  EXPECT_THAT(error_of("0,1\n1,2\n2,3\n3.3,4\n4,5\n"), HasSubstr("not evenly spaced"));
  EXPECT_EQ(error_of("0,1\n1,2\n2,3\n3.3,4\n4,5\n", 2, 1.0), "");  // the interval is given: printed times are not read
  EXPECT_THAT(error_of("0,1\n1,x\n2,3\n3,4\n"), HasSubstr("signal.txt:2"));
  EXPECT_THAT(error_of("0,1\n1,2\nend,3\n3,4\n"), HasSubstr("a time [s] is expected"));
  EXPECT_THAT(error_of("0,1\n1,2\n2,3\n3,4\n", 3), HasSubstr("column 3 is wanted, there are 2"));
  EXPECT_THAT(error_of("0,1\n1,2\n"), HasSubstr("fewer than four"));
}

TEST(Signal, OfADriveLosesItsBaseline) {
  const Signal s = read_drive(written("0,1\n1,3\n2,7\n3,4\n"), {.baseline = 2, .scale = 10});
  EXPECT_THAT(s.value, ElementsAre(-10, 10, 50, 20));
}

}  // namespace
}  // namespace calomel
