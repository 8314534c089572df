// Which records are held out together.
#include "uq/diagnosis/held_out.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/uq/experiment.hpp"
#include "tests/unit/uq/diagnosis/traveller.hpp"

namespace calomel {
namespace {

TEST(Folds, OfASingleRecordAreQuartersOfItsTimeElseGauges) {
  const Traveller one(0);
  const auto quarters = folds_by_face(one.problem, Decimation(one.problem, 120), {});
  ASSERT_EQ(quarters.size(), 4u);
  EXPECT_EQ(quarters[1].rows.front(), 30);
  EXPECT_EQ(quarters[3].rows.back(), 119);
  EXPECT_DOUBLE_EQ(quarters[0].records, 0.25);
  const Experiment six(0, 0, 0, 1, 1);
  const Decimation grid(six.problem, 240);
  const auto gauges = folds_by_face(six.problem, grid, {});
  ASSERT_EQ(gauges.size(), 6u);
  EXPECT_EQ(gauges[2].rows.front(), Eigen::Index(grid.offset(2)));
  EXPECT_EQ(gauges[2].rows.size(), grid.windows(2).size());
}

/// Observations of this many gauges under two conditions, on a grid of their own.
Problem of_two_conditions(std::size_t gauges) {
  const AnalyticModel model({uniform_parameter("a", 0, 2, 1)},
                            std::vector<AnalyticModel::Function>(gauges, [](auto p, double t) { return p[0] * std::sin(1e5 * t); }), 40, 1e-6);
  Problem problem = make_problem(model.shape(), pulses_of(model, {1}, {.pulses = 3, .noise = 0.1}, 2), {});
  problem.shape.conditions = {"weak", "strong"};
  for (std::size_t i = 0; i < gauges; ++i) {
    problem.observations.push_back(problem.observations[i]);
    problem.observations.back().condition = 1;
  }
  return problem;
}

// A gauge that was left out under one strength of the pulse and fitted under another was not left out.
TEST(Folds, OfAGaugeHoldAllItsConditions) {
  const Problem two = of_two_conditions(2);
  const Decimation grid(two, 160);
  const auto folds = folds_by_face(two, grid, {});
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_EQ(folds[0].records, 2);
  EXPECT_EQ(folds[0].rows.front(), Eigen::Index(grid.offset(0)));
  EXPECT_EQ(folds[0].rows.back(), Eigen::Index(grid.offset(2) + grid.windows(2).size()) - 1);
  EXPECT_EQ(folds_by_face(of_two_conditions(1), Decimation(of_two_conditions(1), 80), {}).size(), 2u);  // a single gauge: each condition
}

// The outermost gauges of one wall are no faces of the target.
TEST(Folds, AreFacesOfTheTargetAlone) {
  const Experiment six(0, 0, 0, 1, 1);
  const Decimation grid(six.problem, 240);
  GaugePlaces places;
  places.positions.resize(6, 3);
  for (int s = 0; s < 6; ++s) places.positions.row(s) << 0.01 * s, 0.0, 0.03;
  places.outermost.resize(2, 3);
  places.outermost << -0.02, -0.01, 0, 0.08, 0.01, 0.03;
  EXPECT_EQ(folds_by_face(six.problem, grid, places).size(), 6u);  // all on the top wall: each alone
  places.positions(0, 0) = -0.02;
  places.positions(0, 2) = 0.015;
  places.positions(5, 2) = 0;
  EXPECT_EQ(folds_by_face(six.problem, grid, places).size(), 3u);  // front, bottom and top
}

}  // namespace
}  // namespace calomel
