#include "inverse/enc/enc.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "tests/unit/inverse/oscillations.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::Contains;
using testing::HasSubstr;

namespace {

const std::vector<double> truth{12100, 1630, 2.3e4};

struct Case {
  Oscillations model;
  Recordings recordings = recorded(model, truth, 8, 8e-6, 4);
  Problem problem = make_problem(model.shape(), recordings, {});
};

EncOptions small() {
  EncOptions o;
  o.rounds = 8, o.generations = 40, o.population = 30, o.candidates = 5;
  o.compare_optimizers = {}, o.compare_objectives = {};  // see enc_agreement_test.cpp
  return o;
}

}  // namespace

TEST(Enc, RecoversTheTruth) {
  Case c;
  const auto s = run_enc(c.problem, c.model, c.model, small(), 1, 2);
  ASSERT_EQ(s.status, CalibrationStatus::done);
  // The mae of the mean of 8 pulses about the truth is 8e-6 sqrt(2 / (8 pi)) = 2.26 microstrain; peaks are 160 microstrain.
  EXPECT_NEAR(s.theta[0], truth[0], 0.02 * truth[0]);
  EXPECT_NEAR(s.theta[1], truth[1], 0.005 * truth[1]);
  EXPECT_NEAR(s.theta[2], truth[2], 0.08 * truth[2]);
  EXPECT_NEAR(s.best.score.mae, 2.26, 0.25);
  EXPECT_GT(s.best.score.accuracy, 95);
  EXPECT_GT(*s.best.objective_model, *s.at_nominal.objective_model + 20);  // negative control: the nominal point is far off
  EXPECT_EQ(s.best.theta, s.candidates[0].theta);
  EXPECT_EQ(s.model_runs, 6u);
  EXPECT_EQ(s.evaluations, 8u * 41 * 30);
}

TEST(Enc, OneAndTwoThreadsGiveTheSame) {
  Case c;
  auto a = run_enc(c.problem, c.model, c.model, small(), 1, 1), b = run_enc(c.problem, c.model, c.model, small(), 1, 2);
  for (auto* s : {&a, &b}) s->search_s = s->model_s = s->agreement_s = 0;
  EXPECT_EQ(enc_json(a, c.problem, {}, {}).dump(), enc_json(b, c.problem, {}, {}).dump());
  EXPECT_EQ(a.calibrated, b.calibrated);
  const auto other = run_enc(c.problem, c.model, c.model, small(), 2, 1);
  EXPECT_NE(a.theta, other.theta);
}

TEST(Enc, CandidatesAreDistinctAndOrderedByTheTrueModel) {
  Case c;
  Oscillations surrogate;
  surrogate.error = 1.03;  // a surrogate that is 3 % off
  const auto s = run_enc(c.problem, surrogate, c.model, small(), 1, 2);
  ASSERT_EQ(s.candidates.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(s.candidates[i].objective_model.has_value());
    EXPECT_NEAR(*s.candidates[i].objective_model, objectives().get("paper_enc").value(score(c.problem, c.model.evaluate(s.candidates[i].theta).mean)), 1e-12);
    EXPECT_NE(*s.candidates[i].objective_model, s.candidates[i].objective_surrogate);
    EXPECT_GE(*s.candidates[i == 0 ? 0 : i - 1].objective_model, *s.candidates[i].objective_model);
    for (std::size_t k = 0; k < i; ++k) {
      double apart = 0;
      for (std::size_t j = 0; j < 3; ++j) {
        const auto& p = c.model.shape().parameters[j];
        apart = std::max(apart, std::abs(s.candidates[i].theta[j] - s.candidates[k].theta[j]) / (p.max - p.min));
      }
      EXPECT_GE(apart, small().separation);
    }
  }
}

