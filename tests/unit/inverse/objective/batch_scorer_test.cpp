// Compares scores of points by directions and coefficients with scores of the histories that they represent.
#include "inverse/objective/batch_scorer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "forward/emulator/infill.hpp"
#include "forward/emulator/mesh_correction.hpp"
#include "inverse/enc/enc_rounds.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "tests/unit/inverse/oscillations.hpp"

namespace calomel {
namespace {

/// Fixed directions with coefficients that oscillate over the parameters.
struct Directed : Oscillations {
  explicit Directed(std::size_t n_times, Eigen::Index rank = 7) : Oscillations(n_times) {
    RandomStream random(5, 1);
    const auto values = Eigen::Index(shape().values());
    base.offset.resize(values);
    base.directions.resize(values, rank);
    for (auto& x : base.offset) x = float(1e-4 * random.normal());
    for (auto& x : base.directions.reshaped()) x = float(1e-4 * random.normal());
  }
  [[nodiscard]] HistoryBasis basis() const override { return base; }
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override {
    Eigen::MatrixXf c(base.directions.cols(), thetas.cols());
    for (Eigen::Index i = 0; i < c.cols(); ++i)
      for (Eigen::Index k = 0; k < c.rows(); ++k)
        c(k, i) = thetas(1, i) > 1950 ? NAN : float(std::sin(1e-3 * double(k + 1) * thetas(0, i)) + std::cos(2e-4 * thetas(1, i) * double(k)));
    return c;
  }
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int) const override {
    return (base.directions * coefficients(thetas)).colwise() + base.offset;
  }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    const Eigen::MatrixXf y = means(Eigen::Map<const Eigen::VectorXd>(theta.data(), 3), 1);
    return {.ok = y.allFinite(), .mean = {y.data(), y.data() + y.size()}};
  }
  HistoryBasis base;
};

Eigen::MatrixXd points_in(const ModelShape& shape, Eigen::Index n) {
  RandomStream random(8, 3);
  Eigen::MatrixXd thetas(3, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < 3; ++k) thetas(k, i) = random.uniform(shape.parameters[std::size_t(k)].min, shape.parameters[std::size_t(k)].max);
  return thetas;
}

/// Records of a wave with noise at every time step or between the steps, with dropouts and a gauge that was not recorded.
Recordings gauges(const ModelShape& shape, double step) {
  Recordings r;
  r.conditions = shape.conditions;
  r.sensors = {"C", "A"};
  r.sensor_lines = {0, 0};
  r.pulses = {0, 1, 2, 3};
  for (double t = 0; t <= shape.times.back(); t += step) r.time.push_back(t);
  r.values.resize(r.sensors.size() * r.pulses.size() * r.time.size());
  RandomStream random(2, 0);
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t t = 0; t < r.time.size(); ++t)
        r.values[r.at(0, s, p, t)] = t % 11 == 5 && s == 0 ? NAN : 1e-4 * std::sin(0.1 * double(t) + double(s)) + (t < 9 ? 1e-8 : 8e-5) * random.normal();
  return r;
}

}  // namespace

