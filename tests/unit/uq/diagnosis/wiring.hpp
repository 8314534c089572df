#pragma once
/// A model of four gauges whose channels can be mixed up.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {

/// The first two gauges are nearly alike, the others are like none.
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

}  // namespace calomel