TEST(Enc, EveryOptimizerIsDrawnAndSummedUp) {
  Case c;
  EncOptions o = small();
  o.rounds = 40, o.generations = 3;
  const auto s = run_enc(c.problem, c.model, c.model, o, 1, 2);
  int rounds = 0;
  for (const auto& e : s.optimizers) {
    rounds += e.rounds;
    EXPECT_GE(e.rounds, 2) << e.name;  // in 40 draws from four fewer than 2 has probability 1e-4
    double sum = 0, best = -1e300;
    for (const auto& r : s.rounds)
      if (r.optimizer == e.name) sum += r.objective, best = std::max(best, r.objective);
    EXPECT_NEAR(e.mean, sum / e.rounds, 1e-9);
    EXPECT_EQ(e.best, best);
    EXPECT_GT(e.sd, 0);
    EXPECT_EQ(e.trace.size(), 4u);
    EXPECT_EQ(e.trace.back(), best);
  }
  EXPECT_EQ(rounds, 40);
}

TEST(Enc, OtherObjectivesAndOptimizersServe) {
  Case c;
  EncOptions o = small();
  o.objective = "rrmse", o.optimizers = {"cmaes"}, o.rounds = 2;
  const auto s = run_enc(c.problem, c.model, c.model, o, 1, 2);
  EXPECT_NEAR(s.theta[1], truth[1], 0.005 * truth[1]);
  EXPECT_NEAR(*s.best.objective_model, s.best.score.nrmse, 1e-12);
  EXPECT_LT(*s.best.objective_model, *s.at_nominal.objective_model);
  o.objective = "paper_spe", o.optimizers = {"de"};
  EXPECT_NEAR(run_enc(c.problem, c.model, c.model, o, 1, 2).theta[1], truth[1], 0.01 * truth[1]);
  o.optimizers = {"dee"};
  EXPECT_THROW((void)run_enc(c.problem, c.model, c.model, o, 1, 2), InputError);
}

TEST(Enc, AFailedCandidateIsReplacedByAnother) {
  Case c;
  Oscillations fragile;
  fragile.fails = [](std::span<const double> theta) { return std::abs(theta[0] - truth[0]) < 150; };  // just where the optimum is
  const auto s = run_enc(c.problem, c.model, fragile, small(), 1, 2);
  EXPECT_EQ(s.status, CalibrationStatus::done);
  EXPECT_FALSE(s.failed.empty());
  EXPECT_EQ(s.candidates.size(), 5u);
  for (const auto& k : s.candidates) EXPECT_TRUE(k.objective_model.has_value());
  EXPECT_EQ(s.failed[0].message, "the step collapsed");
  EXPECT_EQ(s.wanted, 5u);
}

TEST(Enc, ReportsThatEveryRunFailed) {
  Case c;
  Oscillations broken;
  broken.fails = [](std::span<const double>) { return true; };
  const auto dir = scratch("broken");
  auto s = run_enc(c.problem, c.model, broken, small(), 1, 2);
  EXPECT_EQ(s.status, CalibrationStatus::no_candidate);
  EXPECT_FALSE(s.trusted());
  write_enc(s, c.problem, {}, {.stage = "enc"}, dir);
  EXPECT_TRUE(read_json(dir / "enc.json")["candidates"][0]["objective_model"].is_null());
  s = run_enc(c.problem, broken, c.model, small(), 1, 2);  // the surrogate fails everywhere
  EXPECT_EQ(s.status, CalibrationStatus::no_candidate);
  EXPECT_EQ(s.theta, nominal(c.model.shape()));
  EXPECT_TRUE(s.candidates.empty());
  EXPECT_FALSE(s.nominal_kept());
  write_enc(s, c.problem, {}, {.stage = "enc"}, dir);
}

TEST(Enc, TheNominalIsKeptWhenNoCandidateIsBetter) {
  Oscillations model, misled;
  misled.error = 1.4;
  const auto r = recorded(model, nominal(model.shape()), 6, 3e-6, 9);
  const auto problem = make_problem(model.shape(), r, {});
  const auto s = run_enc(problem, misled, model, small(), 1, 2);
  EXPECT_EQ(s.theta, nominal(model.shape()));
  EXPECT_TRUE(s.nominal_kept());
}

