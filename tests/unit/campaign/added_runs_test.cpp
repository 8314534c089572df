// Runs beside a campaign: taken from the journal when they are asked for again, failures with their reason, resumed after an interruption.
#include "forward/campaign/added_runs.hpp"

#include <gmock/gmock.h>

#include <atomic>

#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
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
  added.write(directory, "map");
  const NetcdfReader file(directory / "added_runs.nc");
  EXPECT_EQ(file.dimensions("strain_fine"), (std::vector<std::string>{"run", "sensor", "time"}));
  EXPECT_EQ(file.doubles("theta"), (std::vector<double>{1, 2, 7, 3}));
  EXPECT_EQ(file.integers("status"), (std::vector<int>{0, 0, 1, 0}));
  EXPECT_EQ(file.integers("status_fine"), (std::vector<int>{0, 2, 1, 0}));
  EXPECT_THAT(file.strings("message")[2], HasSubstr("collapsed"));
  const auto y = file.doubles("strain_fine");
  EXPECT_NEAR(y[2], 2.2, 1e-6);
  EXPECT_TRUE(std::isnan(y[5]));
  EXPECT_EQ(file.strings("asked_by"), (std::vector<std::string>(4, "map")));
}

// A later calibration must not hide what an earlier one asked for: map.compare_with learns from it.
TEST(AddedRuns, ThoseOfOtherCalibrationsStayInTheFile) {
  const Slope working(1), fine(1.1);
  const auto directory = scratch("added_by_two");
  const auto ask = [&](const std::string& method, const Eigen::MatrixXd& at, bool with_fine) {
    AddedRuns added(working, with_fine ? &fine : nullptr, of_test, directory);
    (void)added.run(at, std::vector<bool>(std::size_t(at.cols()), with_fine), 1);
    added.write(directory, method);
  };
  using Asked = std::vector<std::pair<double, std::string>>;
  const auto kept = [&] {
    std::vector<std::string> names;
    Asked all;
    for (const auto& k : read_added_runs(directory / "added_runs.nc", 3, names)) all.emplace_back(k.run.theta[0], join(k.asked_by, " "));
    return all;
  };
  ask("map", points, true);
  ask("spe", Eigen::RowVector2d(3, 4), false);  // 3 is one of MAP's, there with its finer partner
  EXPECT_EQ(kept(), (Asked{{1, "map"}, {2, "map"}, {7, "map"}, {3, "map spe"}, {4, "spe"}}));
  std::vector<std::string> names;
  const auto runs = read_added_runs(directory / "added_runs.nc", 3, names);
  EXPECT_EQ(names, std::vector<std::string>{"a"});
  ASSERT_TRUE(runs[3].run.fine.has_value());
  EXPECT_FLOAT_EQ(runs[3].run.fine->mean[2], 6.6f);
  EXPECT_THAT(runs[2].run.working.message, HasSubstr("collapsed"));
  EXPECT_FALSE(runs[4].run.fine.has_value());
  ask("map", Eigen::RowVector2d(1, 5), true);  // MAP anew, elsewhere
  EXPECT_EQ(kept(), (Asked{{3, "spe"}, {4, "spe"}, {1, "map"}, {5, "map"}}));

  AddedRuns other(working, &fine, {.stage = "added_runs", .seed = 4}, scratch("added_other"));  // another model's file is no help
  (void)other.run(points, {true, true, true, true}, 1);
  std::filesystem::copy_file(directory / "added_runs.nc", scratch("added_other_file") / "added_runs.nc");
  other.write(directory.parent_path() / "added_other_file", "spe");
  std::vector<std::string> of_other;
  EXPECT_EQ(read_added_runs(directory.parent_path() / "added_other_file" / "added_runs.nc", 3, of_other).size(), 4u);
  EXPECT_THROW((void)read_added_runs(directory / "added_runs.nc", 5, of_other), InputError);
}

}  // namespace
