// The judged suites of docs/proof: what is scored of each of their cases stands in one archive, from which every published confusion can be counted again.
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <string>

#include "apps/challenge/judged_case.hpp"
#include "apps/challenge/score.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/command_output.hpp"
#include "tests/scratch.hpp"

namespace calomel::challenge {
namespace {

namespace fs = std::filesystem;
using calomel::testing::output_of;

/// The archive's files, unpacked by the command that docs/proof gives.
std::map<std::string, fs::path> unpacked() {
  const fs::path folder = scratch("suites");
  const auto [text, well] = output_of("tar -xf '" CALOMEL_SOURCE_DIR "/docs/proof/suites.tar.xz' -C '" + folder.string() + "'");
  EXPECT_TRUE(well) << text;
  std::map<std::string, fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder / "suites")) files[entry.path().stem().string()] = entry.path();
  return files;
}

TEST(PublishedSuites, AreCountedAgainFromTheirCases) {
  const auto files = unpacked();
  EXPECT_EQ(files.size(), 16u);
  std::size_t all = 0;
  for (const auto& [name, path] : files) {
    const Json published = read_json(path);
    std::string rule;
    auto cases = read_scored(path, rule);
    EXPECT_EQ(rule.size(), 16u) << name;
    EXPECT_EQ(published["cases"], cases.size()) << name;
    EXPECT_EQ(score_json(score_of(cases), cases)["confusion"], published["confusion"]) << name;
    all += cases.size();
    cases.pop_back();
    EXPECT_NE(score_json(score_of(cases), cases)["confusion"], published["confusion"]) << name << ": the control, a case less";
  }
  EXPECT_EQ(all, 807u);
}

}  // namespace
}  // namespace calomel::challenge
