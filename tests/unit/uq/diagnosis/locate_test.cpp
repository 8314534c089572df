// Location of the mismatch: times without records, and false discoveries.
#include "uq/diagnosis/locate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

TEST(Locate, TestsNoTimesThatWereNotRecorded) {
  const AnalyticModel model({uniform_parameter("a", 0, 2, 1)},
                            {[](auto p, double t) { return p[0] * std::sin(1e5 * t); }, [](auto p, double t) { return p[0] * std::cos(1e5 * t); }}, 160, 1e-6);
  auto recordings = pulses_of(model, {1}, {.pulses = 3, .noise = 0.1}, 2);
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t t = 0; t < 160; ++t) {
      if (t < 80) recordings.values[recordings.at(0, 0, p, t)] = recordings.values[recordings.at(0, 1, p, t)] = std::nan("");
      if (t >= 120) recordings.values[recordings.at(0, 1, p, t)] = std::nan("");
    }
  const Problem problem = make_problem(model.shape(), recordings, {});
  const Decimation grid(problem, 400);
  const LocatedMismatch l = locate(problem, grid, Eigen::VectorXd::Constant(Eigen::Index(grid.size()), 0.5),
                                   Eigen::MatrixXd::Identity(Eigen::Index(grid.size()), Eigen::Index(grid.size())));
  EXPECT_NEAR(l.windows.front().begin, 79.5e-6, 1e-9);  // the stretches are those of the records
  for (const auto& w : l.windows) EXPECT_NEAR(w.score, 0.25, 1e-12);
  EXPECT_NEAR(l.map(0, 7), 0.25, 1e-12);
  EXPECT_TRUE(std::isnan(l.map(1, 7)));
  EXPECT_TRUE(std::isnan(l.map_q_values(1, 7)));
}

TEST(Locate, FalseDiscoveriesAreCountedAmongThePartsThatWereTested) {
  const double none = std::nan("");
  const auto q = false_discovery({0.01, none, 0.2, none});
  const auto two = false_discovery({0.01, 0.2});
  EXPECT_EQ(q[0], two[0]);
  EXPECT_EQ(q[2], two[1]);
  EXPECT_TRUE(std::isnan(q[1]));
}

TEST(FalseDiscovery, IsThatOfBenjaminiAndYekutieli) {
  // p.adjust(c(0.001, 0.01, 0.02, 0.5), "BY") of R: 4 (1 + 1/2 + 1/3 + 1/4) p / rank, from above.
  const double c = 4 * (1 + 1.0 / 2 + 1.0 / 3 + 1.0 / 4);
  const auto q = false_discovery({0.02, 0.001, 0.5, 0.01});
  EXPECT_NEAR(q[1], 0.001 * c, 1e-12);
  EXPECT_NEAR(q[3], 0.01 * c / 2, 1e-12);
  EXPECT_NEAR(q[0], 0.02 * c / 3, 1e-12);
  EXPECT_NEAR(q[2], 1, 1e-12);
}

}  // namespace
}  // namespace calomel
