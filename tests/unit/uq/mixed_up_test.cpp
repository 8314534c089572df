// Slips in the wiring are seen from the base fit, and gauges that are merely alike are not taken for them.
#include "uq/diagnosis/mixed_up.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/inverse/lines.hpp"
#include "uq/diagnosis/plain_words.hpp"

namespace calomel {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Four gauges: the first two are nearly alike, the others like none.
class Wiring : public ::testing::Test {
 protected:
  static AnalyticModel::Function wave(double rate, double phase) {
    return [=](auto theta, double t) { return theta[0] * std::sin(rate * t + phase); };
  }
  const AnalyticModel model{{uniform_parameter("amplitude", 0.1, 10, 1)}, {wave(6e4, 0), wave(6e4, 0.3), wave(9e4, 1), wave(4e4, 2)}, 200, 1e-6};
  const Problem problem = make_problem(model.shape(), pulses_of(model, {1}, {.pulses = 2, .noise = 1e-3}, 3), {});
  const Decimation grid{problem, 400};
  const Eigen::VectorXd simulation = grid.apply(Eigen::Map<const Eigen::VectorXd>(model.evaluate(std::vector<double>{1}).mean.data(), 800));

  [[nodiscard]] Eigen::Index at(std::size_t i) const { return Eigen::Index(grid.offset(i)); }
  [[nodiscard]] Eigen::Index size() const { return Eigen::Index(grid.windows(0).size()); }
};

TEST_F(Wiring, IsRightWhereEachRecordIsLikeItsGauge) {
  EXPECT_THAT(mixed_up(problem, grid, simulation, simulation), IsEmpty());
  Eigen::VectorXd records = simulation;
  records.segment(at(2), size()) *= 0.4;  // a gain is another fault
  EXPECT_THAT(mixed_up(problem, grid, records, simulation), IsEmpty());
  records.segment(at(0), size()).swap(records.segment(at(1), size()));  // nobody could tell
  EXPECT_THAT(mixed_up(problem, grid, records, simulation), IsEmpty());
}

TEST_F(Wiring, OfTheOtherSignIsTold) {
  Eigen::VectorXd records = simulation;
  records.segment(at(1), size()) *= -0.9;
  const auto found = mixed_up(problem, grid, records, simulation);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].gauge, problem.label(problem.observations[1]));
  EXPECT_EQ(found[0].other, "");
  EXPECT_NEAR(found[0].own, -1, 1e-12);
  EXPECT_THAT(plain_mixed_up(found[0]), AllOf(HasSubstr("the other sign"), HasSubstr(found[0].gauge)));
}

TEST_F(Wiring, AnotherUnitIsTold) {
  for (const double factor : {1e-3, 0.15, 8.0}) {
    Eigen::VectorXd records = simulation;
    records.segment(at(2), size()) *= factor;
    const auto found = mixed_up(problem, grid, records, simulation);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].gauge, problem.label(problem.observations[2]));
    EXPECT_NEAR(found[0].factor, factor, 1e-12 * factor);
    EXPECT_THAT(plain_mixed_up(found[0]), AllOf(HasSubstr(found[0].gauge + " reads"), HasSubstr("times what the others let expect there"), HasSubstr("unit")));
  }
}

TEST_F(Wiring, OfAllGaugesAnotherSizeIsTheEnergys) { EXPECT_THAT(mixed_up(problem, grid, 20 * simulation, simulation), IsEmpty()); }

TEST_F(Wiring, OfTwoGaugesTakenForEachOtherIsToldOnce) {
  Eigen::VectorXd records = simulation;
  const Eigen::VectorXd third = records.segment(at(2), size());
  records.segment(at(2), size()) = records.segment(at(3), size()), records.segment(at(3), size()) = third;
  const auto found = mixed_up(problem, grid, records, simulation);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].gauge, problem.label(problem.observations[2]));
  EXPECT_EQ(found[0].other, problem.label(problem.observations[3]));
  EXPECT_NEAR(found[0].like, 1, 1e-12);
  EXPECT_LT(found[0].own, 0.7);
}

TEST_F(Wiring, OfADeadGaugeIsNotGuessedAt) {
  Eigen::VectorXd records = simulation;
  records.segment(at(2), size()).setZero();
  EXPECT_THAT(mixed_up(problem, grid, records, simulation), IsEmpty());
}

TEST_F(Wiring, ALateClockIsWhatMovesAllRecords) {
  const Eigen::VectorXd history = Eigen::Map<const Eigen::VectorXd>(model.evaluate(std::vector<double>{1}).mean.data(), 800);
  const AddedDirections late = lateness(problem, grid, history);
  EXPECT_NEAR(late.prior_sd[0], 0.01 * 199e-6, 1e-12);
  Eigen::VectorXd moved(800);
  const double delay = 0.5e-6, rates[] = {6e4, 6e4, 9e4, 4e4}, phases[] = {0, 0.3, 1, 2};
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index k = 0; k < 200; ++k) moved[i * 200 + k] = std::sin(rates[i] * (1e-6 * double(k) - delay) + phases[i]);
  const Eigen::VectorXd change = grid.apply(moved) - grid.apply(history);
  for (std::size_t i = 0; i < 4; ++i)  // the ends have no difference
    EXPECT_LT((change - delay * late.by_number.col(0)).segment(at(i) + 1, size() - 2).norm(), 0.05 * change.segment(at(i) + 1, size() - 2).norm());
  EXPECT_THAT(plain_late({.late = 3.07e-6, .sd = 0.12e-6, .log_bayes_factor = 75.6}),
              AllOf(HasSubstr("All records look 3.07 \u00b1 0.12 \u00b5s late"), HasSubstr("75.6"), HasSubstr("recordings.trigger_offset")));
  EXPECT_THAT(plain_late({.late = -2e-3, .sd = 1e-4, .log_bayes_factor = 9}), HasSubstr("2.00 \u00b1 0.10 ms early"));
}

}  // namespace
}  // namespace calomel