TEST(Enc, AnOptimumBeyondTheBoundsIsFoundOnTheBound) {
  Oscillations model;
  const auto r = recorded(model, {10000, 1500, 2e4}, 6, 3e-6, 9);  // a density below the bounds
  const auto s = run_enc(make_problem(model.shape(), r, {}), model, model, small(), 1, 2);
  EXPECT_NEAR(s.theta[0], model.shape().parameters[0].min, 1e-3 * (model.shape().parameters[0].max - model.shape().parameters[0].min));
}

TEST(Enc, ArtefactsHoldTheContract) {
  Case c;
  const auto dir = scratch("enc");
  std::atomic<int> calls{0};
  const auto s = run_enc(c.problem, c.model, c.model, small(), 1, 2, [&](const std::string&, std::size_t done, std::size_t total) {
    EXPECT_LE(done, total);
    ++calls;
  });
  EXPECT_EQ(calls, 8 + 6);
  write_enc(s, c.problem, {.calibration = {.meaning = "tuned", .mesh = ""}, .agreement = "they agree"}, {.stage = "enc", .seed = 1}, dir);
  const Json j = read_json(dir / "enc.json");
  for (const char* key : {"theta", "nominal", "objective", "product", "candidates", "sensors", "accuracy", "mae", "nominal_accuracy", "nominal_mae", "rounds",
                          "optimizers", "warnings", "provenance"})
    EXPECT_TRUE(j.contains(key)) << key;
  EXPECT_EQ(j["product"], "tuned");
  EXPECT_EQ(j["meaning"], "tuned");
  EXPECT_EQ(j["agreement"]["sentence"], "they agree");
  EXPECT_EQ(j["objective"]["name"], "paper_enc");
  EXPECT_EQ(j["objective"]["sense"], "maximise");
  EXPECT_NEAR(j["objective"]["value"].get<double>(), j["accuracy"].get<double>() - j["mae"].get<double>(), 1e-9);
  EXPECT_NEAR(j["impedance"]["value"].get<double>(), s.theta[0] * s.theta[1], 1);
  EXPECT_EQ(j["theta"].size(), 3u);
  ASSERT_EQ(j["sensors"].size(), 3u);
  for (const auto& x : j["sensors"])
    for (const char* key : {"accuracy", "mae", "nominal_accuracy", "nominal_mae"}) EXPECT_TRUE(x[key].is_number()) << key;
  for (const auto& x : j["candidates"]) EXPECT_TRUE(x["objective_model"].is_number());

  const NetcdfReader file(dir / "enc.nc");
  EXPECT_EQ(file.dimensions("calibrated"), (std::vector<std::string>{"condition", "sensor", "time"}));
  EXPECT_EQ(file.dimensions("band_low"), (std::vector<std::string>{"condition", "sensor", "record_time"}));
  EXPECT_EQ(file.doubles("calibrated"), c.model.evaluate(s.theta).mean);
  EXPECT_EQ(file.doubles("nominal"), c.model.evaluate(s.nominal).mean);
  EXPECT_EQ(file.doubles("record_time"), c.problem.time);
  const auto low = file.doubles("band_low"), mean = file.doubles("record_mean"), high = file.doubles("band_high");
  for (std::size_t i = 0; i < low.size(); ++i) EXPECT_TRUE(low[i] < mean[i] && mean[i] < high[i]);
}

TEST(Enc, OptionsAreReadAndHeldToTheCatalogues) {
  CaseFile file = CaseFile::from_text("[enc]\nrounds = 7\noptimizers = ['de', 'cmaes']\nobjective = 'rrmse'\n");
  EncOptions o;
  file.read("enc", o);
  EXPECT_EQ(o.rounds, 7);
  EXPECT_EQ(o.optimizers, (std::vector<std::string>{"de", "cmaes"}));
  for (const char* text : {"[enc]\noptimizers = ['gow']\n", "[enc]\nobjective = 'rmse'\n", "[enc]\npopulation = 3\n", "[enc]\noptimizers = []\n"}) {
    CaseFile bad = CaseFile::from_text(text);
    EncOptions ignored;
    try {
      bad.read("enc", ignored);
      ADD_FAILURE() << text;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("case.toml:2"));
    }
  }
}
