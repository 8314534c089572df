#include "forward/campaign/campaign.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <optional>
#include <thread>

#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "base/random.hpp"
#include "forward/campaign/archive.hpp"
#include "tests/model_simulator.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {

/// A decaying sine of two parameters; it fails in a corner of the box in each of the three ways that a model can.
class Ringing : public ForwardModel {
 public:
  explicit Ringing(std::size_t conditions = 1, std::chrono::microseconds delay = {}) : delay_(delay) {
    shape_.parameters = {{.name = "pitch", .key = "a.pitch", .min = 1, .max = 3, .nominal = 2.0},
                         {.name = "decay", .key = "a.decay", .min = 0, .max = 1, .nominal = 0.5}};
    shape_.conditions = conditions == 1 ? std::vector<std::string>{"default"} : std::vector<std::string>{"low", "high"};
    shape_.sensors = {"A", "B", "C"};
    for (int i = 0; i < 7; ++i) shape_.times.push_back(0.1 * i);
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    const int call = ++calls;
    std::this_thread::sleep_for(delay_);
    if (stop_at > 0 && call >= stop_at) stop = true;  // whichever thread comes first
    Prediction p;
    if (theta[0] > 2.9) return {.ok = false, .message = "a collapsed element at step 12"};
    if (theta[0] < 1.01) throw NumericsError("the server does not answer");
    for (std::size_t c = 0; c < shape_.conditions.size(); ++c)
      for (std::size_t s = 0; s < shape_.sensors.size(); ++s)
        for (const double t : shape_.times) p.mean.push_back(double(c + 1) * std::sin(theta[0] * t + double(s)) * std::exp(-theta[1] * t));
    if (theta[1] > 0.97) p.mean[8] = std::nan("");
    for (const double m : p.mean) p.energy_slope.push_back(m / 2), p.scatter.push_back(std::abs(m) / 100);
    p.energies = {0.99, 1.01};
    for (const double a : p.energies)
      for (const double m : p.mean) p.pulses.push_back(float(a * m));
    return p;
  }
  mutable std::atomic<int> calls = 0;
  mutable std::atomic<bool> stop = false;
  int stop_at = 0;

 private:
  ModelShape shape_;
  std::chrono::microseconds delay_;
};

CampaignOptions small(int runs = 40) {
  CampaignOptions o;
  o.runs = runs;
  o.pulses = 2;
  return o;
}

Provenance provenance_of(const CampaignOptions& o, std::uint64_t seed = 1) {
  return {.stage = "campaign", .options = {{"campaign", identity_options(o)}, {"load", {{"peak_pressure", 1e7}}}}, .seed = seed};
}

/// The campaign of `o` on the runs of DIR/runs.journal.
CampaignSummary run(const ForwardModel& model, const std::filesystem::path& dir, const CampaignOptions& o, int threads, const Provenance& provenance,
                    const CampaignProgress& progress = {}, const std::atomic<bool>* stop = nullptr) {
  const ModelSimulator simulator(model);
  const ThreadExecutor executor(threads);
  std::optional<RunStore> store;
  std::optional<Runs> runs;
  const auto held = [&]() -> Runs& {
    store.emplace(Provenance{.stage = "runs", .options = {{"load", provenance.options.at("load")}}}, dir / "runs.journal");
    return runs.emplace(simulator, *store, executor, stop);
  };
  return run_campaign(model.shape(), o, provenance.seed, provenance, dir, held, progress);
}

CampaignSummary run(const ForwardModel& model, const std::filesystem::path& dir, const CampaignOptions& o = small(), int threads = 2) {
  return run(model, dir, o, threads, provenance_of(o));
}

/// Every variable of campaign.nc as bytes (NaN included).
std::string arrays(const std::filesystem::path& dir) {
  const NetcdfReader file(dir / "campaign.nc");
  std::string all;
  for (const char* name : {"theta", "strain", "energy_slope", "scatter", "pulse_strain", "pulse_energy", "time", "parameter_min"}) {
    const auto v = file.doubles(name);
    all.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(double));
  }
  for (const int s : file.integers("status")) all += std::to_string(s);
  for (const auto& m : file.strings("message")) all += m + '\n';
  return all;
}

}  // namespace

