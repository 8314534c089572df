#include "base/median.hpp"

#include <gtest/gtest.h>

namespace calomel {
namespace {

TEST(Median, IsTheMiddleOfAnOddNumberOfValues) {
  EXPECT_EQ(upper_median({3, 1, 2}), 2);
  EXPECT_EQ(upper_median({7}), 7);
}

TEST(Median, IsTheGreaterOfTheTwoMiddleOnesOfAnEvenNumber) { EXPECT_EQ(upper_median({4, 1, 3, 2}), 3); }

TEST(Median, OfNothingIsAContractFailure) { EXPECT_ANY_THROW((void)upper_median({})); }

}  // namespace
}  // namespace calomel
