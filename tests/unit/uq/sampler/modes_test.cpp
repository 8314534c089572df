#include "uq/sampler/modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/uq/sampler/densities.hpp"
#include "forward/campaign/design.hpp"
#include "uq/convergence/assess.hpp"

namespace calomel {
namespace {

/// Weights, places and deviations of normals of equal width in all directions.
struct Part {
  double weight;
  Eigen::VectorXd mean;
  double sd;
};

testing::Sloped mixture(std::vector<Part> parts) {
  const auto d = std::size_t(parts[0].mean.size());
  return {d, [parts](std::span<const double> at, std::span<double> g) {
            const Eigen::Map<const Eigen::VectorXd> x(at.data(), Eigen::Index(at.size()));
            std::vector<double> logs;
            for (const auto& p : parts)
              logs.push_back(std::log(p.weight) - double(x.size()) * std::log(p.sd) - 0.5 * (x - p.mean).squaredNorm() / (p.sd * p.sd));
            const double top = *std::max_element(logs.begin(), logs.end());
            double sum = 0;
            for (const double l : logs) sum += std::exp(l - top);
            Eigen::VectorXd slope = Eigen::VectorXd::Zero(x.size());
            for (std::size_t i = 0; i < parts.size(); ++i) slope -= std::exp(logs[i] - top) / sum * (x - parts[i].mean) / (parts[i].sd * parts[i].sd);
            std::copy(slope.begin(), slope.end(), g.begin());
            return top + std::log(sum);
          }};
}

/// A design over a cube of this half width, the search begun at its middle too.
std::vector<LaplaceMode> searched(const LogDensity& density, double half_width) {
  const auto d = Eigen::Index(density.dimension());
  const Eigen::MatrixXd design = half_width * (2 * sobol_points(std::size_t(d), 512, 1).array() - 1);
  return density_modes(density, design, Eigen::VectorXd::Zero(d), 1);
}

const Part far{0.3, Eigen::Vector2d(-10, 0), 1}, wide{0.7, Eigen::Vector2d(10, 0), 1}, narrow{0.5, Eigen::Vector2d(5, 5), 0.1};

TEST(DensityModes, AreAllFoundWithTheirShares) {
  const auto modes = searched(mixture({far, wide}), 20);
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_NEAR(modes[0].x[0], 10, 1e-3);
  EXPECT_NEAR(modes[0].weight, 0.7, 1e-3);
  EXPECT_NEAR(modes[1].x[0], -10, 1e-3);
  EXPECT_LT((modes[0].covariance - Eigen::Matrix2d::Identity()).norm(), 1e-3);
}

TEST(DensityModes, ANarrowOneIsFoundBesideAWideOne) {
  const auto modes = searched(mixture({{0.5, Eigen::Vector2d(-5, -5), 1}, narrow}), 15);
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_NEAR(modes[0].weight, 0.5, 0.01);
  for (const auto& m : modes) EXPECT_NEAR(std::sqrt(m.covariance(0, 0)), m.x[0] > 0 ? 0.1 : 1, 1e-3);
}

TEST(DensityModes, OneDensityHasOne) {
  EXPECT_EQ(searched(testing::banana(), 5).size(), 1u);
  Eigen::VectorXd middle = Eigen::VectorXd::Constant(10, 0.3);
  EXPECT_EQ(searched(mixture({{1, middle, 0.2}}), 4).size(), 1u);
  // 2.5 deviations apart: two tops, and hardly a valley between them.
  EXPECT_EQ(searched(mixture({{0.5, Eigen::Vector2d(-1.25, 0), 1}, {0.5, Eigen::Vector2d(1.25, 0), 1}}), 6).size(), 1u);
}

TEST(DensityModes, OneOfNoWeightIsLeftOut) {
  EXPECT_EQ(searched(mixture({wide, {1e-7, Eigen::Vector2d(-10, 0), 1}}), 20).size(), 1u);
  EXPECT_EQ(searched(mixture({wide, {1e-3, Eigen::Vector2d(-10, 0), 1}}), 20).size(), 2u);
}

TEST(DensityModes, NoPositiveDensityIsAnError) {
  const testing::Written nowhere(1, [](std::span<const double>) { return -std::numeric_limits<double>::infinity(); });
  EXPECT_THROW((void)searched(nowhere, 1), NumericsError);
}

class EveryKind : public ::testing::TestWithParam<const char*> {};

/// Share of the draws right of 0.
double share_right(const SamplerResult& r) {
  double right = 0;
  const auto d = r.coordinates.names.size();
  for (std::size_t i = 0; i < r.coordinates.values.size(); i += d) right += r.coordinates.values[i] > 0;
  return right * double(d) / double(r.coordinates.values.size());
}

SamplerOptions shortened(const std::string& kind) {
  SamplerOptions o = default_sampler_options(kind);
  if (kind == "dram") o.draws = 4000;
  if (kind == "ensemble") o.draws = 600;
  return o;
}

/// Modes twenty deviations apart, which no chain crosses by itself: shares within 4 standard errors of some 2000 independent draws.
TEST_P(EveryKind, DrawsFromAllModesInTheirShares) {
  const auto density = mixture({far, wide});
  const auto r =
      run_sampler(density, start_at_modes(searched(density, 20)), shortened(GetParam()), {.seed = 2, .journal = {}, .provenance = {}, .progress = {}});
  const auto c = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_TRUE(c.converged) << int(c.finding.state);
  EXPECT_NEAR(share_right(r), 0.7, 4 * std::sqrt(0.21 / 2000));
}

TEST_P(EveryKind, DrawsFromANarrowModeInItsShare) {
  const auto density = mixture({{0.5, Eigen::Vector2d(-5, -5), 1}, narrow});
  const auto r =
      run_sampler(density, start_at_modes(searched(density, 15)), shortened(GetParam()), {.seed = 3, .journal = {}, .provenance = {}, .progress = {}});
  EXPECT_NEAR(share_right(r), 0.5, 4 * std::sqrt(0.25 / 2000));
}

/// Samplers that jump between modes; smc starts from a population instead.
class KindsThatJump : public ::testing::TestWithParam<const char*> {};

/// Wrong weights of the modes reduce the acceptance and do not change the shares.
TEST_P(KindsThatJump, WrongWeightsDoNotMoveTheShares) {
  const auto density = mixture({far, wide});
  auto start = start_at_modes(searched(density, 20));
  start.modes[0].weight = 0.1;
  start.modes[1].weight = 0.9;
  start.modes[0].covariance *= 2;
  start.modes[1].covariance *= 0.7;
  const auto r = run_sampler(density, start, shortened(GetParam()), {.seed = 4, .journal = {}, .provenance = {}, .progress = {}});
  EXPECT_NEAR(share_right(r), 0.7, 4 * std::sqrt(0.21 / 1000));
}

INSTANTIATE_TEST_SUITE_P(Samplers, EveryKind, ::testing::Values("dram", "nuts", "ensemble", "smc"), [](const auto& info) { return std::string(info.param); });
INSTANTIATE_TEST_SUITE_P(Samplers, KindsThatJump, ::testing::Values("dram", "nuts", "ensemble"), [](const auto& info) { return std::string(info.param); });

/// The control: chains with one common start miss the other mode, whatever R-hat they have.
TEST(DensityModes, ChainsOfOneModeMissTheOther) {
  const auto density = mixture({far, wide});
  const SamplerStart one{.mean = Eigen::Vector2d(10, 0), .covariance = Eigen::Matrix2d::Identity(), .points = {}};
  EXPECT_EQ(share_right(run_sampler(density, one, shortened("dram"), {.seed = 2, .journal = {}, .provenance = {}, .progress = {}})), 1);
}

/// Chains that begin in different modes and cannot jump disagree, and the convergence check reports it.
TEST(DensityModes, ChainsThatCannotJumpAreNotConverged) {
  const auto density = mixture({far, wide});
  const auto modes = searched(density, 20);
  SamplerStart apart{.mean = {}, .covariance = Eigen::Matrix2d::Identity(), .points = Eigen::MatrixXd(2, 4)};
  for (Eigen::Index c = 0; c < 4; ++c) apart.points.col(c) = modes[std::size_t(c % 2)].x;
  const auto r = run_sampler(density, apart, shortened("dram"), {.seed = 2, .journal = {}, .provenance = {}, .progress = {}});
  const auto convergence = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_FALSE(convergence.converged);
  EXPECT_EQ(convergence.finding.state, ChainState::separate_modes);
}

}  // namespace
}  // namespace calomel
