#include "uq/convergence/diagnostics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "tests/unit/uq/convergence/chains.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

std::vector<double> flat(const Json& chains) {
  std::vector<double> x;
  for (const auto& c : chains)
    for (const auto& v : c) x.push_back(v.get<double>());
  return x;
}

}  // namespace

// Chains and numbers of reference.py, the same formulas written a second time (its Beta quantiles by integration, its sums without a Fourier
// transform).
TEST(Convergence, NumbersAreThoseOfASecondProgram) {
  const Json reference = read_json(std::filesystem::path(CALOMEL_SOURCE_DIR) / "tests/unit/uq/convergence/reference.json");
  ASSERT_GE(reference.size(), 9u);
  for (const auto& [name, c] : reference.items()) {
    SCOPED_TRACE(name);
    const auto values = flat(c["chains"]);
    const ChainDraws x{values, c["chains"].size()};
    const auto near = [&, &c = c](double got, const char* key) {
      const double expected = c[key].get<double>();
      EXPECT_NEAR(got, expected, 1e-8 * (1 + std::abs(expected))) << key;
    };
    near(split_r_hat(x), "r_hat");
    near(ess_bulk(x), "ess_bulk");
    near(ess_tail(x), "ess_tail");
    near(ess_mean(x), "ess_mean");
    near(mcse_mean(x), "mcse_mean");
    near(mcse_sd(x), "mcse_sd");
    near(mcse_quantile(x, 0.05), "mcse_q05");
    near(mcse_quantile(x, 0.5), "mcse_median");
  }
}

TEST(Convergence, EffectiveSampleSizeOfAnAutoregressionIsKnown) {
  // tau = (1 + a) / (1 - a); the estimate's own relative error is about sqrt(2 window / n), 5 % here.
  for (const double a : {-0.3, 0.0, 0.5, 0.9}) {
    const auto x = chains_of(4, 20000, a);
    EXPECT_NEAR(ess_mean({x, 4}) / (80000 * (1 - a) / (1 + a)), 1, 0.15) << a;
    EXPECT_LT(split_r_hat({x, 4}), 1.01) << a;
  }
}

TEST(Convergence, AlternatingChainsHaveMoreEffectiveSamplesThanDraws) {
  const auto x = chains_of(4, 1000, -0.3);
  EXPECT_GT(ess_mean({x, 4}), 4000);
  const auto y = chains_of(4, 1000, -0.95);
  EXPECT_NEAR(ess_mean({y, 4}), 4000 * std::log10(4000.0), 1e-6);  // no more than that
}

TEST(Convergence, ConstantOrNonFiniteChainsHaveNoResult) {
  const std::vector<double> same(40, 3.0);
  EXPECT_TRUE(std::isnan(split_r_hat({same, 4})));
  EXPECT_TRUE(std::isnan(ess_bulk({same, 4})));
  EXPECT_TRUE(std::isnan(mcse_quantile({same, 4}, 0.5)));
  std::vector<double> apart(40, 3.0);
  for (std::size_t i = 20; i < 40; ++i) apart[i] = 4;
  EXPECT_TRUE(std::isinf(split_r_hat({apart, 4})));
  auto x = chains_of(4, 100);
  x[17] = calomel::nan;
  EXPECT_TRUE(std::isnan(split_r_hat({x, 4})));
  EXPECT_TRUE(std::isnan(ess_tail({x, 4})));
  x[17] = INFINITY;
  EXPECT_TRUE(std::isnan(mcse_mean({x, 4})));
  const std::vector<double> few{1, 2, 3, 4, 5, 6};
  EXPECT_TRUE(std::isnan(split_r_hat({few, 2})));
}

TEST(Convergence, DoesNotDependOnUnitsNorAThousandfoldStretchOfATail) {
  const auto x = chains_of(4, 500, 0.5);
  auto y = x;
  for (double& v : y) v = 1e6 * std::exp(3 * v);  // any increasing function
  EXPECT_DOUBLE_EQ(ess_bulk({x, 4}), ess_bulk({y, 4}));
  EXPECT_DOUBLE_EQ(ess_tail({x, 4}), ess_tail({y, 4}));
}

TEST(Convergence, QuantilesInterpolateBetweenOrderStatistics) {
  const std::vector<double> x{4, 1, 3, 2};
  EXPECT_DOUBLE_EQ(quantile(x, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile(x, 0), 1);
  EXPECT_DOUBLE_EQ(quantile(x, 1), 4);
  EXPECT_DOUBLE_EQ(quantile(x, 0.05), 1.15);
}

// Betancourt 2016; by hand: energies 1, 2, 4, 3: changes 1, 4, 1, squares about 2.5: 2.25 + 0.25 + 2.25 + 0.25.
TEST(Convergence, EnergyFractionIsTheFormula) {
  EnergyChanges e;
  for (const double v : {1.0, 2.0, 4.0}) e.add(v);
  EXPECT_TRUE(std::isnan(e.e_bfmi()));
  e.add(3);
  EXPECT_DOUBLE_EQ(e.e_bfmi(), 6.0 / 5.0);
  EnergyChanges same;
  for (int i = 0; i < 10; ++i) same.add(3);
  EXPECT_TRUE(std::isnan(same.e_bfmi()));
  // An autoregression has 2 (1 - a); its standard error is 2 (1 - a^2)^1/2 / n^1/2 or less.
  for (const double a : {0.0, 0.5, 0.95}) {
    EnergyChanges chain;
    for (const double v : chains_of(1, 20000, a)) chain.add(v);
    EXPECT_NEAR(chain.e_bfmi(), 2 * (1 - a), 4 * 2 / std::sqrt(20000.0)) << a;
  }
}

// Eight walkers that share half of their variance at each lag: each alone seems to be worth more than all are.
TEST(Convergence, WalkersThatMoveTogetherAreNotCountedAsIndependent) {
  const std::size_t walkers = 8, n = 2000;
  std::vector<double> x(4 * walkers * n);
  for (std::size_t e = 0; e < 4; ++e) {
    const auto common = chains_of(
        1, n, 0.9, [](std::size_t, std::size_t) { return 0.0; }, 50 + e);
    const auto own = chains_of(
        walkers, n, 0.0, [](std::size_t, std::size_t) { return 0.0; }, 70 + e);
    for (std::size_t w = 0; w < walkers; ++w)
      for (std::size_t i = 0; i < n; ++i) x[(e * walkers + w) * n + i] = std::sqrt(0.5) * common[i] + std::sqrt(0.5) * own[w * n + i];
  }
  // Variance of the mean of everything: that of the common part, 0.5 (1.9 / 0.1) / (4 n), and a little of the others.
  const double known = 1 / (0.5 * 19 / (4 * double(n)) + 0.5 / (4 * double(walkers * n)));
  EXPECT_NEAR(ess_mean({x, 4 * walkers, walkers}) / known, 1, 0.2);
  EXPECT_GT(ess_mean({x, 4 * walkers}) / known, 3);  // control: taken as independent chains
  const auto free = chains_of(4 * walkers, n, 0.5);
  EXPECT_NEAR(ess_mean({free, 4 * walkers, walkers}) / ess_mean({free, 4 * walkers}), 1, 0.15);  // those that are independent lose nothing
}
