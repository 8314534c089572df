// Mixed-up channels are found from the base fit, and gauges that are merely alike are not taken for them.
#include "uq/diagnosis/mislabelled_channels.hpp"

#include <gmock/gmock.h>

#include "tests/unit/uq/diagnosis/wiring.hpp"

namespace calomel {
namespace {

using ::testing::IsEmpty;

TEST_F(Wiring, IsInOrderWhereEachRecordIsLikeItsGauge) {
  EXPECT_THAT(mislabelled_channels(problem, grid, simulation, simulation), IsEmpty());
  Eigen::VectorXd records = simulation;
  records.segment(at(2), size()) *= 0.4;  // a gain is another fault
  EXPECT_THAT(mislabelled_channels(problem, grid, records, simulation), IsEmpty());
  records.segment(at(0), size()).swap(records.segment(at(1), size()));  // the channels cannot be distinguished
  EXPECT_THAT(mislabelled_channels(problem, grid, records, simulation), IsEmpty());
}

TEST_F(Wiring, FindsAnInvertedChannel) {
  Eigen::VectorXd records = simulation;
  records.segment(at(1), size()) *= -0.9;
  const auto found = mislabelled_channels(problem, grid, records, simulation);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].gauge, problem.label(problem.observations[1]));
  EXPECT_EQ(found[0].other, "");
  EXPECT_NEAR(found[0].own, -1, 1e-12);
}

TEST_F(Wiring, FindsAnotherUnit) {
  for (const double factor : {1e-3, 0.15, 8.0}) {
    Eigen::VectorXd records = simulation;
    records.segment(at(2), size()) *= factor;
    const auto found = mislabelled_channels(problem, grid, records, simulation);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].gauge, problem.label(problem.observations[2]));
    EXPECT_NEAR(found[0].factor, factor, 1e-12 * factor);
    EXPECT_EQ(found[0].other, "");
    EXPECT_GT(found[0].own, 0.9);
  }
}

TEST_F(Wiring, TakesAnotherSizeOfAllGaugesForTheEnergy) { EXPECT_THAT(mislabelled_channels(problem, grid, 20 * simulation, simulation), IsEmpty()); }

TEST_F(Wiring, FindsTwoSwappedGaugesOnce) {
  Eigen::VectorXd records = simulation;
  const Eigen::VectorXd third = records.segment(at(2), size());
  records.segment(at(2), size()) = records.segment(at(3), size());
  records.segment(at(3), size()) = third;
  const auto found = mislabelled_channels(problem, grid, records, simulation);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].gauge, problem.label(problem.observations[2]));
  EXPECT_EQ(found[0].other, problem.label(problem.observations[3]));
  EXPECT_NEAR(found[0].like, 1, 1e-12);
  EXPECT_LT(found[0].own, 0.7);
}

TEST_F(Wiring, DoesNotGuessAtADeadGauge) {
  Eigen::VectorXd records = simulation;
  records.segment(at(2), size()).setZero();
  EXPECT_THAT(mislabelled_channels(problem, grid, records, simulation), IsEmpty());
}

}  // namespace
}  // namespace calomel
