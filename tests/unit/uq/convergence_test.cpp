#include <gmock/gmock.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "base/random.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/convergence/diagnostics.hpp"

using namespace calomel;
using testing::HasSubstr;
using testing::Not;

namespace {

std::vector<double> flat(const Json& chains) {
  std::vector<double> x;
  for (const auto& c : chains)
    for (const auto& v : c) x.push_back(v.get<double>());
  return x;
}

/// chains x n draws of a first-order autoregression about `at(chain)`.
template <class At>
std::vector<double> chains_of(std::size_t chains, std::size_t n, double coefficient, At&& at, std::uint64_t seed = 7) {
  std::vector<double> x;
  for (std::size_t c = 0; c < chains; ++c) {
    RandomStream random(seed, c);
    double v = random.normal();
    for (std::size_t i = 0; i < n; ++i) {
      v = coefficient * v + std::sqrt(1 - coefficient * coefficient) * random.normal();
      x.push_back(at(c, i) + v);
    }
  }
  return x;
}
std::vector<double> chains_of(std::size_t chains, std::size_t n, double coefficient = 0) {
  return chains_of(chains, n, coefficient, [](std::size_t, std::size_t) { return 0.0; });
}

Draws draws_of(std::vector<std::string> names, std::size_t chains, const std::vector<std::vector<double>>& columns) {
  Draws d{.names = std::move(names), .chains = chains, .draws = columns[0].size() / chains};
  for (std::size_t i = 0; i < columns[0].size(); ++i)
    for (const auto& c : columns) d.values.push_back(c[i]);
  return d;
}

}  // namespace

