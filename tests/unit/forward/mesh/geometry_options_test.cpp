#include "forward/mesh/geometry_options.hpp"

#include <gmock/gmock.h>

#include "base/case_file.hpp"

using namespace calomel;
using ::testing::HasSubstr;

namespace {

/// Returns the message of reading `text` as a case, "" when it is valid; `key` is set to the key of the error.
std::string message_of(const std::string& text, std::string* key = nullptr) {
  CaseFile file = CaseFile::from_text(text);
  GeometryOptions g;
  try {
    file.read("geometry", g);
  } catch (const InputError& e) {
    if (key) *key = e.parts().key;
    return e.what();
  }
  return "";
}
const std::string box = "[geometry]\nkind = 'box'\nlength = 0.211\nwidth = 0.1\nheight = 0.062\nplane_strain = true\n";

}  // namespace

TEST(GeometryOptions, ReadsABoxOfACase) {
  CaseFile file = CaseFile::from_text(box + "walls = {front = 0.006, rear = 0.005, side = 0.005, top = 0.006, bottom = 0.004}\nelement_size = 0.001\n");
  GeometryOptions g;
  file.read("geometry", g);
  EXPECT_EQ(g.wall_thickness("top"), 0.006);
  EXPECT_EQ(g.wall_thickness("bottom"), 0.004);
  EXPECT_EQ(g.divisions(0.0025, false), 3);
  EXPECT_EQ(g.divisions(0.003, false), 3);
  EXPECT_EQ(g.divisions(0.0005, true), 2);
}

TEST(GeometryOptions, AWallThatFillsTheVesselIsBlamed) {
  std::string key;
  const auto m = message_of(box + "element_size = 0.001\nwalls = {front = 0.006, top = 0.06, bottom = 0.004}\n", &key);
  EXPECT_EQ(key, "geometry.walls.top");
  EXPECT_THAT(m, HasSubstr("case.toml:8:"));
  EXPECT_THAT(m, HasSubstr("0.06"));
  EXPECT_THAT(m, HasSubstr("mercury"));
  message_of(box + "element_size = 0.001\nwall = 0.04\n", &key);
  EXPECT_EQ(key, "geometry.wall");
}

TEST(GeometryOptions, TinyElementsAreRefusedBeforeAnythingIsAllocated) {
  for (const char* h : {"1e-9", "1e-200"}) {
    std::string key;
    const auto m = message_of(box + "wall = 0.004\nelement_size = " + h + "\n", &key);
    EXPECT_EQ(key, "geometry.element_size");
    EXPECT_THAT(m, HasSubstr("max_elements"));
  }
}

TEST(GeometryOptions, MissingAndForeignKeysAreNamed) {
  std::string key;
  EXPECT_THAT(message_of(box + "wall = 0.004\n", &key), HasSubstr("missing"));
  EXPECT_EQ(key, "geometry.element_size");
  message_of(box + "element_size = 0.001\n", &key);
  EXPECT_EQ(key, "geometry.walls.top");
  message_of(box + "element_size = 0.001\nwall = 0.004\nradius = 0.1\n", &key);
  EXPECT_EQ(key, "geometry.radius");
  EXPECT_THAT(message_of(box + "element_size = 0.001\nwal = 0.004\n"), HasSubstr("did you mean \"wall\"?"));
  message_of(box + "element_size = 0.001\nwall = 0.004\nwall_elements = 1\n", &key);
  EXPECT_EQ(key, "geometry.wall_elements");
  message_of("[geometry]\nlength = 1\n", &key);
  EXPECT_EQ(key, "geometry");
  EXPECT_EQ(message_of("[geometry]\nkind = 'mesh'\nfile = 'target.exo'\n"), "");
  message_of("[geometry]\nkind = 'mesh'\n", &key);
  EXPECT_EQ(key, "geometry.file");
  message_of("[geometry]\nkind = 'mesh'\nfile = 'target.exo'\nwall = 0.004\n", &key);
  EXPECT_EQ(key, "geometry.wall");
  EXPECT_THAT(message_of("[geometry]\nkind = 'mesh'\nfile = 'target.exo'\nhalf = true\n", &key), HasSubstr("sets.symmetry_y"));
  message_of(box + "element_size = 0.001\nwall = 0.004\nscale = 0.001\n", &key);
  EXPECT_EQ(key, "geometry.scale");
  message_of(box + "element_size = 0.001\nwall = 0.004\nsets = {steel = ['a']}\n", &key);
  EXPECT_EQ(key, "geometry.sets.steel");
}
