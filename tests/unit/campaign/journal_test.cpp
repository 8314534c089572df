#include "forward/campaign/journal.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "base/random.hpp"
#include "tests/scratch.hpp"

using namespace calomel;

namespace {

const Provenance provenance{.stage = "campaign", .options = {{"campaign", {{"runs", 9}}}, {"load", {{"peak_pressure", 1e7}}}}};

RunRecord record(std::size_t run) {
  RunRecord r{.done = run % 4 != 3};
  if (!r.done) return r.message = "step 3, element " + std::to_string(run), r;
  r.mean = {float(run), 2, 3};
  r.energy_slope = {4, 5, float(run)};
  r.pulses = {1, 2, 3, 4, 5, 6};
  r.energies = {0.99, 1.01};
  return r;
}

/// A journal of five runs; the places at which its records end.
std::vector<std::uint64_t> write_five(const std::filesystem::path& path) {
  std::vector<std::uint64_t> ends;
  Journal journal(path, provenance);
  ends.push_back(std::filesystem::file_size(path));
  for (std::size_t i = 0; i < 5; ++i) {
    journal.append(i, record(i));
    ends.push_back(std::filesystem::file_size(path));
  }
  return ends;
}

}  // namespace

TEST(Journal, GivesBackWhatWasAppendedAlsoAfterReopening) {
  const auto path = scratch("journal") / "campaign.journal";
  write_five(path);
  const Journal journal(path, provenance);
  EXPECT_EQ(journal.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(journal.read(i), record(i));
  EXPECT_FALSE(journal.contains(5));
}

TEST(Journal, CutAtAnyByteKeepsEveryRecordThatIsWhole) {
  const auto dir = scratch("journal_cut");
  const auto ends = write_five(dir / "whole");
  const std::string bytes = read_text(dir / "whole");
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    const auto path = dir / "cut";
    std::ofstream(path, std::ios::binary) << bytes.substr(0, cut);
    std::size_t whole = 0;
    while (whole < 5 && ends[whole + 1] <= cut) ++whole;
    Journal journal(path, provenance);
    ASSERT_EQ(journal.size(), whole) << cut;
    for (std::size_t i = 0; i < whole; ++i) ASSERT_EQ(journal.read(i), record(i)) << cut;
    journal.append(7, record(7));  // the torn bytes are gone
    ASSERT_EQ(journal.read(7), record(7));
    ASSERT_EQ(std::filesystem::file_size(path), ends[whole] + (ends[4] - ends[3]));  // run 3 and run 7 have records of one length
  }
}

TEST(Journal, ADamagedRecordAndWhatFollowsAreGivenUp) {
  const auto dir = scratch("journal_damage");
  const auto ends = write_five(dir / "whole");
  const std::string bytes = read_text(dir / "whole");
  RandomStream random(1, 0);
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = bytes;
    const std::size_t at = ends[0] + random.below(bytes.size() - ends[0]);
    damaged[at] = char(damaged[at] ^ (1 + random.below(255)));
    std::ofstream(dir / "damaged", std::ios::binary) << damaged;
    std::size_t whole = 0;
    while (ends[whole + 1] <= at) ++whole;
    const Journal journal(dir / "damaged", provenance);
    ASSERT_EQ(journal.size(), whole) << at;
    for (std::size_t i = 0; i < whole; ++i) ASSERT_EQ(journal.read(i), record(i));
  }
}

TEST(Journal, OtherSettingsAreRefusedByNameAndNothingIsLost) {
  const auto path = scratch("journal_other") / "campaign.journal";
  write_five(path);
  const auto before = read_text(path);
  Provenance other = provenance;
  other.options["load"]["peak_pressure"] = 2e7;
  try {
    const Journal journal(path, other);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("load.peak_pressure"), testing::HasSubstr("--fresh")));
  }
  EXPECT_EQ(read_text(path), before);
}

TEST(Journal, AForeignFileAndADamagedHeadAreRefusedUntouched) {
  const auto dir = scratch("journal_foreign");
  write_five(dir / "damaged");
  std::string damaged = read_text(dir / "damaged");
  damaged[60] ^= 1;
  for (const std::string& text : {std::string("a letter to a friend"), damaged}) {
    std::ofstream(dir / "foreign", std::ios::binary) << text;
    EXPECT_THROW(Journal(dir / "foreign", provenance), InputError);
    EXPECT_EQ(read_text(dir / "foreign"), text);
  }
}

TEST(Journal, TwoAtOnceAreRefused) {
  const auto path = scratch("journal_lock") / "campaign.journal";
  const Journal first(path, provenance);
  EXPECT_THROW(Journal(path, provenance), InputError);
}
