// Pairs of runs on two meshes in ENC and SPE: the decorator, the choice of points, and whether a biased mesh is seen through.
#include "inverse/mesh_pairs.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "inverse/enc.hpp"
#include "inverse/spe.hpp"
#include "meshed.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {

const std::vector<double> truth{12100, 1630, 2.3e4};

/// y_i = i a + i^2 b, with its gradient.
class Line final : public ForwardModel {
 public:
  Line() {
    shape_.parameters = {{.name = "a", .min = 1, .max = 4, .nominal = 2.0}, {.name = "b", .min = -1, .max = 1, .nominal = 0.0}};
    shape_.conditions = {"default"}, shape_.sensors = {"S"}, shape_.times = {0, 1, 2, 3};
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    if (theta[0] > 3.9) return {.ok = false, .message = "the step collapsed"};
    Prediction p;
    for (const double t : shape_.times) p.mean.push_back(t * theta[0] + t * t * theta[1]);
    return p;
  }
  [[nodiscard]] bool has_gradient() const override { return true; }
  [[nodiscard]] Eigen::VectorXd pull_back(std::span<const double>, std::span<const double> w) const override {
    Eigen::Vector2d g = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < 4; ++i) g += w[i] * shape_.times[i] * Eigen::Vector2d(1, shape_.times[i]);
    return g;
  }

 private:
  ModelShape shape_;
};

/// Differences 0.1 (1 + a - b) t at a few points.
MeshError error_of_line(const Line& line) {
  Eigen::MatrixXd theta(2, 7), d(4, 7);
  theta << 1, 2, 3, 4, 1.5, 2.5, 3.5, -1, 1, -0.5, 0.5, 0, 0.9, -0.8;
  for (Eigen::Index i = 0; i < 7; ++i)
    for (Eigen::Index k = 0; k < 4; ++k) d(k, i) = 0.1 * (1 + theta(0, i) - theta(1, i)) * line.shape().times[std::size_t(k)];
  return {line.shape().parameters, theta, d, {.mean = 1}};
}

/// Records of the exact model; campaign and search on elements of 1.
struct Case {
  Meshed working{1}, finer{0.5}, exact{0};
  Recordings recordings = recorded(exact, truth, 8, 4e-6, 4);
  Problem problem = make_problem(working.shape(), recordings, {});
  Archive archive = archive_of(working, "chebyshev", 120, 1);
};

double off(const std::vector<double>& theta, std::size_t k) { return std::abs(theta[k] / truth[k] - 1); }

EncOptions enc_options(int pairs) {
  EncOptions o;
  o.rounds = 8, o.generations = 40, o.population = 30, o.candidates = 5, o.separation = 0.01, o.mesh_pairs = pairs, o.mesh_beyond = 1;  // the records know no mesh
  o.compare_optimizers = {}, o.compare_objectives = {};
  return o;
}

SpeOptions spe_options(int pairs) {
  SpeOptions o;
  o.objective = "rrmse", o.total_degree = {5, 8}, o.tensor_product = {4}, o.lambdas = {0.5, 1, 2};
  o.trials = 12, o.iterations = 40, o.candidates = 5, o.mesh_pairs = pairs, o.mesh_beyond = 1, o.zoom = 3, o.zoom_runs = 40;
  return o;
}

TEST(ShiftedModel, AddsTheShiftToOneAndToManyAndToTheSlope) {
  const Line line;
  const MeshError mesh = error_of_line(line), none;
  const ShiftedModel shifted(line, mesh), plain(line, none);
  const std::vector<double> at{2.2, 0.3};
  const Eigen::VectorXd shift = mesh.shift(at);
  const auto p = shifted.evaluate(at).mean, own = line.evaluate(at).mean;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(p[i], own[i] + shift[Eigen::Index(i)]);
  EXPECT_NEAR(shift[3], 2 * 0.1 * (1 + 2.2 - 0.3) * 3, 0.1);
  EXPECT_EQ(plain.evaluate(at).mean, own);
  Eigen::MatrixXd thetas(2, 2);
  thetas << 2.2, 3.95, 0.3, 0;
  const Eigen::MatrixXf y = shifted.means(thetas, 1);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(y(i, 0), p[std::size_t(i)], 1e-5);
  EXPECT_TRUE(std::isnan(y(2, 1)));  // where the model fails
  EXPECT_FALSE(shifted.evaluate(std::vector{3.95, 0.0}).ok);
  // The slope by central differences; without that of the shift it is another one.
  const std::vector<double> weights{0.3, -1, 2, 0.5};
  const Eigen::VectorXd g = shifted.pull_back(at, weights);
  for (std::size_t k = 0; k < 2; ++k) {
    auto up = at, down = at;
    up[k] += 1e-3, down[k] -= 1e-3;
    double slope = 0;
    for (std::size_t i = 0; i < 4; ++i) slope += weights[i] * (shifted.evaluate(up).mean[i] - shifted.evaluate(down).mean[i]) / 2e-3;
    EXPECT_NEAR(g[Eigen::Index(k)], slope, 1e-4 * std::abs(slope));
    EXPECT_GT(std::abs(line.pull_back(at, weights)[Eigen::Index(k)] - slope), 0.01 * std::abs(slope));
  }
}