TEST(Campaign, WritesWhatTheModelGivesAndRecordsEveryFailureWithItsReason) {
  const auto dir = scratch("campaign");
  const Ringing model;
  const auto summary = run(model, dir);
  EXPECT_EQ(summary.runs, 40u);
  EXPECT_EQ(summary.completed + summary.failed, 40u);
  EXPECT_EQ(summary.reused, 0u);
  EXPECT_EQ(model.calls, 40);

  const Archive archive = read_archive(dir / "campaign.nc");
  ASSERT_EQ(archive.runs(), 40u);
  EXPECT_EQ(archive.completed().size(), summary.completed);
  EXPECT_EQ(archive.theta, design_points("chebyshev", model.shape().parameters, 40, 1));
  int collapsed = 0, silent = 0, infinite = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    const Eigen::Index column(i);
    const Eigen::VectorXd theta = archive.theta.col(column);
    if (archive.status[i] == RunStatus::failed) {
      EXPECT_TRUE(archive.mean.col(column).array().isNaN().all());
      collapsed += archive.message[i] == "a collapsed element at step 12";
      silent += archive.message[i].starts_with("the server does not answer (at pitch = 1.0");
      infinite += archive.message[i] == "the value at sensor B, time 0.1 s is not finite";
      continue;
    }
    const Prediction p = model.evaluate({theta.data(), 2});
    for (std::size_t k = 0; k < p.mean.size(); ++k) {
      EXPECT_EQ(archive.mean(Eigen::Index(k), column), float(p.mean[k]));
      EXPECT_EQ(archive.energy_slope(Eigen::Index(k), column), float(p.energy_slope[k]));
      EXPECT_EQ(archive.scatter(Eigen::Index(k), column), float(p.scatter[k]));
    }
  }
  EXPECT_GT(collapsed, 0);
  EXPECT_GT(silent, 0);
  EXPECT_GT(infinite, 0);
  EXPECT_EQ(collapsed + silent + infinite, int(summary.failed));

  EXPECT_EQ(archive.shape.parameters[1].name, "decay");
  EXPECT_EQ(archive.shape.parameters[0].key, "a.pitch");
  EXPECT_EQ(archive.shape.parameters[0].max, 3);
  EXPECT_EQ(archive.shape.parameters[0].nominal, 2.0);
  EXPECT_EQ(archive.shape.times, model.shape().times);
  EXPECT_EQ(archive.shape.sensors, model.shape().sensors);
  EXPECT_EQ(archive.shape.conditions, model.shape().conditions);
  EXPECT_EQ(archive.design, "chebyshev");

  const NetcdfReader file(dir / "campaign.nc");
  EXPECT_EQ(file.dimensions("strain"), (std::vector<std::string>{"run", "sensor", "time"}));
  EXPECT_EQ(file.dimensions("pulse_strain"), (std::vector<std::string>{"run", "pulse", "sensor", "time"}));
  EXPECT_EQ(file.attribute("flag_meanings", "status"), "done failed");
  EXPECT_EQ(file.attribute("measure"), "chebyshev");
  const Json json = read_json(dir / "campaign.json");
  for (const char* key : {"runs", "completed", "failed", "reused", "wall_s"}) EXPECT_TRUE(json.contains(key)) << key;
}

TEST(Campaign, SeveralConditionsMakeADimension) {
  const auto dir = scratch("campaign_conditions");
  const Ringing model(2);
  (void)run(model, dir);
  EXPECT_EQ(NetcdfReader(dir / "campaign.nc").dimensions("strain"), (std::vector<std::string>{"run", "condition", "sensor", "time"}));
  const Archive archive = read_archive(dir / "campaign.nc");
  EXPECT_EQ(archive.shape.conditions, model.shape().conditions);
  const auto i = Eigen::Index(archive.completed()[0]);
  EXPECT_FLOAT_EQ(archive.mean(Eigen::Index(archive.shape.at(1, 2, 3)), i), 2 * archive.mean(Eigen::Index(archive.shape.at(0, 2, 3)), i));
}

TEST(Campaign, OneAndFourThreadsGiveTheSameBytes) {
  const auto one = scratch("campaign_one"), four = scratch("campaign_four");
  (void)run(Ringing(), one, small(), 1);
  (void)run(Ringing(1, std::chrono::microseconds(200)), four, small(), 4);
  EXPECT_EQ(arrays(one), arrays(four));
  EXPECT_EQ(read_text(one / "campaign.nc"), read_text(four / "campaign.nc"));
}

