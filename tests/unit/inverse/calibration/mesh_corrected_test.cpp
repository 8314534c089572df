// ENC and SPE with the mesh correction: whether they remove the bias of the mesh, and what the artefacts report.
#include <gmock/gmock.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/case_file.hpp"
#include "base/errors.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"
#include "forward/simulation/simulated_model.hpp"
#include "forward/emulator/infill.hpp"
#include "forward/emulator/mesh_correction.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/calibration/remembering_model.hpp"
#include "inverse/spe/spe.hpp"
#include "tests/unit/inverse/meshed.hpp"
#include "tests/model_simulator.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

namespace {

const std::vector<double> truth{12100, 1630, 2.3e4};

/// The records are those of the exact model. Campaign and search use elements of size 1; the finest mesh of the emulator is exact.
struct Case {
  Meshed working{1}, exact{0};
  Recordings recordings = recorded(exact, truth, 8, 4e-6, 4);
  Problem problem = make_problem(working.shape(), recordings, {});
  Archive archive = archive_of(working, "chebyshev", 120, 1);

  /// The correction is trained on 60 runs of the working mesh and 30 of the exact one in this box about a point.
  [[nodiscard]] MeshCorrection correction(const std::vector<double>& middle = truth) const {
    const std::vector<double> half{900, 40, 9000};
    std::vector<double> low, high;
    for (std::size_t k = 0; k < 3; ++k) low.push_back(middle[k] - half[k]), high.push_back(middle[k] + half[k]);
    const EmulatorBox box(working.shape().parameters, low, high);
    const Eigen::MatrixXd u = first_design(3, 60, 5);
    EmulatorRuns runs{Eigen::MatrixXd(3, 90), {}, 2};
    Eigen::MatrixXd histories(Eigen::Index(working.shape().values()), 90);
    for (int i = 0; i < 90; ++i) {
      const int level = i < 60 ? 1 : 0;
      runs.u.col(i) = u.col(i % 60), runs.level.push_back(level);
      const auto y = (level ? working : exact).evaluate(box.theta(u.col(i % 60))).mean;
      histories.col(i) = Eigen::Map<const Eigen::VectorXd>(y.data(), histories.rows());
    }
    return {box, MultilevelRegression(runs, 1e4 * histories, Eigen::VectorXd::Ones(histories.rows())), histories, 1, {}, {}};
  }
};

double off(const std::vector<double>& theta, std::size_t k) { return std::abs(theta[k] / truth[k] - 1); }

EncOptions enc_options() {
  EncOptions o;
  o.rounds = 8, o.generations = 40, o.population = 30, o.candidates = 5, o.separation = 0.01;
  o.compare_optimizers = {}, o.compare_objectives = {};
  return o;
}

SpeOptions spe_options() {
  SpeOptions o;
  o.objective = "rrmse", o.total_degree = {5, 8}, o.tensor_product = {4}, o.lambdas = {0.5, 1, 2};
  o.trials = 12, o.iterations = 40, o.candidates = 5, o.zoom = 3, o.zoom_runs = 40;
  return o;
}

}  // namespace

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
  EXPECT_EQ(memory.runs(), 2u);  // no run was made at c
}

