#include "apps/exit_status.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/scratch.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {
template <class E>
std::pair<int, std::string> ended(const E& error) {
  std::ostringstream err;
  const int status = guarded([&]() -> ExitStatus { throw error; }, err);
  return {status, err.str()};
}
}  // namespace

TEST(ExitStatus, FollowsFromWhatWentWrong) {
  EXPECT_EQ(ended(InputError({.problem = "x"})).first, 2);
  EXPECT_EQ(ended(NumericsError("x")).first, 3);
  EXPECT_EQ(ended(Interrupted()).first, 130);
  EXPECT_EQ(ended(std::bad_alloc()).first, 3);
  EXPECT_EQ(ended(std::filesystem::filesystem_error("x", "/a/file", std::make_error_code(std::errc::permission_denied))).first, 2);
  EXPECT_EQ(ended(ContractFailure("x")).first, 1);
  EXPECT_THAT(ended(ContractFailure("x")).second, HasSubstr("defect"));
  std::ostringstream err;
  EXPECT_EQ(guarded([] { return ExitStatus::not_to_be_trusted; }, err), 4);
  EXPECT_EQ(guarded([] { return ExitStatus::done; }, err), 0);
  EXPECT_EQ(err.str(), "");
}

TEST(ExitStatus, AnInputErrorShowsTheLineWithACaret) {
  const auto path = scratch_file("exit_status.toml");
  std::ofstream(path) << "[load]\npeak_presure = 1\n";
  const auto text = ended(InputError({.problem = "unknown key", .key = "load.peak_presure", .file = path.string(), .line = 2, .column = 1})).second;
  EXPECT_EQ(text, path.string() + ":2:1: load.peak_presure: unknown key\n  peak_presure = 1\n  ^\n");
}

TEST(ExitStatus, AnInputErrorWithoutAFileNamesTheProgram) { EXPECT_THAT(ended(InputError({.problem = "no verb"})).second, testing::StartsWith("calomel: ")); }