TEST(Campaign, IsNotToBeTrustedAboveTheAllowedShareOfFailures) {
  auto o = small();
  o.allowed_failures = 0.01;
  const auto dir = scratch("campaign_failures");
  const auto strict = run(Ringing(), dir, o);
  EXPECT_EQ(strict.status, ExitStatus::not_to_be_trusted);
  EXPECT_THAT(strict.message, HasSubstr("1 %"));
  o.allowed_failures = 0.9;  // a verdict, not a setting of the runs: the archive is reused
  const auto lenient = run(Ringing(), dir, o);
  EXPECT_EQ(lenient.status, ExitStatus::done);
  EXPECT_EQ(lenient.reused, 40u);
}

TEST(Campaign, AFinishedOneIsReusedWhole) {
  const auto dir = scratch("campaign_reuse");
  const auto first = run(Ringing(), dir);
  const auto before = read_text(dir / "campaign.nc");
  const Ringing model;
  const auto second = run(model, dir);
  EXPECT_EQ(model.calls, 0);
  EXPECT_EQ(second.reused, 40u);
  EXPECT_EQ(second.failed, first.failed);
  EXPECT_EQ(read_json(dir / "campaign.json")["reused"], 40);
  std::filesystem::remove(dir / "campaign.json");  // killed between the archive and its summary
  EXPECT_EQ(run(model, dir).reused, 40u);
  EXPECT_TRUE(std::filesystem::exists(dir / "campaign.json"));
  EXPECT_EQ(read_text(dir / "campaign.nc"), before);
}

TEST(Campaign, OtherSettingsAreRefusedByNameAndNothingIsLost) {
  const auto dir = scratch("campaign_other");
  (void)run(Ringing(), dir);
  const auto before = read_text(dir / "campaign.nc"), json = read_text(dir / "campaign.json");
  auto o = small();
  auto other = provenance_of(o);
  other.options["load"]["peak_pressure"] = 2e7;
  const auto message = [&](const CampaignOptions& options, std::uint64_t seed, const Provenance& p) -> std::string {
    try {
      EXPECT_EQ(p.seed, seed);
      (void)run(Ringing(), dir, options, 1, p);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message(o, 1, other), HasSubstr("changed: load.peak_pressure;"));
  EXPECT_THAT(message(o, 2, provenance_of(o, 2)), HasSubstr("changed: the seed;"));
  o.design = "sobol";
  EXPECT_THAT(message(o, 1, provenance_of(o)), HasSubstr("changed: campaign.design;"));
  EXPECT_EQ(read_text(dir / "campaign.nc"), before);
  EXPECT_EQ(read_text(dir / "campaign.json"), json);

  set_campaign_aside(dir);  // --fresh
  EXPECT_EQ(run(Ringing(), dir, o).reused, 0u);
  EXPECT_EQ(read_text(dir / "campaign.nc.old-1"), before);
}

TEST(Campaign, TheStopFlagEndsItAfterTheRunsInProgressAndASecondCallResumes) {
  const auto whole = scratch("campaign_whole"), dir = scratch("campaign_stopped");
  (void)run(Ringing(), whole);
  Ringing model(1, std::chrono::microseconds(100));
  model.stop_at = 11;
  const auto o = small();
  EXPECT_THROW((void)run(model, dir, o, 2, provenance_of(o), {}, &model.stop), Interrupted);
  EXPECT_THAT(model.calls, testing::AllOf(testing::Ge(11), testing::Le(13)));
  EXPECT_FALSE(std::filesystem::exists(dir / "campaign.nc"));
  const Ringing second;
  const auto summary = run(second, dir);
  EXPECT_EQ(summary.reused, std::size_t(model.calls));
  EXPECT_EQ(second.calls, 40 - model.calls);
  EXPECT_EQ(arrays(dir), arrays(whole));
}

TEST(Campaign, OneOfAnotherDesignReusesTheExistingRuns) {
  const auto dir = scratch("campaign_larger"), whole = scratch("campaign_larger_whole");
  auto o = small(16);
  o.design = "sobol";  // whose first points are those of a longer one
  const auto first = run(Ringing(), dir, o);
  EXPECT_EQ(first.reused, 0u);
  o.runs = 40;
  set_campaign_aside(dir);
  const Ringing model;
  const auto larger = run(model, dir, o);
  EXPECT_EQ(larger.reused, 16u);
  EXPECT_EQ(model.calls, 24);
  (void)run(Ringing(), whole, o);
  EXPECT_EQ(arrays(dir), arrays(whole));
  // Runs that kept their pulses serve a campaign without them; runs without do not serve one that keeps them.
  o.keep_pulses = false;
  set_campaign_aside(dir);
  EXPECT_EQ(run(Ringing(), dir, o).reused, 40u);
  const auto bare = scratch("campaign_bare");
  (void)run(Ringing(), bare, o);
  o.keep_pulses = true;
  set_campaign_aside(bare);
  EXPECT_EQ(run(Ringing(), bare, o).reused, 0u);
  EXPECT_EQ(arrays(bare), arrays(whole));
}

TEST(Campaign, RunsOfAnotherCaseAreRefusedByName) {
  const auto dir = scratch("campaign_other_case");
  const auto o = small();
  Ringing model;
  model.stop_at = 11;
  EXPECT_THROW((void)run(model, dir, o, 1, provenance_of(o), {}, &model.stop), Interrupted);
  auto other = provenance_of(o);
  other.options["load"]["peak_pressure"] = 2e7;
  try {
    (void)run(Ringing(), dir, o, 1, other);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("load.peak_pressure"));
  }
  EXPECT_EQ(run(Ringing(), dir, o).reused, std::size_t(model.calls));
}

