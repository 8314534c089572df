// Runs: each is made once, the expensive ones first, and kept as it ends.
#include "forward/simulation/runs.hpp"

#include <gmock/gmock.h>

#include "base/provenance.hpp"
#include "forward/simulation/simulated_model.hpp"
#include "tests/model_simulator.hpp"
#include "tests/scratch.hpp"

namespace calomel {
namespace {

/// The number a over the element size; it fails below a = 0 and gives no answer at a = 99 the first time.
class Quotient final : public Simulator {
 public:
  Quotient() {
    shape_.parameters = {{.name = "a", .key = "number.a", .min = -1, .max = 100, .nominal = 1.0}};
    shape_.conditions = {"default"};
    shape_.sensors = {"S"};
    shape_.times = {0};
  }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] const Capabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Prediction evaluate(const RunRequest& r) const override {
    const std::lock_guard guard(lock_);
    sizes.push_back(r.element_size.value_or(1));
    if (stop_at > 0 && int(sizes.size()) >= stop_at) stop = true;
    const double a = r.numbers.at("number.a");
    if (a < 0) return {.ok = false, .message = "a is negative"};
    if (a == 99 && !answered_.exchange(true)) return {.ok = false, .lost = true, .message = "no answer"};
    Prediction p{.mean = {a / sizes.back()}};
    p.energies = {1.0};
    p.pulses = {float(p.mean[0])};
    return p;
  }
  [[nodiscard]] double cost(const RunRequest& r) const override { return 1 / r.element_size.value_or(1); }
  [[nodiscard]] std::vector<ParameterGroup> offered() const override { return {}; }
  [[nodiscard]] Description describe(int) const override { return {}; }
  [[nodiscard]] SimulatorIdentity identity() const override { return {}; }
  [[nodiscard]] Json echo() const override { return Json::object(); }
  [[nodiscard]] Simulated simulate(const SimulateCall&) const override { return {}; }

  mutable std::vector<double> sizes;  ///< of the runs, in the order in which they were begun
  mutable std::atomic<bool> stop = false;
  int stop_at = 0;