TEST(EncCorrected, ABiasedMeshIsSeenThrough) {
  const Case c;
  const MeshCorrection correction = c.correction();
  const auto with = run_enc(c.problem, c.working, c.working, enc_options(), 1, 2, {}, &correction);
  const auto without = run_enc(c.problem, c.working, c.working, enc_options(), 1, 2);
  // The optimum of the mesh is density / 0.92, sound speed / 0.98. The negative control misses the truth by this error of the mesh.
  EXPECT_NEAR(without.theta[0] / truth[0], 1 / 0.92, 0.02);
  EXPECT_NEAR(without.theta[1] / truth[1], 1 / 0.98, 0.005);
  EXPECT_FALSE(without.mesh.used);
  EXPECT_LT(off(with.theta, 0), 0.02);
  EXPECT_LT(off(with.theta, 1), 0.005);
  EXPECT_LT(off(with.theta, 2), 0.06);
  EXPECT_TRUE(with.mesh.used);
  EXPECT_GT(with.mesh.difference, 0.02);
  EXPECT_GT(off(with.mesh.without, 1), 0.015);
  EXPECT_TRUE(with.best.inside_emulator);
  EXPECT_EQ(with.model_runs, without.model_runs);  // the correction costs no run
  // The corrected prediction is scored, here and at the nominal point; the artefact lists the uncorrected one as well.
  const auto own = c.working.evaluate(with.theta).mean, exact = c.exact.evaluate(with.theta).mean;
  double to_own = 0, to_exact = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_NEAR(with.mesh.calibrated[i], own[i], 1e-9);
    to_own += std::pow(with.calibrated[i] - own[i], 2), to_exact += std::pow(with.calibrated[i] - exact[i], 2);
  }
  EXPECT_LT(to_exact, 0.02 * to_own);
  EXPECT_GT(with.best.score.accuracy, with.mesh.best.accuracy + 5);
  EXPECT_NE(with.at_nominal.score.mae, with.mesh.at_nominal.mae);
}

TEST(EncCorrected, ArtefactsHoldBothHistories) {
  const Case c;
  const MeshCorrection correction = c.correction();
  const auto s = run_enc(c.problem, c.working, c.working, enc_options(), 1, 2, {}, &correction);
  const auto directory = scratch("mesh_corrected");
  write_enc(s, c.problem, {.calibration = {.meaning = "", .mesh = "corrected"}, .agreement = ""}, {.stage = "enc"}, directory);
  const NetcdfReader file(directory / "enc.nc");
  EXPECT_EQ(file.doubles("calibrated"), s.calibrated);
  EXPECT_EQ(file.doubles("calibrated_working_mesh"), s.mesh.calibrated);
  EXPECT_EQ(file.doubles("nominal_working_mesh"), s.mesh.nominal_values);
  const Json j = read_json(directory / "enc.json");
  EXPECT_EQ(j.at("scores_on"), "the finest mesh of the emulator");
  EXPECT_NEAR(j.at("mesh").at("working_mesh").at("accuracy").get<double>(), s.mesh.best.accuracy, 1e-9);
  EXPECT_NEAR(j.at("mesh").at("relative_difference").get<double>(), s.mesh.difference, 1e-12);
  EXPECT_TRUE(j.at("mesh").at("theta_without_correction").contains("density"));
  EXPECT_EQ(s.mesh.runs, 90);
  EXPECT_EQ(j.at("mesh").at("sentence"), "corrected");
  EXPECT_TRUE(j.at("candidates")[0].at("inside_emulator").get<bool>());
  EXPECT_FALSE(j.at("mesh").at("nominal_inside_emulator").get<bool>());  // 13500, 1450: far from the box about the truth
  for (const char* gone : {"covariance", "sd", "log_sd", "combinations", "spread"}) EXPECT_FALSE(j.contains(gone)) << gone;
  const Json bare = enc_json(run_enc(c.problem, c.working, c.working, enc_options(), 1, 2), c.problem, {}, {});
  EXPECT_FALSE(bare.contains("mesh"));
  EXPECT_FALSE(bare.at("candidates")[0].contains("inside_emulator"));
  EXPECT_EQ(bare.at("scores_on"), "the case's own mesh");
}

TEST(EncCorrected, AnAnswerOutsideTheEmulatorsBoxIsMarked) {
  const Case c;
  const MeshCorrection elsewhere = c.correction({14500, 1300, 1.5e4});
  const auto s = run_enc(c.problem, c.working, c.working, enc_options(), 1, 2, {}, &elsewhere);
  EXPECT_FALSE(s.best.inside_emulator);
  EXPECT_FALSE(enc_json(s, c.problem, {}, {}).at("candidates")[0].at("inside_emulator").get<bool>());
  const MeshCorrection here = c.correction();
  EXPECT_TRUE(run_enc(c.problem, c.working, c.working, enc_options(), 1, 2, {}, &here).best.inside_emulator);
}

