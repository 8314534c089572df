// The runs of a diagnosis are counted, and a step that is skipped is listed once.
#include "uq/diagnosis/run_budget.hpp"

#include <gtest/gtest.h>

namespace calomel {
namespace {

TEST(RunBudget, CountsRunsAndRefusesNone) {
  const RunAdded run = [](const Eigen::MatrixXd& thetas, const std::vector<int>&, std::span<const AddedParameter>) {
    return std::vector<RunRecord>(std::size_t(thetas.cols()), RunRecord{.done = true});
  };
  RunBudget budget(run, 10);
  EXPECT_TRUE(budget.allows(10));
  EXPECT_EQ(budget.run(Eigen::MatrixXd::Zero(1, 7), std::vector<int>(7, 0), {}).size(), 7u);
  EXPECT_EQ(budget.made(), 7);
  EXPECT_TRUE(budget.allows(3));
  EXPECT_FALSE(budget.allows(4));
  EXPECT_FALSE(budget.used_up());
  (void)budget.run(Eigen::MatrixXd::Zero(1, 5), std::vector<int>(5, 0), {});
  EXPECT_EQ(budget.made(), 12);
  EXPECT_TRUE(budget.used_up());
  EXPECT_FALSE(budget.exhausted());  // until a step says that it lacked runs
}

TEST(RunBudget, ListsASkippedStepOnce) {
  const RunAdded none;
  RunBudget budget(none, 10);
  const SkippedStep step{.kind = SkippedStep::Kind::fit, .name = "echo", .runs = 12, .made = 3, .limit = 10};
  budget.skip(step);
  budget.skip({.kind = SkippedStep::Kind::no_effect, .name = "drift"});
  budget.skip(step);
  ASSERT_EQ(budget.skipped().size(), 2u);
  EXPECT_EQ(budget.skipped()[0], step);
  EXPECT_EQ(budget.skipped()[1].name, "drift");
}

}  // namespace
}  // namespace calomel