TEST(RememberingModel, RunsNoPointTwice) {
  const Meshed model(1);
  const RememberingModel memory(model);
  const std::vector<double> a{12000, 1500, 1e4}, b{12500, 1500, 1e4}, c{13000, 1500, 1e4};
  (void)memory.evaluate(a), (void)memory.evaluate(a);
  EXPECT_EQ(model.runs, 1);
  memory.learn(b, {.mean = {1, 2}}, true), memory.learn(c, {.mean = {3}}, false);
  EXPECT_EQ(memory.evaluate(b).mean, (std::vector<double>{1, 2}));
  EXPECT_EQ(memory.evaluate(c).mean, (std::vector<double>{3}));
  EXPECT_EQ(model.runs, 1);
  EXPECT_EQ(memory.runs(), 2u);  // c was nobody's run
}

TEST(MeshPairs, FirstPointsAreTheGivenOnesAndGoodRunsFarApart) {
  const Case c;
  const Bounds bounds = bounds_of(c.problem.shape);
  const auto cost = [&](std::span<const double>, std::span<const double> values) { return score(c.problem, values).nrmse; };
  const auto ranked = ranked_runs(c.archive, cost);
  ASSERT_EQ(ranked.size(), 120u);
  EXPECT_TRUE(std::is_sorted(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; }));
  const auto nominal_point = nominal(c.problem.shape);
  const auto points = first_pair_points({nominal_point, nominal_point}, ranked, 4, bounds);
  ASSERT_EQ(points.size(), 4u);
  EXPECT_EQ(points[0], nominal_point);
  double nearest = 1, of_best = 1;
  for (std::size_t i = 1; i < 4; ++i) {
    const auto at = std::find_if(ranked.begin(), ranked.end(), [&](const auto& r) { return r.theta == points[i]; });
    EXPECT_LT(at - ranked.begin(), 10);  // none but good ones
    for (std::size_t j = 0; j < i; ++j) {
      nearest = std::min(nearest, distance({0, points[i]}, {0, points[j]}, bounds));
      of_best = std::min(of_best, distance(ranked[i - 1], j == 0 ? Proposal{0, nominal_point} : ranked[j - 1], bounds));
    }
  }
  EXPECT_GT(nearest, of_best);  // further apart than the best ones are
  EXPECT_EQ(first_pair_points({nominal_point}, ranked, 4, bounds), points);
}

TEST(MeshPairs, WithoutAFinerMeshThereAreNone) {
  const Case c;
  const RememberingModel memory(c.working);
  const RunSource alone = without_journal(c.working, nullptr, 1), nothing;
  EXPECT_EQ(MeshPairs(c.problem.shape, alone, memory, 6, 1).left(), 0);
  EXPECT_EQ(MeshPairs(c.problem.shape, nothing, memory, 6, 1).left(), 0);
  const auto s = run_enc(c.problem, c.working, c.working, enc_options(6), 1, 2);
  EXPECT_FALSE(s.mesh.used());
  EXPECT_EQ(enc_json(s, c.problem, {}).count("mesh"), 0u);
}