 private:
  ModelShape shape_;
  std::string name_ = "quotient";
  Capabilities capabilities_{.pulses = true};
  mutable std::mutex lock_;
  mutable std::atomic<bool> answered_ = false;
};

RunRequest run_of_size(double a, double size = 1, Outputs wanted = {}) {
  RunRequest r;
  r.numbers = {{"number.a", a}};
  r.element_size = size;
  r.wanted = wanted;
  return r;
}

TEST(Runs, MakeARunOnceInThisLifeAndTheNext) {
  const Provenance of_test{.stage = "runs", .seed = 3};
  const auto path = scratch("runs_once") / "runs.journal";
  const std::vector<RunRequest> requests{run_of_size(3, 0.5), run_of_size(3), run_of_size(3, 0.5), run_of_size(-1)};
  const ThreadExecutor two(2);
  const Quotient model;
  {
    RunStore store(of_test, path);
    Runs runs(model, store, two);
    const auto records = runs.get(requests);
    ASSERT_EQ(records.size(), 4u);
    EXPECT_EQ(records[0].mean, std::vector<float>{6});
    EXPECT_EQ(records[1].mean, std::vector<float>{3});
    EXPECT_EQ(records[2], records[0]);
    EXPECT_EQ(records[3].message, "a is negative");
    EXPECT_EQ(runs.made(), 3u);
    EXPECT_EQ(runs.failed(), 1u);
  }
  RunStore store(of_test, path);
  Runs runs(model, store, two);
  EXPECT_EQ(runs.get(requests)[1].mean, std::vector<float>{3});
  EXPECT_EQ(runs.made(), 0u);
  EXPECT_EQ(runs.reused(), 3u);
  EXPECT_EQ(model.sizes.size(), 3u);
}

TEST(Runs, OneThatIsRequestedTwiceIsMadeOnceWithAllThatIsWanted) {
  const Quotient model;
  RunsInMemory runs(model);
  const auto records = runs->get(std::vector{run_of_size(3), run_of_size(3, 1, {.mean = true, .pulses = true})});
  EXPECT_EQ(model.sizes.size(), 1u);
  EXPECT_TRUE(records[0].pulses.empty());
  EXPECT_EQ(records[1].pulses, std::vector<float>{3});
  (void)runs->get(std::vector{run_of_size(3)});
  EXPECT_EQ(model.sizes.size(), 1u);
}

TEST(Runs, TheExpensiveOnesAreBegunFirst) {
  const Quotient model;
  RunsInMemory runs(model);
  runs->make(std::vector{run_of_size(1, 2), run_of_size(1, 0.5), run_of_size(1, 1)});
  EXPECT_THAT(model.sizes, testing::ElementsAre(0.5, 1, 2));
}

TEST(Runs, StoppedKeepsWhatWasFinished) {
  Quotient model;
  model.stop_at = 1;
  RunsInMemory runs(model, 1, &model.stop);
  EXPECT_THROW(runs->make(std::vector{run_of_size(1), run_of_size(2)}), Interrupted);
  EXPECT_EQ(runs->store().size(), 1u);
  model.stop_at = 0;
  model.stop = false;
  runs->make(std::vector{run_of_size(1), run_of_size(2)});
  EXPECT_EQ(model.sizes.size(), 2u);
}

TEST(Runs, ProgressCountsTheRunsThatAreMade) {
  const Quotient model;
  RunsInMemory runs(model);
  runs->make(std::vector{run_of_size(1)});
  std::vector<std::pair<std::size_t, std::size_t>> seen;
  runs->make(std::vector{run_of_size(1), run_of_size(2), run_of_size(3)}, [&](std::size_t done, std::size_t total) { seen.emplace_back(done, total); });
  EXPECT_EQ(seen, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 2}, {1, 2}, {2, 2}}));
}

TEST(Runs, AMissingResponseIsReportedAndNotRequestedAgainInThisCall) {
  const Quotient model;
  RunsInMemory runs(model);
  EXPECT_TRUE(runs->get(std::vector{run_of_size(99)})[0].lost);
  EXPECT_TRUE(runs->get(std::vector{run_of_size(99)})[0].lost);
  EXPECT_EQ(runs->store().size(), 0u);
  EXPECT_EQ(runs->store().lost(), 1u);
}

TEST(SimulatedModel, GivesTheRunsOfTheTrueModel) {
  const Quotient model;
  RunsInMemory runs(model);
  const SimulatedModel kept(*runs), anew(*runs, false);
  const std::vector<double> theta{1.0 / 3}, bad{-1};
  EXPECT_EQ(kept.evaluate(theta).mean[0], 1.0 / 3) << "few values are recorded in double precision";
  EXPECT_EQ(kept.evaluate(theta).mean, anew.evaluate(theta).mean);
  EXPECT_EQ(model.sizes.size(), 2u);
  const Eigen::MatrixXd thetas = Eigen::RowVector3d(2, -1, 1.0 / 3);
  std::size_t done = 0;
  const auto predictions = kept.predictions(thetas, 1, [&](std::size_t now, std::size_t) { done = now; });
  ASSERT_EQ(predictions.size(), 3u);
  EXPECT_EQ(done, 2u);
  EXPECT_TRUE(predictions[0].ok);
  EXPECT_FALSE(predictions[1].ok);
  EXPECT_EQ(predictions[1].message, "a is negative");
  EXPECT_EQ(model.sizes.size(), 4u);
  const Eigen::MatrixXf means = kept.means(thetas, 1);
  EXPECT_EQ(means(0, 0), 2);
  EXPECT_TRUE(std::isnan(means(0, 1)));
  EXPECT_EQ(model.sizes.size(), 4u);
}

}  // namespace
}  // namespace calomel
