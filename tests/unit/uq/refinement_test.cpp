// Refinement of the emulator where the true model does not agree with it: a model that is steep just where the answer is, and one that is not.
#include "uq/refinement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/unit/uq/experiment.hpp"

namespace calomel {
namespace {

const std::vector<double> truth{1.02, 0.985};

/// Runs whose speed rises steeply within `width` of the true one, where the amplitude is within 0.02 of the true one: a small part of the box, which a
/// polynomial of order two over the box cannot follow. At the true values it is the plain model. Runs are made once.
struct Steep {
  double slope, width;
  int made = 0;
  std::map<std::vector<double>, RunRecord> store{};

  RunRecord one(const Eigen::VectorXd& theta, int level) {
    std::vector<double> key(theta.begin(), theta.end());
    key.push_back(level);
    if (const auto held = store.find(key); held != store.end()) return held->second;
    ++made;
    Eigen::VectorXd seen = theta;
    seen[1] += slope * width * std::tanh((theta[1] - truth[1]) / width) * std::exp(-0.5 * std::pow((theta[0] - truth[0]) / 0.02, 2));
    return store[key] = Experiment::run(seen, level, {}, 3e-7);
  }
  [[nodiscard]] PosteriorInputs inputs(const Experiment& experiment) {
    PosteriorInputs in = experiment.base();
    in.discrepancy = false;
    in.emulator.rounds = 2;
    in.emulator.round_coarse = in.emulator.round_fine = 2;
    in.emulator.check_coarse = in.emulator.check_fine = 8;
    in.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) all.push_back(one(thetas.col(Eigen::Index(i)), level[i]));
      return all;
    };
    return in;
  }
};

/// How far the true model lies from the emulator at the posterior's draws, over itself.
double distance(const TrueModelCheck& check) {
  double sum = 0;
  for (const auto& r : check.runs) sum += r.distance / double(check.runs.size());
  return sum;
}

}  // namespace

TEST(CheckAndRefine, DoesNotChangeAValidEmulator) {
  const Experiment experiment(0, 0, 0, 1, 1);
  Steep plain{0, 1};
  const PosteriorInputs in = plain.inputs(experiment);
  const PosteriorFit first = fit_posterior(in);
  const int made = plain.made;
  int calls = 0;
  const RefinedFit refined = check_and_refine(in, first, 3, [&](const TrueModelCheck&) { ++calls; });
  EXPECT_TRUE(refined.check.holds) << refined.check.p_value;
  EXPECT_TRUE(refined.refinements.empty());
  EXPECT_EQ(refined.ended, RefinementEnd::holds);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(plain.made - made, 16);  // those of the check, which are needed in any case
  EXPECT_EQ(refined.fit.modes[0].at.theta, first.modes[0].at.theta);
}

TEST(CheckAndRefine, TrainsTheEmulatorAgainUntilItAgreesWithTheTrueModel) {
  const Experiment experiment(0, 0, 0, 1, 1);
  Steep steep{8, 0.01};
  const PosteriorInputs in = steep.inputs(experiment);
  const PosteriorFit first = fit_posterior(in);
  const RefinedFit refined = check_and_refine(in, first, 3);
  ASSERT_GE(refined.refinements.size(), 1u);
  EXPECT_FALSE(refined.refinements[0].check.holds);
  EXPECT_LT(refined.refinements[0].check.p_value, 1e-3);
  EXPECT_TRUE(refined.refinements[0].shrank_box);
  EXPECT_GE(refined.refinements[0].runs, 16 + 4);
  EXPECT_TRUE(refined.check.holds) << refined.check.p_value;
  EXPECT_EQ(refined.ended, RefinementEnd::holds);
  EXPECT_LT(distance(refined.check), 0.75 * distance(refined.refinements[0].check));  // of eight seeds four refine, to 0.4 to 0.6 of it
  EXPECT_GT(refined.fit.rounds.size(), first.rounds.size());
  // No check stands where the emulator was trained: all its points are new.
  for (const auto& checked : refined.check.runs)
    for (const auto& trained : refined.fit.runs) EXPECT_FALSE(checked.theta == trained.theta && checked.level == trained.level);
}

TEST(CheckAndRefine, EndsWithItsBudgetAndReportsIt) {
  const Experiment experiment(0, 0, 0, 1, 1);
  Steep steep{8, 0.003};
  const PosteriorInputs in = steep.inputs(experiment);
  const PosteriorFit first = fit_posterior(in);
  const RefinedFit none = check_and_refine(in, first, 0), one = check_and_refine(in, first, 1), enough = check_and_refine(in, first, 5);
  EXPECT_FALSE(none.check.holds);
  EXPECT_TRUE(none.refinements.empty());
  EXPECT_EQ(none.ended, RefinementEnd::none_allowed);
  EXPECT_FALSE(one.check.holds);
  EXPECT_EQ(one.refinements.size(), 1u);
  EXPECT_EQ(one.ended, RefinementEnd::limit);
  EXPECT_TRUE(enough.check.holds);
  EXPECT_GE(enough.refinements.size(), 2u);
}

// What a killed call has made stands in the store: the next one makes the rest and ends with the same emulator.
TEST(CheckAndRefine, EndsWithTheSameFitFromRunsThatAreThere) {
  const Experiment experiment(0, 0, 0, 1, 1);
  Steep steep{8, 0.01};
  const PosteriorInputs in = steep.inputs(experiment);
  const RefinedFit whole = check_and_refine(in, fit_posterior(in), 3);
  const int made = steep.made;
  Steep again{8, 0.01};
  for (const auto& [key, run] : steep.store)
    if (again.store.size() < steep.store.size() / 2) again.store[key] = run;
  const PosteriorInputs in_again = again.inputs(experiment);
  const RefinedFit resumed = check_and_refine(in_again, fit_posterior(in_again), 3);
  EXPECT_EQ(again.made, made - int(steep.store.size() / 2));
  EXPECT_EQ(resumed.fit.modes[0].at.theta, whole.fit.modes[0].at.theta);
  EXPECT_EQ(resumed.check.p_value, whole.check.p_value);
  const int all = again.made;
  const RefinedFit third = check_and_refine(in_again, fit_posterior(in_again), 3);
  EXPECT_EQ(again.made, all);
  EXPECT_EQ(third.check.p_value, whole.check.p_value);
}

TEST(CheckAndRefine, DoesNotRefineWhereNothingCouldBeChecked) {
  const Experiment experiment(0, 0, 0, 1, 1);
  Steep plain{0, 1};
  PosteriorInputs in = plain.inputs(experiment);
  const PosteriorFit first = fit_posterior(in);
  in.run = [](const Eigen::MatrixXd&, const std::vector<int>& level) { return std::vector<RunRecord>(level.size(), {.message = "the step collapsed"}); };
  const RefinedFit refined = check_and_refine(in, first, 3);
  EXPECT_FALSE(refined.check.holds);
  EXPECT_TRUE(refined.refinements.empty());
  EXPECT_EQ(refined.ended, RefinementEnd::unchecked);
}

}  // namespace calomel
