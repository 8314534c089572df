#include "apps/notes.hpp"

#include <gmock/gmock.h>

#include <sstream>
#include <vector>

using namespace calomel;

TEST(Notes, AreALineEachAndWarningsAreMarked) {
  std::ostringstream out;
  const Notes notes(out, false);
  notes.say("one");
  notes.say(std::vector<std::string>{"two", "three"});
  notes.warn("four");
  notes.warn(std::vector<std::string>{});
  EXPECT_EQ(out.str(), "one\ntwo\nthree\nwarning: four\n");
}

TEST(Notes, AreNotPrintedWhenQuiet) {
  std::ostringstream out;
  const Notes notes(out, true);
  notes.say("one");
  notes.warn(std::vector<std::string>{"two"});
  EXPECT_EQ(out.str(), "");
}