TEST(BatchScorer, AgreesWithScoresOfTheHistoriesOnEveryInstructionSet) {
  for (const std::size_t times : {64u, 333u})
    for (const double step : {1.0, 0.7}) {  // on the simulation's times, and between them
      const Directed model(times, times == 64 ? 1 : 23);
      const Problem p = make_problem(model.shape(), gauges(model.shape(), step * model.shape().times[1]), {});
      EXPECT_EQ(p.same_grid, step == 1.0);
      EXPECT_GT(p.observations[0].narrow, 0u);
      for (const Eigen::Index n : {1, 5, 12, 31, 40}) {
        Eigen::MatrixXf c = model.coefficients(points_in(model.shape(), n));
        if (n > 5) c(0, 3) = NAN;
        const Eigen::MatrixXf histories = (model.base.directions * c).colwise() + model.base.offset;
        const BatchScore whole = score_batch(p, histories);
        for (const auto isa : instruction_sets()) {
          const BatchScore s = BatchScorer(p, model.base, isa).score(c);
          for (std::size_t i = 0; i < std::size_t(n); ++i) {
            SCOPED_TRACE(testing::Message() << name_of(isa) << ' ' << times << ' ' << step << " column " << i << " of " << n);
            const auto column = histories.col(Eigen::Index(i));
            const Score one = score(p, std::vector<double>(column.begin(), column.end()));
            if (!column.allFinite()) {
              EXPECT_TRUE(std::isnan(s.mae[i]) && std::isnan(s.accuracy[i]) && std::isnan(s.nrmse[i]) && std::isnan(s.delta1[i]) && std::isnan(s.delta2[i]));
              continue;
            }
            EXPECT_NEAR(s.accuracy[i], one.accuracy, 1.0);  // in single precision a sample on the edge may fall on the other side
            EXPECT_NEAR(s.accuracy[i], whole.accuracy[i], 1.0);
            for (const auto* other : {&whole.mae[i], &one.mae}) EXPECT_NEAR(s.mae[i], *other, 2e-5 * *other);
            for (const auto* other : {&whole.delta1[i], &one.delta1}) EXPECT_NEAR(s.delta1[i], *other, 2e-5 * *other);
            for (const auto* other : {&whole.delta2[i], &one.delta2}) EXPECT_NEAR(s.delta2[i], *other, 2e-4 * *other);
            EXPECT_NEAR(s.nrmse[i], one.nrmse, 2e-5 * one.nrmse);
          }
        }
      }
    }
}

TEST(BatchScorer, OfOtherCoefficientsWouldNotPass) {  // control: the check above can fail
  const Directed model(333, 23);
  const Problem p = make_problem(model.shape(), gauges(model.shape(), model.shape().times[1]), {});
  Eigen::MatrixXf c = model.coefficients(points_in(model.shape(), 2));
  const BatchScorer scorer(p, model.base);
  const double before = scorer.score(c).mae[1];
  c(22, 1) *= 1.01f;
  EXPECT_GT(std::abs(scorer.score(c).mae[1] / before - 1), 1e-4);
}

TEST(BatchScorer, AColumnDoesNotKnowOfItsNeighbours) {
  const Directed model(200, 9);
  const Problem p = make_problem(model.shape(), gauges(model.shape(), model.shape().times[1]), {});
  const Eigen::MatrixXf c = model.coefficients(points_in(model.shape(), 40));
  const BatchScorer scorer(p, model.base);
  const BatchScore all = scorer.score(c);
  for (const Eigen::Index first : {0, 7, 24, 39}) {
    const BatchScore some = scorer.score(c.rightCols(40 - first));
    EXPECT_NEAR(some.mae[0], all.mae[std::size_t(first)], 1e-6 * some.mae[0]);
    EXPECT_EQ(some.accuracy[0], all.accuracy[std::size_t(first)]);
  }
}