TEST(MeshPairs, EachPairIsLeftOutInTurn) {
  const Case c;
  const RememberingModel memory(c.working);
  const RunSource source = without_journal(c.working, &c.finer, 1);
  MeshPairs pairs(c.problem.shape, source, memory, 4, 0.5);
  const std::vector<std::vector<double>> points{{12000, 1500, 1e4}, {12500, 1600, 2e4}, {13000, 1400, 3e4}, {12200, 1700, 2e4}};
  (void)pairs.add({points[0], points[1]}, 2);
  EXPECT_TRUE(pairs.left_out().empty());
  (void)pairs.add({points[2], points[3]}, 2);
  EXPECT_EQ(pairs.places(), points);
  const auto left_out = pairs.left_out();
  ASSERT_EQ(left_out.size(), 4u);
  const auto vector = [](const std::vector<double>& v) { return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size()))); };
  EXPECT_EQ(left_out[1].theta, points[1]);
  const Eigen::VectorXd working = vector(c.working.evaluate(points[1]).mean), finer = vector(c.finer.evaluate(points[1]).mean);
  EXPECT_LT((left_out[1].records - (1.5 * finer - 0.5 * working)).norm(), 1e-5 * finer.norm());
  EXPECT_EQ(left_out[1].mesh.pairs(), 3);
  // What the others tell is not what it tells itself.
  EXPECT_LT((pairs.mesh().shift(points[1]) - 1.5 * (finer - working)).norm(), 0.3 * (left_out[1].mesh.shift(points[1]) - 1.5 * (finer - working)).norm());
}

TEST(EncMeshPairs, ABiasedMeshIsSeenThrough) {
  const Case c;
  const RunSource source = without_journal(c.working, &c.finer, 2);
  const EncRuns runs{source, c.archive};
  const auto with = run_enc(c.problem, c.working, c.working, enc_options(8), 1, 2, {}, nullptr, &runs);
  const auto without = run_enc(c.problem, c.working, c.working, enc_options(0), 1, 2, {}, nullptr, &runs);
  // The mesh's own optimum is density / 0.92, sound speed / 0.98: the negative control misses by what the mesh does.
  EXPECT_NEAR(without.theta[0] / truth[0], 1 / 0.92, 0.02);
  EXPECT_NEAR(without.theta[1] / truth[1], 1 / 0.98, 0.005);
  EXPECT_LT(off(with.theta, 0), 0.02);
  EXPECT_LT(off(with.theta, 1), 0.005);
  EXPECT_LT(off(with.theta, 2), 0.06);
  EXPECT_FALSE(without.mesh.used());
  EXPECT_TRUE(with.mesh.used());
  EXPECT_LE(with.mesh.pairs, 8);
  EXPECT_GT(with.mesh.difference, 0.02);
  EXPECT_GT(off(with.mesh.without, 1), 0.015);
  EXPECT_THAT(with.mesh.sentence, HasSubstr("pairs of runs"));
  // The corrected prediction is what was judged, here and at the nominal point; the other stands beside it.
  const auto own = c.working.evaluate(with.theta).mean, exact = c.exact.evaluate(with.theta).mean;
  double to_own = 0, to_exact = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_NEAR(with.mesh.calibrated[i], own[i], 1e-9);
    to_own += std::pow(with.calibrated[i] - own[i], 2), to_exact += std::pow(with.calibrated[i] - exact[i], 2);
  }
  EXPECT_LT(to_exact, 0.1 * to_own);
  EXPECT_GT(with.best.score.accuracy, with.mesh.best.accuracy + 5);
  const auto nominal_exact = c.exact.evaluate(with.nominal).mean;
  EXPECT_LT(score(c.problem, nominal_exact).mae * 0.8, with.at_nominal.score.mae);
  EXPECT_NE(with.at_nominal.score.mae, with.mesh.at_nominal.mae);
}

TEST(EncMeshPairs, ArtefactsHoldBothHistories) {
  const Case c;
  const RunSource source = without_journal(c.working, &c.finer, 2);
  const EncRuns runs{source, c.archive};
  const auto s = run_enc(c.problem, c.working, c.working, enc_options(4), 1, 2, {}, nullptr, &runs);
  const auto directory = scratch("mesh_pairs");
  write_enc(s, c.problem, {.stage = "enc"}, directory);
  const NetcdfReader file(directory / "enc.nc");
  EXPECT_EQ(file.doubles("calibrated"), s.calibrated);
  EXPECT_EQ(file.doubles("calibrated_working_mesh"), s.mesh.calibrated);
  EXPECT_EQ(file.doubles("nominal_working_mesh"), s.mesh.nominal_values);
  const Json j = read_json(directory / "enc.json");
  EXPECT_EQ(j.at("mesh").at("pairs"), s.mesh.pairs);
  EXPECT_NEAR(j.at("mesh").at("working_mesh").at("accuracy").get<double>(), s.mesh.best.accuracy, 1e-9);
  EXPECT_NEAR(j.at("mesh").at("relative_difference").get<double>(), s.mesh.difference, 1e-12);
  EXPECT_TRUE(j.at("mesh").at("theta_without_shift").contains("density"));
}

