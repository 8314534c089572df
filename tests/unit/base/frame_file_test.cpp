#include "base/frame_file.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "base/provenance.hpp"
#include "base/random.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {
const Provenance own{.stage = "sample", .seed = 3};

std::vector<std::string> frames(const std::filesystem::path& path, const Provenance& provenance = own) {
  std::vector<std::string> found;
  const FrameFile file(path, "calomel test 1", provenance, [&](std::string_view payload, FrameFile::Place) { found.emplace_back(payload); });
  return found;
}
}  // namespace

TEST(FrameFile, CutAtAnyByteKeepsEveryFrameThatIsWhole) {
  const auto path = scratch_file("frames");
  {
    FrameFile file(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) { FAIL(); });
    file.append("one");
    file.append(std::string(5, '\0'));
    file.append("three");
  }
  const auto size = std::filesystem::file_size(path);
  const std::string whole = read_text(path);
  std::size_t last = 0;
  for (std::size_t bytes = 0; bytes <= size; ++bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, bytes);
    const auto found = frames(path);
    EXPECT_GE(found.size(), last);
    last = found.size();
    EXPECT_EQ(frames(path), found);  // the torn frame is gone
  }
  EXPECT_THAT(frames(path), ElementsAre("one", std::string(5, '\0'), "three"));
}

TEST(FrameFile, WritesOverWhatWasTorn) {
  const auto path = scratch_file("torn");
  {
    FrameFile(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {}).append("one");
  }
  const std::string whole = read_text(path);
  write_atomically(path, whole + whole.substr(whole.size() - 10));
  {
    FrameFile(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {}).append("two");
  }
  EXPECT_THAT(frames(path), ElementsAre("one", "two"));
}

TEST(FrameFile, AFrameIsReadAgainAtItsPlaceInThisLifeAndTheNext) {
  const auto path = scratch_file("places");
  std::vector<FrameFile::Place> places, found;
  {
    FrameFile file(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {});
    for (const char* text : {"one", "two", "three"}) places.push_back(file.append(text));
    EXPECT_EQ(file.read(places[1]), "two");
  }
  const FrameFile file(path, "calomel test 1", own, [&](std::string_view, FrameFile::Place place) { found.push_back(place); });
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(file.read(found[i]), file.read(places[i]));
  EXPECT_EQ(file.read(found[2]), "three");
  EXPECT_THROW((void)file.read({places[0].offset + 1, places[0].bytes}), InputError);  // no frame begins at this offset
}

TEST(FrameFile, ADamagedFrameAndWhatFollowsAreGivenUp) {
  const auto path = scratch_file("damage");
  std::vector<std::uint64_t> ends;
  {
    FrameFile file(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {});
    ends.push_back(std::filesystem::file_size(path));
    for (const char* text : {"one", "two", "three", "four"}) file.append(text), ends.push_back(std::filesystem::file_size(path));
  }
  const std::string bytes = read_text(path);
  RandomStream random(1, 0);
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = bytes;
    const std::size_t at = ends[0] + random.below(bytes.size() - ends[0]);
    damaged[at] = char(damaged[at] ^ (1 + random.below(255)));
    std::ofstream(path, std::ios::binary | std::ios::trunc) << damaged;
    std::size_t whole = 0;
    while (ends[whole + 1] <= at) ++whole;
    ASSERT_EQ(frames(path).size(), whole) << at;
  }
}

TEST(FrameFile, ItsIdentityIsReadWithoutOpeningIt) {
  const auto path = scratch_file("identity");
  EXPECT_EQ(FrameFile::identity(path, "calomel test 1"), "");
  const FrameFile held(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {});
  EXPECT_EQ(FrameFile::identity(path, "calomel test 1"), own.identity());
  EXPECT_EQ(FrameFile::identity(path, "calomel other 1"), "");
}

TEST(FrameFile, AForeignFileAndADamagedHeadAreRefusedUntouched) {
  const auto path = scratch_file("foreign");
  {
    FrameFile(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {}).append("one");
  }
  std::string damaged = read_text(path);
  damaged[60] ^= 1;
  for (const std::string& text : {std::string("a letter to a friend"), damaged}) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
    EXPECT_THROW((void)frames(path), InputError);
    EXPECT_EQ(read_text(path), text);
  }
}

TEST(FrameFile, OtherSettingsOtherKindsAndOtherUsersAreRefused) {
  const auto path = scratch_file("refused");
  {
    FrameFile(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {}).append("one");
  }
  try {
    (void)frames(path, {.stage = "sample", .seed = 4});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("seed"));
  }
  EXPECT_THROW(FrameFile(path, "calomel other 1", own, [](std::string_view, FrameFile::Place) {}), InputError);
  const FrameFile held(path, "calomel test 1", own, [](std::string_view, FrameFile::Place) {});
  EXPECT_THROW((void)frames(path), InputError);
}

TEST(FrameFile, ARandomStreamTakenOffItsBytesGoesOn) {
  RandomStream random(3, 5);
  for (int i = 0; i < 100; ++i) (void)random.normal();
  ByteWriter out;
  out.value(random);
  out.text("after");
  RandomStream other(1, 1);
  ByteReader in(out.bytes);
  in.into(other);
  EXPECT_EQ(in.text(), "after");
  EXPECT_TRUE(in.at_end());
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(random.normal(), other.normal());
  EXPECT_THROW((void)in.value<double>(), ContractFailure);
}