/// Histories from directions equal those from the models, through every wrapper that a calibration puts about a surrogate.
TEST(BatchCost, IsThatOfTheHistoriesOfCorrectedModels) {
  const Directed model(120);
  const auto& parameters = model.shape().parameters;
  const Problem p = make_problem(model.shape(), gauges(model.shape(), model.shape().times[1]), {});
  Eigen::MatrixXd thetas = points_in(model.shape(), 33);
  thetas.row(1) = thetas.row(1).cwiseMin(1900);
  const auto values = Eigen::Index(model.shape().values());
  RandomStream random(4, 4);
  Eigen::MatrixXd trained(values, 30);
  for (auto& x : trained.reshaped()) x = 1e-5 * random.normal();
  EmulatorRuns two_meshes{first_design(3, 30, 5), std::vector<int>(30, 1), 2};
  std::fill(two_meshes.level.begin() + 20, two_meshes.level.end(), 0);
  std::vector<double> low, high;
  for (const auto& q : parameters) low.push_back(q.min), high.push_back(q.max);
  const EmulatorBox box(parameters, low, high);
  const MeshCorrection mesh(box, MultilevelRegression(two_meshes, 1e5 * trained, Eigen::VectorXd::Ones(values)), trained, 1, {}, {}), no_mesh;
  std::vector<bool> failures(33, false);
  failures[20] = failures[21] = true;
  const Feasibility feasibility(parameters, thetas, failures);
  const CorrectedModel shifted(model, mesh), unshifted(model, no_mesh);
  const GuardedModel guarded(shifted, feasibility);
  thetas(1, 9) = 1990;  // where the model itself fails
  for (const ForwardModel* m : {static_cast<const ForwardModel*>(&model), static_cast<const ForwardModel*>(&shifted),
                                static_cast<const ForwardModel*>(&unshifted), static_cast<const ForwardModel*>(&guarded)}) {
    const HistoryBasis basis = m->basis();
    const Eigen::MatrixXf expected = m->means(thetas, 1), y = (basis.directions * m->coefficients(thetas)).colwise() + basis.offset;
    EXPECT_EQ(basis.directions.cols(), 7 + (m == &shifted || m == &guarded ? MultilevelRegression::coefficients(3, 2) : 0));
    for (Eigen::Index i = 0; i < y.cols(); ++i) {
      EXPECT_EQ(y.col(i).allFinite(), expected.col(i).allFinite()) << i;
      if (y.col(i).allFinite()) {
        EXPECT_LT((y.col(i) - expected.col(i)).norm(), 3e-6 * expected.col(i).norm()) << i;
      }
    }
    EXPECT_TRUE(expected.col(9).hasNaN());
    EXPECT_EQ(expected.col(20).hasNaN(), m == &guarded);
    for (const char* name : {"paper_enc", "paper_spe", "rrmse"}) {
      const Objective& objective = objectives().get(name);
      const auto by_histories = objective.costs(p, expected), cost = BatchCost(p, *m, objective)(thetas);
      for (std::size_t i = 0; i < cost.size(); ++i)
        if (std::isfinite(by_histories[i])) {
          EXPECT_NEAR(cost[i], by_histories[i], name == std::string("paper_enc") ? 1.0 : 1e-4 * by_histories[i]) << name << i;
        } else {
          EXPECT_EQ(cost[i], by_histories[i]);
        }
    }
  }
}

TEST(BatchCost, IsTakenOfHistoriesWhereAModelHasNoDirections) {
  const Oscillations model(100);
  const Problem p = make_problem(model.shape(), recorded(model, {12100, 1630, 2.3e4}, 4, 8e-6, 4), {});
  const Eigen::MatrixXd thetas = points_in(model.shape(), 5);
  const Objective& objective = objectives().get("rrmse");
  EXPECT_TRUE(model.basis().empty());
  EXPECT_EQ(BatchCost(p, model, objective)(thetas), objective.costs(p, model.means(thetas, 1)));
}

TEST(Rounds, AreTheSameOnAnyNumberOfThreadsWithDirections) {
  const Directed model(120);
  const Problem p = make_problem(model.shape(), gauges(model.shape(), model.shape().times[1]), {});
  const RoundPlan plan{.optimizers = {"de", "es", "gwo", "mfo"}, .rounds = 8, .generations = 10, .population = 13, .pool = 5};
  const auto one = search_rounds(p, model, objectives().get("paper_enc"), plan, 3, 1),
             three = search_rounds(p, model, objectives().get("paper_enc"), plan, 3, 3);
  for (std::size_t r = 0; r < 8; ++r) {
    EXPECT_EQ(one.rounds[r].theta, three.rounds[r].theta);
    EXPECT_EQ(one.rounds[r].trace, three.rounds[r].trace);
  }
}

}  // namespace calomel