// Chains and numbers of convergence_reference.py, the same formulas written a second time (its Beta quantiles by integration, its sums without a Fourier
// transform).
TEST(Convergence, NumbersAreThoseOfASecondProgram) {
  const Json reference = read_json(std::filesystem::path(CALOMEL_SOURCE_DIR) / "tests/unit/uq/convergence_reference.json");
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

TEST(Convergence, AlternatingChainsAreWorthMoreThanTheirDraws) {
  const auto x = chains_of(4, 1000, -0.3);
  EXPECT_GT(ess_mean({x, 4}), 4000);
  const auto y = chains_of(4, 1000, -0.95);
  EXPECT_NEAR(ess_mean({y, 4}), 4000 * std::log10(4000.0), 1e-6);  // no more than that
}

TEST(Convergence, ChainsThatStandStillOrAreNotFiniteHaveNoAnswer) {
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

TEST(Assess, EnergiesThatChangeTooSlowlyAndDivergencesAreTold) {
  const auto good = draws_of({"rho", "c"}, 4, {chains_of(4, 1000), chains_of(4, 1000, 0.2)});
  const auto slow = assess(good, {.e_bfmi = {0.9, 0.21, 0.8, 1.0}, .transitions = 4000});
  EXPECT_FALSE(slow.converged);
  EXPECT_THAT(slow.message, HasSubstr("chain 2 (E-BFMI 0.21)"));
  EXPECT_THAT(slow.message, HasSubstr("c is the parameter"));
  const auto told = assess(good, {.e_bfmi = {0.9, 0.7, 0.8, 1.0}, .divergences = 3, .transitions = 4000});
  EXPECT_TRUE(told.converged);
  EXPECT_THAT(told.message, HasSubstr("3 of 4000 trajectories diverged"));
  const Json j = convergence_json(told);
  EXPECT_EQ(j["divergences"], 3);
  EXPECT_EQ(j["e_bfmi"].size(), 4u);
  EXPECT_GT(j["parameters"][0]["mcse_q95"], j["parameters"][0]["mcse_q50"]);
  EXPECT_FALSE(convergence_json(assess(good)).contains("e_bfmi"));
}

TEST(Assess, NamesTrajectoriesThatDivergeOrEndTooEarly) {
  const auto poor = draws_of({"tau"}, 4, {chains_of(4, 500, 0.98)});
  EXPECT_THAT(assess(poor, {.divergences = 40, .transitions = 2000}).message, HasSubstr("40 of 2000 trajectories diverged"));
  EXPECT_THAT(assess(poor, {.cut = 1000, .transitions = 2000}).message, HasSubstr("50 % of the trajectories are ended by sampler.nuts.depth"));
  EXPECT_THAT(assess(poor, {.divergences = 1, .cut = 10, .transitions = 2000}).message, Not(HasSubstr("trajectories")));  // too few to be the cause
}

TEST(Assess, NextStepsAreThoseOfTheSampler) {
  const auto poor = draws_of({"rho"}, 4, {chains_of(4, 500, 0.98)});
  EXPECT_THAT(assess(poor, {.acceptance = 0.3, .kind = "smc"}).message, HasSubstr("halve sampler.smc.correlation"));
  EXPECT_THAT(assess(poor, {.acceptance = 0.1, .kind = "delayed_acceptance"}).message, HasSubstr("refuses 90 % of what the emulator proposes"));
  EXPECT_THAT(assess(poor, {.acceptance = 0.5, .kind = "delayed_acceptance"}).message, Not(HasSubstr("refuses")));
}

TEST(Assess, IndependentDrawsHaveConverged) {
  const auto c = assess(draws_of({"rho", "c"}, 4, {chains_of(4, 1000), chains_of(4, 1000, 0.2)}));
  EXPECT_TRUE(c.converged) << c.message;
  EXPECT_THAT(c.message, HasSubstr("converged"));
  const Json j = convergence_json(c);
  EXPECT_EQ(j["parameters"].size(), 2u);
  for (const char* key : {"name", "mean", "sd", "q05", "q50", "q95", "r_hat", "ess_bulk", "ess_tail", "mcse_mean"})
    EXPECT_TRUE(j["parameters"][0].contains(key)) << key;
  EXPECT_TRUE(j["converged"].get<bool>());
}

TEST(Assess, NamesChainsInDifferentModes) {
  const auto x = chains_of(4, 1000, 0.3, [](std::size_t c, std::size_t) { return c % 2 ? 30.0 : 10.0; });
  const auto c = assess(draws_of({"c", "rho"}, 4, {chains_of(4, 1000), x}));
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.parameter, "rho");
  EXPECT_THAT(c.message, HasSubstr("chains 1 and 3"));
  EXPECT_THAT(c.message, HasSubstr("chains 2 and 4"));
  EXPECT_THAT(c.message, HasSubstr("modes"));
  EXPECT_THAT(c.message, HasSubstr("narrow the bounds"));
  // Of many walkers only a few are listed.
  const auto many = assess(draws_of({"rho"}, 40, {chains_of(40, 100, 0.3, [](std::size_t k, std::size_t) { return k % 2 ? 30.0 : 10.0; })}));
  EXPECT_THAT(many.message, HasSubstr("chains 1, 3, 5 and 17 more"));
}

TEST(Assess, NamesADriftForWhatItIs) {
  const auto x = chains_of(4, 900, 0.3, [](std::size_t, std::size_t i) { return double(i) / 100; });
  const auto c = assess(draws_of({"rho"}, 4, {x}));
  EXPECT_FALSE(c.converged);
  EXPECT_THAT(c.message, HasSubstr("drifts"));
  EXPECT_THAT(c.message, HasSubstr("sampler.warmup"));
}

TEST(Assess, NamesTheRidgeAndItsPartner) {
  auto rho = chains_of(4, 1000, 0.99);
  const auto noise = chains_of(
      4, 1000, 0, [](std::size_t, std::size_t) { return 0.0; }, 99);
  std::vector<double> c;
  for (std::size_t i = 0; i < rho.size(); ++i) c.push_back(1450 - 10 * rho[i] + 0.5 * noise[i]);
  const auto verdict = assess(draws_of({"sigma_c", "rho", "c"}, 4, {chains_of(4, 1000), rho, c}), {.acceptance = 0.3});
  EXPECT_FALSE(verdict.converged);
  EXPECT_THAT(verdict.message, HasSubstr("ridge"));
  EXPECT_THAT(verdict.message, HasSubstr("rho"));
  EXPECT_THAT(verdict.message, HasSubstr("correlation -0.99"));
  EXPECT_THAT(verdict.message, Not(HasSubstr("sigma_c")));
}

TEST(Assess, NamesProposalsThatAreRefused) {
  const auto c = assess(draws_of({"rho"}, 4, {chains_of(4, 500, 0.98)}), {.acceptance = 0.01});
  EXPECT_THAT(c.message, HasSubstr("1.0 % of the transitions"));
}

TEST(Assess, TooFewDrawsComesWithTheNumberThatIsEnough) {
  const auto c = assess(draws_of({"rho"}, 4, {chains_of(4, 1000, 0.9)}), {.acceptance = 0.3});
  EXPECT_FALSE(c.converged);
  EXPECT_THAT(c.message, HasSubstr("set sampler.draws = "));
  const auto longer = assess(draws_of({"rho"}, 4, {chains_of(4, 4000, 0.9)}), {.acceptance = 0.3});  // as it said, about
  EXPECT_TRUE(longer.converged) << longer.message;
}

// Many short chains, each with few independent draws: their effective sizes are plenty together while R-hat is not there yet.
TEST(Assess, ShortChainsAreToldHowLongTheyShouldBe) {
  const auto c = assess(draws_of({"rho"}, 80, {chains_of(80, 100, 0.6)}));
  EXPECT_FALSE(c.converged);
  EXPECT_GT(c.parameters[0].ess_bulk, 400);
  EXPECT_THAT(c.message, HasSubstr("set sampler.draws = "));
  const double draws = std::stod(c.message.substr(c.message.find("sampler.draws = ") + 16));
  EXPECT_GT(draws, 100);
  const auto longer = assess(draws_of({"rho"}, 80, {chains_of(80, std::size_t(draws), 0.6)}));
  EXPECT_TRUE(longer.converged) << longer.message;
}

TEST(Assess, ChainsThatDoNotMoveAndNumbersThatAreNoneAreNotConverged) {
  const std::vector<double> same(4000, 3.0);
  EXPECT_THAT(assess(draws_of({"rho"}, 4, {same})).message, HasSubstr("has not moved: all draws are 3"));
  auto one = chains_of(4, 1000);
  for (std::size_t i = 2000; i < 3000; ++i) one[i] = 0.1;
  const auto stuck = assess(draws_of({"rho"}, 4, {one}));
  EXPECT_FALSE(stuck.converged);
  EXPECT_THAT(stuck.message, HasSubstr("chain 3"));
  // One walker of many hides from R-hat.
  auto many = chains_of(80, 1000);
  for (std::size_t i = 0; i < 1000; ++i) many[5000 + i] = 0.68;
  const auto hidden = assess(draws_of({"c", "rho"}, 80, {chains_of(80, 1000), many}));
  EXPECT_LT(hidden.parameters[1].r_hat, 1.01);
  EXPECT_FALSE(hidden.converged);
  EXPECT_EQ(hidden.parameter, "rho");
  EXPECT_THAT(hidden.message, HasSubstr("rho has not moved in chain 6"));
  auto x = chains_of(4, 1000);
  x[3] = calomel::nan;
  const auto c = assess(draws_of({"c", "rho"}, 4, {chains_of(4, 1000), x}));
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.parameter, "rho");
  EXPECT_THAT(c.message, HasSubstr("not finite"));
  EXPECT_TRUE(convergence_json(c)["parameters"][1]["r_hat"].is_null());
}

TEST(Assess, LongTailsSeldomVisitedAreTold) {
  // A bulk that mixes and a tail that is entered once in a while and stays.
  auto x = chains_of(4, 2000);
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 0; i < 60; ++i) x[c * 2000 + k * 1000 + 300 + i] = 5 + 0.01 * double(i % 7);
  const auto verdict = assess(draws_of({"tau"}, 4, {x}), {.acceptance = 0.3});
  EXPECT_FALSE(verdict.converged);
  EXPECT_THAT(verdict.message, HasSubstr("tau")) << verdict.message;
}
