// Tests that the boundary of failures is found and that searches avoid it.
#include "forward/surrogate/feasibility.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "forward/campaign/campaign.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/posterior/basin.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

const std::vector<Parameter> plane{uniform_parameter("a", 0, 2, 1), uniform_parameter("b", 10, 30, 20)};

/// Runs fail beyond a slanted line.
bool breaks(double a, double b) { return a / 2 + (b - 10) / 20 > 1.4; }

struct Runs {
  Eigen::MatrixXd theta = design_points("sobol", plane, 150, 3);
  std::vector<bool> failed;
  Runs() {
    for (Eigen::Index i = 0; i < theta.cols(); ++i) failed.push_back(breaks(theta(0, i), theta(1, i)));
  }
};

TEST(Feasibility, FindsTheBoundary) {
  const Runs runs;
  const Feasibility f(plane, runs.theta, runs.failed);
  EXPECT_TRUE(f.any_failed());
  EXPECT_GT(f.leave_one_out_accuracy(), 0.95);
  const Eigen::MatrixXd at = design_points("sobol", plane, 400, 99);
  int right = 0;
  for (Eigen::Index i = 0; i < 400; ++i) right += f.feasible({at.col(i).data(), 2}) != breaks(at(0, i), at(1, i));
  EXPECT_GT(right, 380);
  const std::vector<double> corner{2, 30}, inside{0.5, 15};
  EXPECT_GT(f.failure_probability(corner), 0.9);
  EXPECT_LT(f.failure_probability(inside), 0.05);
}

TEST(Feasibility, FailuresByChanceMakeNoBoundary) {
  // One run in twelve fails, anywhere: no place is to be avoided.
  Runs runs;
  RandomStream random(8, 0);
  for (std::size_t i = 0; i < runs.failed.size(); ++i) runs.failed[i] = random.uniform() < 1.0 / 12;
  const Feasibility f(plane, runs.theta, runs.failed);
  const Eigen::MatrixXd at = design_points("sobol", plane, 400, 99);
  int off = 0;
  for (Eigen::Index i = 0; i < 400; ++i) off += !f.feasible({at.col(i).data(), 2});
  EXPECT_LT(off, 12);
}

TEST(Feasibility, WithoutFailuresEverythingIsOpen) {
  const Runs runs;
  const Feasibility f(plane, runs.theta, std::vector<bool>(150, false));
  EXPECT_FALSE(f.any_failed());
  const std::vector<double> corner{2, 30};
  EXPECT_TRUE(f.feasible(corner));
  EXPECT_EQ(f.failure_probability(corner), 0);
}

TEST(Feasibility, ReasonsAreCountedWithoutTheirNumbers) {
  Archive archive;
  archive.message = {"", "step 12: element 7 collapsed", "step 9: element 1234 collapsed", "the value at sensor S1, time 1e-05 s is not finite"};
  const auto reasons = failure_reasons(archive);
  EXPECT_EQ(reasons.at("step #: element # collapsed"), 2u);
  EXPECT_EQ(reasons.size(), 2u);
}

/// The best fit to the record lies beyond the boundary. The surrogate predicts there; the true model fails there.
TEST(Feasibility, OptimisersAreKeptOffWhatFails) {
  AnalyticModel model(plane, {[](auto p, double t) { return p[0] * 100 * std::sin(6e4 * t) + p[1] * std::cos(9e4 * t); }}, 100, 1e-6);
  const AnalyticModel surrogate = model;  // the surrogate predicts no failure
  const auto recordings = pulses_of(model, {1.7, 27}, {.pulses = 6, .noise = 2, .noise_time = 4e-6}, 2);
  model.fails = [](std::span<const double> p) { return breaks(p[0], p[1]); };
  const Problem problem = make_problem(model.shape(), recordings, {});
  const Runs runs;
  const Feasibility f(plane, runs.theta, runs.failed);
  const GuardedModel guarded(surrogate, f);
  // The basin of the records according to the surrogate.
  const auto basin = [&](const ForwardModel& search) { return find_basin(problem, recordings, {}, {.values = 60, .band = 1e9}, search, 0.02, {}, 1, 1); };
  const auto blind = basin(surrogate), kept = basin(guarded);
  EXPECT_TRUE(breaks(blind[0], blind[1]));
  EXPECT_TRUE(f.feasible(kept));
  EXPECT_FALSE(f.feasible(blind));
  EXPECT_LT(kept[0] / 2 + (kept[1] - 10) / 20, 0.9 * (blind[0] / 2 + (blind[1] - 10) / 20));
  EXPECT_GT(kept[0] / 2 + (kept[1] - 10) / 20, 1.2);  // up to the boundary, since the true point is beyond it
  // The same holds for ENC.
  const auto enc = run_enc(problem, guarded, model, {.rounds = 4, .generations = 40, .population = 20}, 1, 1);
  EXPECT_TRUE(enc.trusted()) << enc.message;
  EXPECT_FALSE(breaks(enc.theta[0], enc.theta[1]));
}

}  // namespace
}  // namespace calomel
