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
  const FrameFile file(path, "calomel test 1", provenance, [&](std::string_view payload) { found.emplace_back(payload); });
  return found;
}
}  // namespace

TEST(FrameFile, CutAtAnyByteKeepsEveryFrameThatIsWhole) {
  const auto path = scratch_file("frames");
  {
    FrameFile file(path, "calomel test 1", own, [](std::string_view) { FAIL(); });
    file.append("one"), file.append(std::string(5, '\0')), file.append("three");
  }
  const auto size = std::filesystem::file_size(path);
  const std::string whole = read_text(path);
  std::size_t last = 0;
  for (std::size_t bytes = 0; bytes <= size; ++bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, bytes);
    const auto found = frames(path);
    EXPECT_GE(found.size(), last);
    last = found.size();
    EXPECT_EQ(frames(path), found);  // what was torn is gone
  }
  EXPECT_THAT(frames(path), ElementsAre("one", std::string(5, '\0'), "three"));
}

TEST(FrameFile, WritesOverWhatWasTorn) {
  const auto path = scratch_file("torn");
  {
    FrameFile(path, "calomel test 1", own, [](std::string_view) {}).append("one");
  }
  const std::string whole = read_text(path);
  write_atomically(path, whole + whole.substr(whole.size() - 10));
  {
    FrameFile(path, "calomel test 1", own, [](std::string_view) {}).append("two");
  }
  EXPECT_THAT(frames(path), ElementsAre("one", "two"));
}

TEST(FrameFile, OtherSettingsOtherKindsAndOtherUsersAreRefused) {
  const auto path = scratch_file("refused");
  {
    FrameFile(path, "calomel test 1", own, [](std::string_view) {}).append("one");
  }
  try {
    (void)frames(path, {.stage = "sample", .seed = 4});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("seed"));
  }
  EXPECT_THROW(FrameFile(path, "calomel other 1", own, [](std::string_view) {}), InputError);
  const FrameFile held(path, "calomel test 1", own, [](std::string_view) {});
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
