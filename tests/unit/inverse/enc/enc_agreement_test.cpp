#include "inverse/enc/enc_agreement.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "inverse/objective/batch_scorer.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/objective/objective_gradient.hpp"
#include "tests/unit/inverse/oscillations.hpp"

using namespace calomel;

namespace {

const std::vector<double> truth{12100, 1630, 2.3e4};

/// Oscillations with a gradient by central differences, as a surrogate has one.
struct SmoothModel : Oscillations {
  using Oscillations::Oscillations;
  [[nodiscard]] bool has_gradient() const override { return true; }
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const override {
    Eigen::VectorXd g(Eigen::Index(theta.size()));
    for (std::size_t k = 0; k < theta.size(); ++k) {
      std::vector<double> up(theta.begin(), theta.end()), down = up;
      const double h = 1e-6 * (shape().parameters[k].max - shape().parameters[k].min);
      up[k] += h, down[k] -= h;
      const auto a = evaluate(up).mean, b = evaluate(down).mean;
      g[Eigen::Index(k)] = 0;
      for (std::size_t i = 0; i < a.size(); ++i) g[Eigen::Index(k)] += weights[i] * (a[i] - b[i]) / (2 * h);
    }
    return g;
  }
};

/// Records of the model at the truth. `spoilt` adds to sensor C a signal that the model cannot produce: half of its own at a quarter of the frequency.
struct Case {
  SmoothModel model;
  Recordings recordings;
  Problem problem;
  explicit Case(bool spoilt = false) : recordings(recorded(model, truth, 8, 8e-6, 4)), problem(make_problem(model.shape(), spoil(recordings, spoilt), {})) {}

  static Recordings& spoil(Recordings& r, bool spoilt) {
    if (spoilt)
      for (std::size_t p = 0; p < r.pulses.size(); ++p)
        for (std::size_t t = 0; t < r.time.size(); ++t) r.values[r.at(0, 2, p, t)] += 6e-4 * std::sin(2 * M_PI * 0.8 * 16 * 1630 * r.time[t]);
    return r;
  }
};

EncOptions small() {
  EncOptions o;
  o.rounds = 6, o.generations = 40, o.population = 30, o.candidates = 3, o.optimizers = {"de", "mfo"};
  o.compare_optimizers = {"cmaes_restarts", "gradient"}, o.compare_objectives = {"rrmse", "paper_spe"};
  return o;
}

EncSummary run(const Case& c, const EncOptions& o) { return run_enc(c.problem, c.model, c.model, o, 1, 2); }

double cost_at(const Case& c, const Objective& objective, const std::vector<double>& values, double width) {
  return objective_gradient(c.problem, objective, values, width).cost;
}

}  // namespace

TEST(ObjectiveGradient, AgreesWithDifferences) {
  const Case c;
  auto values = c.model.evaluate(std::vector<double>{12500, 1650, 2e4}).mean;
  for (const char* name : {"paper_enc", "paper_spe", "rrmse"}) {
    const Objective& objective = objectives().get(name);
    const auto gradient = objective_gradient(c.problem, objective, values, 0.3);
    double largest = 0;
    for (const double w : gradient.weights) largest = std::max(largest, std::abs(w));
    for (const std::size_t i : {7u, 60u, 233u, 300u, 471u, 599u}) {
      const double h = 1e-10, keep = values[i];
      values[i] = keep + h;
      const double up = cost_at(c, objective, values, 0.3);
      values[i] = keep - h;
      const double down = cost_at(c, objective, values, 0.3);
      values[i] = keep;
      EXPECT_NEAR(gradient.weights[i], (up - down) / (2 * h), 1e-4 * largest) << name << ' ' << i;
    }
  }
}

TEST(ObjectiveGradient, OfTheWrongSignWouldNotPass) {  // control: the check above can fail
  const Case c;
  auto values = c.model.evaluate(std::vector<double>{12500, 1650, 2e4}).mean;
  const Objective& objective = objectives().get("paper_enc");
  const auto gradient = objective_gradient(c.problem, objective, values, 0.3);
  std::vector<double> down = values, up = values;
  for (std::size_t i = 0; i < values.size(); ++i) down[i] -= 1e-14 * gradient.weights[i], up[i] += 1e-14 * gradient.weights[i];
  const double here = cost_at(c, objective, values, 0.3);
  EXPECT_LT(cost_at(c, objective, down, 0.3), here);
  EXPECT_GT(cost_at(c, objective, up, 0.3), here);
}

TEST(ObjectiveGradient, SharpensIntoTheObjectiveItself) {
  const Case c;
  const auto values = c.model.evaluate(std::vector<double>{12300, 1640, 2.1e4}).mean;
  for (const char* name : {"paper_enc", "paper_spe", "rrmse"}) {
    const Objective& objective = objectives().get(name);
    const double sharp = objective.cost(objective.value(score(c.problem, values)));
    EXPECT_NEAR(cost_at(c, objective, values, 1e-6), sharp, 1e-6 * std::abs(sharp)) << name;
  }
  const double smoothed = cost_at(c, objectives().get("paper_enc"), values, 0.3), sharp = -objectives().get("paper_enc").value(score(c.problem, values));
  EXPECT_GT(smoothed, sharp + 1);  // a smoothed edge counts less
}

