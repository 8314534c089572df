#include "base/instruction_set.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/errors.hpp"

using namespace calomel;

TEST(InstructionSet, TheEnvironmentIsAnUpperLimit) {
  const char* before = std::getenv("CALOMEL_ISA");
  const std::string keep = before ? before : "";
  const auto all = instruction_sets();
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all[0], InstructionSet::baseline);
  for (const auto isa : all) {
    ::setenv("CALOMEL_ISA", name_of(isa), 1);
    EXPECT_EQ(instruction_set(), isa);
  }
  ::setenv("CALOMEL_ISA", "avx512", 1);  // one that the processor may not have
  EXPECT_EQ(instruction_set(), all.back());
  ::setenv("CALOMEL_ISA", "sse9", 1);
  EXPECT_THROW((void)instruction_set(), InputError);
  ::unsetenv("CALOMEL_ISA");
  EXPECT_EQ(instruction_set(), all.back());
  if (before) ::setenv("CALOMEL_ISA", keep.c_str(), 1);
}