TEST(SpeCorrected, ABiasedMeshIsSeenThrough) {
  const Case c;
  const MeshCorrection correction = c.correction();
  const auto with = run_spe(c.problem, c.archive, c.working, spe_options(), 1, 2, {}, &correction);
  const auto without = run_spe(c.problem, c.archive, c.working, spe_options(), 1, 2);
  EXPECT_GT(off(without.theta, 0), 0.05);
  EXPECT_GT(off(without.theta, 1), 0.014);
  EXPECT_LT(off(with.theta, 0), 0.02);
  EXPECT_LT(off(with.theta, 1), 0.005);
  EXPECT_LT(*with.best.objective_model, 0.5 * with.mesh.best.nrmse);
  EXPECT_GT(off(with.mesh.without, 1), 0.01);
  EXPECT_FALSE(without.mesh.used);
  EXPECT_TRUE(spe_json(with, c.problem, {}, {}).at("mesh").contains("working_mesh"));
}

TEST(SpeCorrected, AnInterruptedCalibrationGoesOnAndEndsAlike) {
  const Case c;
  const MeshCorrection correction = c.correction();
  auto o = spe_options();
  o.zoom = 1, o.refinements = 1;
  const auto whole = [&](const ForwardModel& model) { return run_spe(c.problem, c.archive, model, o, 1, 1, {}, &correction); };
  const auto folder = scratch("spe_resume"), path = folder / "runs.journal";
  const Provenance provenance{.stage = "runs", .seed = 1};
  const ModelSimulator simulator(c.working);
  const ThreadExecutor one(1);
  RunStore uninterrupted(provenance, folder / "whole.journal");
  Runs all(simulator, uninterrupted, one);
  const auto expected = whole(SimulatedModel(all));
  std::size_t first = 0;
  {
    std::atomic<bool> stop = false;
    RunStore store(provenance, path);
    Runs runs(simulator, store, one, &stop);
    const SimulatedModel stopping(runs, true, [&](std::size_t, std::size_t) { stop = runs.made() >= 20; });
    EXPECT_THROW((void)whole(stopping), Interrupted);
    first = runs.made();
  }
  RunStore store(provenance, path);
  Runs runs(simulator, store, one);
  const auto resumed = whole(SimulatedModel(runs));
  EXPECT_EQ(resumed.theta, expected.theta);
  EXPECT_EQ(resumed.calibrated, expected.calibrated);
  EXPECT_GE(first, 20u);
  EXPECT_EQ(store.size(), resumed.model_runs);  // the candidates and the nominal point, too
}

/// The message about `line` in [enc] or [spe]; empty when it is accepted.
std::string refusal(const std::string& table, const std::string& line) {
  CaseFile file = CaseFile::from_text("[" + table + "]\n" + line + "\n");
  EncOptions enc;
  SpeOptions spe;
  try {
    table == "enc" ? file.read(table, enc) : file.read(table, spe);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(OptionsThatBecameConstants, AreRefusedWithTheirValues) {
  EXPECT_THAT(refusal("enc", "compare_rounds = 2"), HasSubstr("four rounds"));
  EXPECT_THAT(refusal("enc", "agreement = 0.1"), HasSubstr("5 % of the bounds"));
  EXPECT_THAT(refusal("spe", "folds = 4"), HasSubstr("five folds"));
  EXPECT_THAT(refusal("spe", "merge = 0.1"), HasSubstr("2 % of the bounds"));
  EXPECT_EQ(refusal("enc", "rounds = 4"), "");
}

TEST(MeshCorrectionOption, ReplacedKeysAreRefusedWithItsName) {
  for (const std::string table : {"enc", "spe"})
    for (const std::string key : {"mesh_pairs = 0", "mesh_beyond = 1", "draws = 8"}) {
      const std::string said = refusal(table, key);
      EXPECT_THAT(said, HasSubstr("case.toml:2"));
      EXPECT_THAT(said, HasSubstr(key.starts_with("draws") ? "calomel sample" : "mesh_correction"));
    }
}