TEST(Campaign, ProgressCountsEveryRunOnce) {
  const auto o = small();
  std::vector<std::size_t> seen;
  std::size_t failures = 0;
  const auto summary = run(Ringing(), scratch("campaign_progress"), o, 3, provenance_of(o), [&](std::size_t n, std::size_t failed, std::size_t runs) {
    EXPECT_EQ(runs, 40u);
    seen.push_back(n);
    failures = failed;
  });
  ASSERT_EQ(seen.size(), 41u);
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i);
  EXPECT_EQ(failures, summary.failed);
}

TEST(Campaign, AJournalCutAtRandomBytesResumesToTheSameBytes) {
  const auto whole = scratch("campaign_cut_whole"), dir = scratch("campaign_cut");
  (void)run(Ringing(), whole);
  const auto o = small();
  Ringing stopped;
  stopped.stop_at = 30;
  EXPECT_THROW((void)run(stopped, dir, o, 2, provenance_of(o), {}, &stopped.stop), Interrupted);
  const auto journal = read_text(dir / "runs.journal");
  RandomStream random(7, 0);
  for (int trial = 0; trial < 25; ++trial) {
    for (const auto& entry : std::filesystem::directory_iterator(dir)) std::filesystem::remove(entry);
    auto torn = journal.substr(0, random.below(journal.size() + 1));
    if (trial % 3 == 0 && torn.size() > 2000) torn[torn.size() - 1 - random.below(1000)] ^= 0x40;  // and a damaged end
    std::ofstream(dir / "runs.journal", std::ios::binary) << torn;
    const auto summary = run(Ringing(), dir);
    EXPECT_LE(summary.reused, 31u);
    ASSERT_EQ(read_text(dir / "campaign.nc"), read_text(whole / "campaign.nc")) << trial;
  }
}

TEST(Campaign, KilledAtRandomInstantsResumesToTheSameBytes) {
  const auto whole = scratch("campaign_kill_whole"), dir = scratch("campaign_kill");
  const Ringing slow(1, std::chrono::microseconds(1500));
  const auto began = std::chrono::steady_clock::now();
  (void)run(slow, whole, small(), 1);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  RandomStream random(11, 0);
  int killed = 0;
  for (int round = 0; round < 8; ++round) {
    for (const auto& entry : std::filesystem::directory_iterator(dir)) std::filesystem::remove(entry);
    for (int kill = 0; kill < 4; ++kill) {
      const ::pid_t child = ::fork();
      ASSERT_GE(child, 0);
      if (child == 0) {
        try {
          (void)run(slow, dir, small(), 1 + round % 2);
        } catch (...) {
          ::_exit(1);
        }
        ::_exit(0);
      }
      std::this_thread::sleep_for(std::chrono::duration<double>(wall * random.uniform(0, kill < 3 ? 0.4 : 1.05)));
      ::kill(child, SIGKILL);
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      if (WIFSIGNALED(status))
        ++killed;
      else
        EXPECT_EQ(WEXITSTATUS(status), 0);
    }
    (void)run(Ringing(), dir);
    ASSERT_EQ(read_text(dir / "campaign.nc"), read_text(whole / "campaign.nc")) << round;
  }
  EXPECT_GT(killed, 10);
}
