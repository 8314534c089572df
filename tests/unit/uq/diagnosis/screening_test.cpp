// Screening of candidates: evidence that is divided between places, and numbers that are implausible.
#include "uq/diagnosis/screening.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/uq/experiment.hpp"

namespace calomel {
namespace {

// The evidence of a mechanism that may act on several places is the mean over them.
TEST(Screening, DividesEvidenceBetweenPlaces) {
  const Experiment experiment(0.04, 0, 0, 1, 1);
  const RunAdded smooth = Experiment::runs(0);  // the numerical noise of a run depends on how many numbers are added
  const PosteriorInputs base = [&] {
    PosteriorInputs in = experiment.base();
    in.run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return Experiment::runs()(thetas, level, {}); };
    return in;
  }();
  const PosteriorFit fit = fit_posterior(base);
  const auto best = [&](const std::vector<ParameterGroup>& groups) {
    return screen_candidates({.fit = fit, .problem = experiment.problem, .groups = groups, .level = 1, .run = smooth}).candidates[0];
  };
  const ParameterGroup echo = Experiment::groups()[1], drift = Experiment::groups()[0];
  ParameterGroup alike = echo, useless = drift, third = drift;
  alike.place = "b";
  useless.name = "echo";
  useless.place = "c";
  third.name = "echo";
  third.place = "d";
  const double alone = best({echo}).first_order.log_bayes_factor;
  ASSERT_GT(alone, 5);
  EXPECT_NEAR(best({echo, alike}).first_order.log_bayes_factor, alone, 1e-3);
  const ScreenedCandidate one_of_three = best({useless, echo, third});
  EXPECT_NEAR(one_of_three.first_order.log_bayes_factor, alone - std::log(3), 1e-3);
  EXPECT_NEAR(one_of_three.selection_penalty, -std::log(3), 1e-3);
}

TEST(Implausibility, IsFromTheMiddleOfThePrior) {
  AddedParameter a;
  Parameter& p = a.parameter;
  p.min = -10;
  p.max = 10;
  p.nominal = 0;
  p.prior = "normal";
  p.mean = 1;
  p.sd = 0.15;
  EXPECT_NEAR(implausibility(a, 1.3), 2, 1e-12);  // off, at 0, is what is implausible
  EXPECT_GT(implausibility(a, 0), 6);
  EXPECT_TRUE(std::isinf(implausibility(a, 10.5)));
  EXPECT_FALSE(std::isinf(implausibility(a, 10.5, 1)));  // within its own deviation of the range
  p.min = 1e-3;
  p.prior = "lognormal";
  p.mean.reset();
  p.sd.reset();
  p.mu = std::log(2);
  p.sigma = 0.5;
  EXPECT_NEAR(implausibility(a, 2 * std::exp(-0.75)), 1.5, 1e-12);
}

}  // namespace
}  // namespace calomel