TEST(SpeMeshPairs, ABiasedMeshIsSeenThrough) {
  const Case c;
  const RunSource source = without_journal(c.working, &c.finer, 2);
  const auto with = run_spe(c.problem, c.archive, c.working, spe_options(8), 1, 2, {}, &source);
  const auto without = run_spe(c.problem, c.archive, c.working, spe_options(0), 1, 2, {}, &source);
  EXPECT_GT(off(without.theta, 1), 0.014);
  EXPECT_LT(off(with.theta, 1), 0.006);
  EXPECT_GT(off(without.theta, 0), 0.05);
  EXPECT_LT(off(with.theta, 0), 0.035);
  EXPECT_EQ(with.mesh.pairs, 8);
  EXPECT_LT(*with.best.objective_model, 0.5 * with.mesh.best.nrmse);
  EXPECT_EQ(spe_json(with, c.problem, {}).at("mesh").at("pairs"), 8);
}

TEST(SpeMeshPairs, AreSharedByTheRoundsAfterTheFirstAndStandAboutTheOptimum) {
  const Case c;
  std::vector<std::vector<double>> places;
  const RunSource plain = without_journal(c.working, &c.finer, 2);
  const RunSource source{.run =
                             [&](const Eigen::MatrixXd& t, const std::vector<bool>& fine) {
                               for (Eigen::Index i = 0; i < t.cols(); ++i)
                                 if (fine[std::size_t(i)]) places.emplace_back(t.col(i).begin(), t.col(i).end());
                               return plain.run(t, fine);
                             },
                         .has_finer = true};
  auto o = spe_options(5);
  const auto s = run_spe(c.problem, c.archive, c.working, o, 1, 2, {}, &source);
  ASSERT_EQ(places.size(), 5u);
  ASSERT_GE(s.mesh.rounds.size(), 4u);
  const int pairs_by_then[] = {0, 0, 2, 5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(s.mesh.rounds[i].pairs, pairs_by_then[i]) << i;
  const Bounds bounds = bounds_of(c.problem.shape);
  double of_pairs = 0, of_campaign = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    of_pairs += distance({0, places[i]}, {0, s.theta}, bounds) / 5;
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(places[i], places[j]);
  }
  for (Eigen::Index i = 0; i < 120; ++i) of_campaign += distance({0, {c.archive.theta.col(i).begin(), c.archive.theta.col(i).end()}}, {0, s.theta}, bounds) / 120;
  EXPECT_LT(of_pairs, 0.7 * of_campaign);
  // Where no box shrinks, they come with the nominal point.
  places.clear(), o.zoom = 0;
  (void)run_spe(c.problem, c.archive, c.working, o, 1, 2, {}, &source);
  ASSERT_EQ(places.size(), 5u);
  EXPECT_EQ(places[0], nominal(c.problem.shape));
}

TEST(SpeMeshPairs, AnInterruptedCalibrationGoesOnAndEndsAlike) {
  const Case c;
  auto o = spe_options(4);
  o.zoom = 1, o.refinements = 1;
  const auto whole = [&](const RunSource& source) { return run_spe(c.problem, c.archive, c.working, o, 1, 1, {}, &source); };
  const RunSource plain = without_journal(c.working, &c.finer, 1);
  const auto expected = whole(plain);
  const auto directory = scratch("spe_resume");
  const Provenance provenance{.stage = "added_runs", .seed = 1};
  std::atomic<bool> stop = false;
  std::size_t first = 0;
  {
    AddedRuns added(c.working, &c.finer, provenance, directory);
    (void)added.run(Eigen::Vector3d(13000, 1500, 1e4), {true}, 1);  // another method's: the answer does not depend on it
    const RunSource source{.run =
                               [&](const Eigen::MatrixXd& t, const std::vector<bool>& fine) {
                                 return added.run(t, fine, 1, [&](std::size_t, std::size_t) { stop = added.made() >= 40; }, &stop);
                               },
                           .has_finer = true};
    EXPECT_THROW((void)whole(source), Interrupted);
    first = added.made();
  }
  AddedRuns added(c.working, &c.finer, provenance, directory);
  const RunSource source{.run = [&](const Eigen::MatrixXd& t, const std::vector<bool>& fine) { return added.run(t, fine, 1); }, .has_finer = true};
  const auto resumed = whole(source);
  EXPECT_EQ(resumed.theta, expected.theta);
  EXPECT_EQ(resumed.calibrated, expected.calibrated);
  EXPECT_GE(added.reused(), first - 2);
  // The pair at the best run asks for a run that was there.
  EXPECT_EQ(added.reused() + added.made(), resumed.model_runs + std::size_t(resumed.mesh.pairs) + 1);
}

}  // namespace