TEST(GradientRound, FindsTheTruthWithFewEvaluations) {
  const Case c;
  const Bounds bounds = bounds_of(c.problem.shape);
  for (const char* name : {"paper_enc", "rrmse"}) {
    const Objective& objective = objectives().get(name);
    double best = std::numeric_limits<double>::infinity();
    EncRound round;
    for (std::uint64_t stream = 0; stream < 6; ++stream) {
      const auto r = gradient_round(c.problem, c.model, objective, BatchCost(c.problem, c.model, objective), bounds, 40, 1, stream);
      EXPECT_LT(r.evaluations, 600u);
      if (objective.cost(r.objective) < best) best = objective.cost(r.objective), round = r;
    }
    EXPECT_NEAR(round.theta[0], truth[0], 0.02 * truth[0]) << name;
    EXPECT_NEAR(round.theta[1], truth[1], 0.005 * truth[1]) << name;
    const Eigen::MatrixXd point = Eigen::Map<const Eigen::VectorXd>(round.theta.data(), 3);
    EXPECT_NEAR(objective.cost(round.objective), objective.costs(c.problem, c.model.means(point, 1))[0], 1e-9);
  }
}

TEST(GradientRound, StaysWithinTheBounds) {
  Case c;
  Bounds bounds = bounds_of(c.problem.shape);
  bounds.low[1] = 1645;  // the truth, 1630, lies outside
  const auto r = gradient_round(c.problem, c.model, objectives().get("rrmse"), BatchCost(c.problem, c.model, objectives().get("rrmse")), bounds, 40, 1, 0);
  EXPECT_GE(r.theta[1], 1645);
  EXPECT_LT(r.theta[1], 1660);
}

TEST(EncAgreement, OptimisersAndObjectivesAgreeWhereTheModelIsTheTruth) {
  const Case c;
  const auto a = run(c, small()).agreement;
  ASSERT_EQ(a.optimizers.size(), 4u);
  std::vector<std::string> names;
  for (const auto& r : a.optimizers) {
    names.push_back(r.name);
    EXPECT_TRUE(r.agrees) << r.name << ' ' << r.distance;
    EXPECT_GE(r.shortfall, 0);
    EXPECT_GT(r.share, 0);
  }
  EXPECT_THAT(names, testing::ElementsAre("de", "mfo", "cmaes_restarts", "gradient"));
  EXPECT_TRUE(a.optimizers_agree);
  EXPECT_TRUE(a.objectives_agree);
  ASSERT_EQ(a.objectives.size(), 3u);
  EXPECT_EQ(a.objectives[1].objective, "rrmse");
  EXPECT_GT(a.evaluations, 0u);
}

TEST(EncAgreement, ObjectivesDisagreeIfTheModelCannotFitOneGauge) {
  const Case c(true);
  const auto a = run(c, small()).agreement;
  EXPECT_FALSE(a.objectives_agree);
  // each answer is the best of all by its own objective, because the surrogate of this model is the model itself
  for (std::size_t i = 0; i < a.objectives.size(); ++i)
    for (std::size_t k = 0; k < a.objectives.size(); ++k) {
      const Objective& by = objectives().get(a.objectives[i].objective);
      EXPECT_LE(by.cost(*a.objectives[i].values[i].second), by.cost(*a.objectives[k].values[i].second) + 1e-3 * std::abs(*a.objectives[i].values[i].second))
          << by.name << " at the answer of " << a.objectives[k].objective;
    }
}

TEST(EncAgreement, AnOptimiserThatIsCutShortDisagrees) {
  const Case c;
  EncOptions o = small();
  o.compare_optimizers = {"es"}, o.generations = 1, o.population = 5;
  const auto a = run(c, o).agreement;
  EXPECT_FALSE(a.optimizers_agree);
  EXPECT_THAT(a.optimizers, testing::Contains(testing::Field(&ComparedOptimizer::shortfall, testing::Gt(0))));
}

TEST(EncAgreement, WithoutAGradientTheGradientSearchIsLeftOut) {
  const Case c;
  const Oscillations rough;
  EncOptions o = small();
  o.compare_objectives = {};
  const auto a = run_enc(c.problem, rough, rough, o, 1, 2).agreement;
  EXPECT_EQ(a.optimizers.size(), 3u);
  EXPECT_TRUE(a.objectives.empty());
  EXPECT_TRUE(agreement_json(a, c.problem, "")["objectives_agree"].is_null());
}

TEST(EncAgreement, IsTheSameOnOneAndTwoThreads) {
  const Case c;
  EncOptions o = small();
  o.generations = 10;
  const auto a = run_enc(c.problem, c.model, c.model, o, 1, 1).agreement, b = run_enc(c.problem, c.model, c.model, o, 1, 2).agreement;
  EXPECT_EQ(agreement_json(a, c.problem, "").dump(), agreement_json(b, c.problem, "").dump());
}
