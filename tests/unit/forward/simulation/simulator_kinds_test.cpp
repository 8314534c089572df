#include "forward/simulation/simulator_kinds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/forward/line/line_cases.hpp"

namespace calomel {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  CaseFile file = CaseFile::from_text(text, "case.toml");
  try {
    (void)make_simulator(file, {});
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(SimulatorKinds, ATableOfAnotherKindIsRefusedWithBothKinds) {
  EXPECT_EQ(error_of(pipe_text()), "");
  EXPECT_THAT(
      error_of(pipe_text("[geometry]\nkind = \"box\"\n")),
      AllOf(HasSubstr("case.toml"), HasSubstr("geometry"), HasSubstr("belongs to a model of kind \"built_in\", and the model of this case is of kind \"line\""),
            HasSubstr("set model.kind = \"built_in\"")));
  EXPECT_THAT(error_of("[model]\nkind = \"umbridge\"\n[geometry]\nkind = \"box\"\n"), HasSubstr("the model of this case is of kind \"umbridge\""));
  EXPECT_THAT(error_of("[drive]\nfile = \"a.csv\"\n"), HasSubstr("belongs to a model of kind \"line\", and the model of this case is of kind \"built_in\""));
}

TEST(SimulatorKinds, AnUnknownKindIsRefusedWithTheKnownOnes) {
  EXPECT_THAT(error_of("[model]\nkind = \"lines\"\n"), AllOf(HasSubstr("model.kind"), HasSubstr("line"), HasSubstr("umbridge")));
}

}  // namespace
}  // namespace calomel
