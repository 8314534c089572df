#include "forward/surrogate/training.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "tests/scratch.hpp"
#include "wave_family.hpp"

using namespace calomel;

namespace {

SurrogateOptions quick() {
  SurrogateOptions options;
  options.kind = "mode_gaussian_process";
  options.compare = {"network", "mode_network"};
  options.layers = {16};
  options.epochs = 5;
  options.mode_network.members = 2;
  return options;
}

}  // namespace

TEST(RunSplit, HoldsOutAFifthOfTheUsableRuns) {
  Archive archive = damped_oscillations(60, 2, 20, 3);
  archive.status[4] = RunStatus::failed;
  archive.mean.col(4).setConstant(std::numeric_limits<float>::quiet_NaN());
  archive.mean(3, 9) = std::numeric_limits<float>::quiet_NaN();
  const RunSplit split = split_runs(archive, 0.2, 1);
  EXPECT_EQ(split.test.size(), 12u);  // ceil(0.2 * 58)
  EXPECT_EQ(split.train.size(), 46u);
  EXPECT_EQ(split.excluded, 2u);
  std::set<std::size_t> all(split.train.begin(), split.train.end());
  all.insert(split.test.begin(), split.test.end());
  EXPECT_EQ(all.size(), 58u);
  EXPECT_FALSE(all.contains(4) || all.contains(9));
  EXPECT_NE(split.test, split_runs(archive, 0.2, 2).test);
}

// 603 runs give the published 482 and 121.
TEST(RunSplit, GivesThePublishedNumbers) {
  Archive archive = damped_oscillations(603, 1, 2, 3);
  const RunSplit split = split_runs(archive, 0.2, 1);
  EXPECT_EQ(split.train.size(), 482u);
  EXPECT_EQ(split.test.size(), 121u);
}

TEST(RunSplit, TooFewRunsNameTheKey) {
  const Archive archive = damped_oscillations(5, 2, 20, 3);
  try {
    (void)split_runs(archive, 0.2, 1);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().key, "campaign.runs");
    EXPECT_EQ(e.parts().value, "5");
  }
}

// y = (1, 3 | 2, 6) with predictions (1, 4 | 2, 4) has the errors 0, 1, 0, -2; the squares about the run means are 1 + 1 + 4 + 4 = 10.
TEST(FitMetrics, AgreeWithHandWork) {
  Eigen::MatrixXf actual(2, 2), predicted(2, 2);
  actual << 1, 3, 2, 6;
  predicted << 1, 4, 2, 4;
  const FitMetrics fit = fit_metrics(predicted, actual);
  EXPECT_DOUBLE_EQ(fit.mae, 0.75);
  EXPECT_DOUBLE_EQ(fit.rmse, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(fit.r2, 0.5);
  EXPECT_TRUE(std::isnan(fit_metrics(predicted.col(0), actual.col(0)).r2));
}

TEST(SurrogateOptions, UnknownKindsNameTheKey) {
  const auto key_of = [](const SurrogateOptions& options) {
    try {
      options.validate();
    } catch (const InputError& e) {
      return e.parts().key;
    }
    return std::string();
  };
  SurrogateOptions options;
  EXPECT_EQ(key_of(options), "");
  options.kind = "netwrok";
  EXPECT_EQ(key_of(options), "kind");
  options = {};
  options.compare = {"forest"};
  EXPECT_EQ(key_of(options), "compare");
  options.compare = {"network", "network"};
  EXPECT_EQ(key_of(options), "compare");
}

TEST(SurrogateOptions, AreReadFromACaseWithTheirPlaceInErrors) {
  auto file = CaseFile::from_text("[surrogate]\nkind = \"network\"\nepochs = 7\n[surrogate.modes]\nenergy = 0.9\n");
  SurrogateOptions options;
  file.read("surrogate", options);
  EXPECT_EQ(options.kind, "network");
  EXPECT_EQ(options.epochs, 7);
  EXPECT_EQ(options.modes.energy, 0.9);
  auto wrong = CaseFile::from_text("[surrogate]\nkind = \"netwrok\"\n");
  try {
    wrong.read("surrogate", options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().line, 2);
    EXPECT_NE(std::string(e.what()).find("surrogate.kind"), std::string::npos);
  }
}

TEST(TrainStage, ReportsEveryKindAndWritesTheContractedSummary) {
  const Archive archive = damped_oscillations(40, 3, 30, 3);
  const Training training = run_training(archive, quick(), 1, 2);
  ASSERT_EQ(training.surrogates.size(), 3u);
  EXPECT_EQ(training.surrogates[0]->kind(), "mode_gaussian_process");
  const auto path = scratch_file("train_test.json");
  write_train_json(path, training.summary, {.stage = "train", .options = {{"surrogate", echo(quick())}}});
  const Json json = read_json(path);
  ASSERT_EQ(json.at("surrogates").size(), 3u);
  for (const auto& s : json.at("surrogates")) {
    for (const char* key : {"name", "kind", "n_train", "n_test", "mae", "rmse", "r2", "train_seconds", "sensors"}) EXPECT_TRUE(s.contains(key)) << key;
    EXPECT_EQ(s.at("n_train"), 32);
    EXPECT_EQ(s.at("n_test"), 8);
    EXPECT_EQ(s.at("sensors").size(), 3u);
    EXPECT_EQ(s.at("run_error").size(), 8u);
  }
  EXPECT_EQ(json.at("surrogates")[1].at("train_loss").size(), 5u);
  EXPECT_TRUE(json.at("provenance").contains("identity"));
  // The pooled squares of the sensors add up to those of the whole.
  double squares = 0;
  for (const auto& s : training.summary.surrogates[0].sensors) squares += s.fit.rmse * s.fit.rmse / 3;
  EXPECT_NEAR(std::sqrt(squares), training.summary.surrogates[0].test.rmse, 1e-9);
}

TEST(TrainStage, RefusesHistoriesThatDoNotVary) {
  Archive archive = damped_oscillations(20, 1, 10, 3);
  archive.mean.setZero();
  EXPECT_THROW((void)run_training(archive, quick(), 1, 1), InputError);
}
