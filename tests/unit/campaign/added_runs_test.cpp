// Runs beside a campaign: taken from the journal when they are asked for again, failures with their reason, resumed after an interruption.
#include "forward/campaign/added_runs.hpp"

#include <gmock/gmock.h>

#include <atomic>

#include "base/netcdf_file.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {

/// y(t) = a t, times a factor; fails beyond a = 5.
class Slope : public ForwardModel {
 public:
  explicit Slope(double factor) : factor_(factor) {
    shape_.parameters = {{.name = "a", .key = "x.a", .min = 0, .max = 10, .nominal = 1.0}};
    shape_.conditions = {"default"}, shape_.sensors = {"S"}, shape_.times = {0, 1, 2};
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    ++calls;
    if (stop_at > 0 && calls >= stop_at) stop = true;
    if (theta[0] > 5) return {.ok = false, .message = "the step collapsed"};
    Prediction p;
    for (const double t : shape_.times) p.mean.push_back(factor_ * theta[0] * t);
    return p;
  }
  mutable std::atomic<int> calls = 0;
  mutable std::atomic<bool> stop = false;
  int stop_at = 0;

 private:
  ModelShape shape_;
  double factor_;
};

const Provenance of_test{.stage = "added_runs", .seed = 3};
const Eigen::MatrixXd points = Eigen::RowVector4d(1, 2, 7, 3);

TEST(AddedRuns, PairsWhatIsAskedAndKeepsTheReasonsOfFailures) {
  const Slope working(1), fine(1.1);
  AddedRuns added(working, &fine, of_test, scratch("added"));
  const auto runs = added.run(points, {true, false, true, true}, 2);
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_FLOAT_EQ(runs[0].working.mean[2], 2);
  EXPECT_FLOAT_EQ(runs[0].fine->mean[2], 2.2f);
  EXPECT_FALSE(runs[1].fine.has_value());
  EXPECT_TRUE(runs[1].done());
  EXPECT_FALSE(runs[2].done());
  EXPECT_THAT(runs[2].working.message, HasSubstr("collapsed"));
  EXPECT_EQ(added.made(), 7u);
}

TEST(AddedRuns, TheSamePointIsNotRunTwiceInThisLifeOrTheNext) {
  const Slope working(1), fine(1.1);
  const auto directory = scratch("added_again");
  {
    AddedRuns added(working, &fine, of_test, directory);
    (void)added.run(points, {true, false, true, true}, 1);
    (void)added.run(points.leftCols(1), {true}, 1);
    EXPECT_EQ(working.calls, 4);
  }
  AddedRuns added(working, &fine, of_test, directory);
  const auto runs = added.run(points, {true, true, true, true}, 1);  // the second one now with the finer mesh
  EXPECT_EQ(working.calls, 4);
  EXPECT_EQ(fine.calls, 4);
  EXPECT_EQ(added.made(), 1u);
  EXPECT_EQ(added.reused(), 7u);
  EXPECT_FLOAT_EQ(runs[3].fine->mean[1], 3.3f);
  EXPECT_THROW((void)AddedRuns(working, &fine, {.stage = "added_runs", .seed = 4}, scratch("other") / ".." / directory.filename()), InputError);
}

TEST(AddedRuns, AreResumedAfterAnInterruption) {
  const auto directory = scratch("added_stop");
  const Slope whole(1);
  Slope working(1);
  working.stop_at = 2;
  {
    AddedRuns added(working, nullptr, of_test, directory);
    EXPECT_FALSE(added.has_fine());
    EXPECT_THROW((void)added.run(points, {true, true, true, true}, 1, {}, &working.stop), Interrupted);
  }
  AddedRuns added(whole, nullptr, of_test, directory);
  const auto runs = added.run(points, {true, true, true, true}, 1);
  EXPECT_EQ(whole.calls, 2);  // two were in the journal
  EXPECT_FALSE(runs[0].fine.has_value());
  EXPECT_FLOAT_EQ(runs[1].working.mean[2], 4);
}

TEST(AddedRuns, AreWrittenForReaders) {
  const Slope working(1), fine(1.1);
  const auto directory = scratch("added_file");
  AddedRuns added(working, &fine, of_test, directory);
  (void)added.run(points, {true, false, true, true}, 1);
  added.write(directory);
  const NetcdfReader file(directory / "added_runs.nc");
  EXPECT_EQ(file.dimensions("strain_fine"), (std::vector<std::string>{"run", "sensor", "time"}));
  EXPECT_EQ(file.doubles("theta"), (std::vector<double>{1, 2, 7, 3}));
  EXPECT_EQ(file.integers("status"), (std::vector<int>{0, 0, 1, 0}));
  EXPECT_EQ(file.integers("status_fine"), (std::vector<int>{0, 2, 1, 0}));
  EXPECT_THAT(file.strings("message")[2], HasSubstr("collapsed"));
  const auto y = file.doubles("strain_fine");
  EXPECT_NEAR(y[2], 2.2, 1e-6);
  EXPECT_TRUE(std::isnan(y[5]));
}

}  // namespace
