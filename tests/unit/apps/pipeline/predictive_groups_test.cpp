#include "apps/pipeline/predictive_groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

/// Errors on the coarse grid stand on the record's own times: linear between the grid's, constant beyond, nothing where nothing is recorded.
TEST(PredictiveGroups, ErrorsAreOnTheRecordsTimes) {
  const AnalyticModel model(
      {uniform_parameter("a", 0, 2, 1)},
      {[](auto theta, double t) { return theta[0] * std::sin(6e4 * t); }, [](auto theta, double t) { return theta[0] * std::cos(6e4 * t); }}, 300, 1e-6);
  auto recordings = pulses_of(model, {1}, {.pulses = 2, .noise = 1e-3}, 3);
  for (std::size_t p = 0; p < 2; ++p) recordings.values[recordings.at(0, 1, p, 150)] = std::nan("");
  const Problem problem = make_problem(model.shape(), recordings, {});
  const Decimation grid(problem, 100);
  Eigen::VectorXd variance(Eigen::Index(grid.size()));
  for (std::size_t o = 0; o < 2; ++o)
    for (std::size_t w = 0; w < grid.windows(o).size(); ++w)
      variance[Eigen::Index(grid.offset(o) + w)] = std::pow(double(o + 1) + 1e4 * grid.windows(o)[w].time, 2);
  const auto sd = error_sd(problem, grid, variance);
  ASSERT_EQ(sd.size(), 2 * problem.time.size());
  for (std::size_t o = 0; o < 2; ++o)
    for (std::size_t i = 0; i < problem.time.size(); ++i) {
      const double t = problem.time[i], first = grid.windows(o).front().time, last = grid.windows(o).back().time;
      if (o == 1 && i == 150)
        EXPECT_TRUE(std::isnan(sd[o * problem.time.size() + i]));
      else
        EXPECT_NEAR(sd[o * problem.time.size() + i], double(o + 1) + 1e4 * std::clamp(t, first, last), 1e-9) << o << ' ' << t;
    }
}

}  // namespace
}  // namespace calomel
