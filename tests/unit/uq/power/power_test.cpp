// The power of an experiment, against diagnoses of records that conceal a stronger and a weaker effect than could be named.
#include "uq/power/power.hpp"

#include <gtest/gtest.h>

#include "tests/unit/uq/experiment.hpp"

namespace calomel {
namespace {

const Detectable& of(const PlanPower& p, const std::string& number) {
  const auto at = std::find_if(p.numbers.begin(), p.numbers.end(), [&](const auto& d) { return d.number == number; });
  if (at == p.numbers.end()) throw std::runtime_error("no such number: " + number);
  return *at;
}

TEST(Power, IsThatOfTheDiagnosis) {
  const Experiment nothing(0, 0, 0, 1, 1);
  const PosteriorInputs in = [&] {
    PosteriorInputs base = nothing.base();
    base.run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return Experiment::runs()(thetas, level, {}); };
    return base;
  }();
  const PosteriorFit fit = fit_posterior(in);
  const auto groups = Experiment::groups();
  const ScreeningResult screening = screen_candidates({.fit = fit, .problem = nothing.problem, .groups = groups, .level = 1, .run = Experiment::runs()});
  std::vector<std::size_t> all, few{0};
  for (std::size_t i = 0; i < nothing.problem.observations.size(); ++i) all.push_back(i);
  const auto plans = power(fit, nothing.problem, groups, screening.candidates, {{"one gauge", few}, {"all", all}});
  ASSERT_EQ(plans.size(), 2u);
  const Detectable& echo = of(plans[1], "echo.strength");
  ASSERT_TRUE(echo.from);
  EXPECT_GT(*echo.from, 0.001);
  EXPECT_LT(*echo.from, 0.5);
  // Six gauges contain more information than the first alone.
  EXPECT_GT(plans[1].gain, 0);
  const Detectable& alone = of(plans[0], "echo.strength");
  if (alone.from) {
    EXPECT_GT(*alone.from, *echo.from);
  }

  EXPECT_EQ(Experiment(1.5 * *echo.from, 0, 0, 1, 2).diagnosed().verdict.kind, VerdictKind::named);
  EXPECT_NE(Experiment(0.5 * *echo.from, 0, 0, 1, 2).diagnosed().verdict.kind, VerdictKind::named);
}

}  // namespace
}  // namespace calomel
