#include "apps/pipeline/finished_stages.hpp"

#include <gmock/gmock.h>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "base/provenance.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

Provenance provenance(int epochs) { return {.stage = "train", .options = {{"surrogate", {{"epochs", epochs}}}}}; }

/// A folder in which the stage stands finished, of so many epochs.
fs::path finished(const std::string& name, int epochs) {
  const auto dir = scratch(name);
  write_json(dir / "train.json", {{"provenance", provenance(epochs).json()}});
  write_atomically(dir / "surrogate.nc", "learnt");
  return dir;
}

const std::vector<std::string> files{"train.json", "surrogate.nc"};

}  // namespace

TEST(FinishedStages, AreReusedWhenTheyMatchAndAllFilesExist) {
  const auto dir = finished("finished", 10);
  FinishedStages stages(dir, false);
  EXPECT_FALSE(stages.due(provenance(10), files, Requested::by_user));
  fs::remove(dir / "surrogate.nc");
  EXPECT_TRUE(stages.due(provenance(10), files, Requested::by_user));
  EXPECT_TRUE(FinishedStages(scratch("none"), false).due(provenance(10), files, Requested::upstream));
}

TEST(FinishedStages, OfOtherSettingsAreRefusedWithTheKeyAndLeftAsTheyAre) {
  const auto dir = finished("other", 10);
  FinishedStages stages(dir, false);
  try {
    (void)stages.due(provenance(20), files, Requested::upstream);
    FAIL() << "it should have been refused";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("surrogate.epochs"));
  }
  EXPECT_EQ(read_text(dir / "surrogate.nc"), "learnt");
}

TEST(FinishedStages, FreshSetsAsideTheRequestedStageAndUpstreamOnlyThoseThatDoNotMatch) {
  const auto dir = finished("fresh", 10);
  EXPECT_FALSE(FinishedStages(dir, true).due(provenance(10), files, Requested::upstream));
  EXPECT_TRUE(FinishedStages(dir, true).due(provenance(10), files, Requested::by_user));
  EXPECT_EQ(read_text(dir / "surrogate.nc.old-1"), "learnt");
  const auto other = finished("fresh_upstream", 10);
  EXPECT_TRUE(FinishedStages(other, true).due(provenance(20), files, Requested::upstream));
  EXPECT_TRUE(fs::exists(other / "train.json.old-1"));
}

// What a call that was cut off has left is of other settings too, and may stand there alone.
TEST(FinishedStages, FreshSetsAsideWhatWasLeftUnfinished) {
  const auto dir = scratch("unfinished");
  write_atomically(dir / "train.journal", "half");
  EXPECT_TRUE(FinishedStages(dir, false).due(provenance(10), files, Requested::by_user, "train.journal"));
  EXPECT_EQ(read_text(dir / "train.journal"), "half");
  EXPECT_TRUE(FinishedStages(dir, true).due(provenance(10), files, Requested::by_user, "train.journal"));
  EXPECT_FALSE(fs::exists(dir / "train.journal"));
  EXPECT_EQ(read_text(dir / "train.journal.old-1"), "half");
}

TEST(FinishedStages, FreshSetsNothingAsideThatTheSameCallMade) {
  const auto dir = finished("made", 10);
  FinishedStages stages(dir, true);
  EXPECT_TRUE(stages.due(provenance(10), files, Requested::by_user));
  write_json(dir / "train.json", {{"provenance", provenance(10).json()}});
  write_atomically(dir / "surrogate.nc", "learnt anew");
  EXPECT_FALSE(stages.due(provenance(10), files, Requested::by_user));
  EXPECT_EQ(read_text(dir / "surrogate.nc"), "learnt anew");
}
