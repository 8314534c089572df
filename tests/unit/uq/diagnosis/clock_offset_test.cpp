// The effect of an offset of the clock on all records.
#include "uq/diagnosis/clock_offset.hpp"

#include "tests/unit/uq/diagnosis/wiring.hpp"

namespace calomel {
namespace {

TEST_F(Wiring, AnOffsetOfTheClockMovesAllRecords) {
  const Eigen::VectorXd history = Eigen::Map<const Eigen::VectorXd>(model.evaluate(std::vector<double>{1}).mean.data(), 800);
  const AddedDirections late = clock_directions(problem, grid, history);
  EXPECT_NEAR(late.prior_sd[0], 0.01 * 199e-6, 1e-12);
  Eigen::VectorXd moved(800);
  const double delay = 0.5e-6, rates[] = {6e4, 6e4, 9e4, 4e4}, phases[] = {0, 0.3, 1, 2};
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index k = 0; k < 200; ++k) moved[i * 200 + k] = std::sin(rates[i] * (1e-6 * double(k) - delay) + phases[i]);
  const Eigen::VectorXd change = grid.apply(moved) - grid.apply(history);
  for (std::size_t i = 0; i < 4; ++i)  // the ends have no difference
    EXPECT_LT((change - delay * late.by_number.col(0)).segment(at(i) + 1, size() - 2).norm(), 0.05 * change.segment(at(i) + 1, size() - 2).norm());
}

}  // namespace
}  // namespace calomel
