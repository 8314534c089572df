// The diagnosis of models that cost little and are searched without an emulator: of several records, and of a single one.
#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "tests/unit/uq/experiment.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A quick model, one mesh and no noise: amplitude and speed, and a tone of its own frequency that may be missing, or a gauge that fades.
struct Quick {
  struct Truth {
    double tone = 0, frequency = 0, fade = 0, foreign = 0;
  };
  static double reading(std::size_t sensor, double t, double amplitude, double speed, const Truth& x, double last) {
    const double tone = 1e-4 * x.tone * std::sin(x.frequency * 1e6 * t) * (1 + 0.2 * double(sensor)) * std::exp(-1e6 * t / 80);
    return (strain(sensor, t, amplitude, speed, 0, 0, x.foreign) + tone) * (1 + (sensor == 2 ? x.fade : 0) * t / last);
  }
  static std::vector<AnalyticModel::Function> functions(const Truth& x) {
    std::vector<AnalyticModel::Function> all;
    for (std::size_t s = 0; s < sensors; ++s) all.emplace_back([=](auto p, double t) { return reading(s, t, p[0], p[1], x, 1e-6 * double(times - 1)); });
    return all;
  }
  AnalyticModel model;
  Recordings recordings;
  RecordingOptions recording_options;
  Problem problem;
  explicit Quick(const Truth& truth)
      : model({handbook("amplitude", 1, 0.03), handbook("speed", 1, 0.03)}, functions(truth), times, 1e-6, "strain"),
        recordings(pulses_of(model, {1.02, 0.985}, {.pulses = 12, .noise = 2e-6, .noise_time = 3e-6}, 5)), problem(make_problem(model.shape(), recordings, {})) {}

  static RunAdded runs() {
    return [](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) {
        const auto theta = thetas.col(Eigen::Index(i));
        Truth x{.frequency = 0.5};
        std::array<double, sensors> gain, drift;
        gain.fill(1), drift.fill(0);
        for (std::size_t k = 0; k < added.size(); ++k) {
          const std::string& key = added[k].parameter.key;
          const double v = theta[Eigen::Index(2 + k)];
          if (key == "mechanism.tone.strength") x.tone = v;
          if (key == "mechanism.tone.frequency") x.frequency = v;
          if (key.starts_with("gain.")) gain[std::size_t(key.back() - '0')] = v;
          if (key.starts_with("drift.")) drift[std::size_t(key.back() - '0')] = v;
        }
        RunRecord r{.done = true};
        for (std::size_t s = 0; s < sensors; ++s)
          for (std::size_t t = 0; t < times; ++t)
            r.mean.push_back(float(reading(s, 1e-6 * double(t), theta[0], theta[1], x, 1) * (gain[s] + drift[s] * double(t) / double(times - 1))));
        all.push_back(std::move(r));
      }
      return all;
    };
  }
  static std::vector<ParameterGroup> groups() {
    AddedParameter frequency = added("tone", "frequency", 0.2, 0.8, {0.25, 0.4, 0.6, 0.75});
    frequency.parameter.nominal = 0.5;
    std::vector<ParameterGroup> all{{.name = "tone", .added = {added("tone", "strength", -1, 1, {0.25, -0.25}), frequency}}};
    for (std::size_t s = 0; s < sensors; ++s) {
      AddedParameter gain = added("sensor_response", "gain", 0.85, 1.15, {1.1}), drift = added("sensor_response", "drift", -0.15, 0.15, {0.1});
      gain.parameter.nominal = 1, gain.parameter.key = "gain." + std::to_string(s), drift.parameter.key = "drift." + std::to_string(s);
      const std::string name = "S" + std::to_string(s);
      all.push_back({.name = "sensor_response", .place = name, .added = {gain, drift}, .sensor = name});
    }
    return all;
  }
  [[nodiscard]] Diagnosis diagnosed(std::vector<ParameterGroup> offered, int max_runs = 10000) const {
    PosteriorInputs base{.problem = problem, .recordings = recordings, .recording_options = recording_options,
                         .errors = {.values = 180, .band = 2e5, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0, .coherent_noise = 0, .young_sd = 0, .beyond = 0, .beyond_sd = 0, .beyond_rest = 0, .record_noise = 0}, .emulator = {}};
    base.parameters = model.shape().parameters, base.levels = 1, base.discrepancy = true, base.draw_in = base.least_squares = true;
    base.centre = {1, 1}, base.half_width = {0.06, 0.06};
    return diagnose({.base = base, .groups = std::move(offered), .run = runs(), .options = {.max_runs = max_runs, .leaders = 2, .pairs = false}, .say = {}, .round = {}});
  }
};

TEST(Diagnosis, ANumberThatDoesNothingAloneIsFittedWithTheOthers) {
  const Quick quick({.tone = 0.2, .frequency = 0.63});
  const auto groups = with_idle_numbers_as_shapes(Quick::groups(), Quick::runs(), std::vector{1.0, 1.0});
  ASSERT_EQ(groups[0].added.size(), 1u);
  ASSERT_EQ(groups[0].shapes.size(), 1u);
  EXPECT_EQ(groups[0].shapes[0].parameter.name, "tone.frequency");
  EXPECT_EQ(groups[1].added.size(), 2u);  // both of a gauge act alone
  const Diagnosis d = quick.diagnosed(groups);
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("tone")) << d.verdict.reason;
  ASSERT_EQ(d.candidates[0].numbers.size(), 2u);
  EXPECT_NEAR(d.candidates[0].numbers[0].mean, 0.2, 4 * d.candidates[0].numbers[0].sd);
  EXPECT_NEAR(d.candidates[0].numbers[1].mean, 0.63, 4 * d.candidates[0].numbers[1].sd);
  EXPECT_LT(d.candidates[0].numbers[1].sd, 0.02);
  // The control: held at what the case leaves it, the frequency is another, and the name is not given.
  auto held = Quick::groups();
  held[0].added.pop_back();
  EXPECT_NE(quick.diagnosed(held).verdict.kind, VerdictKind::named);
}

// The search of a cheap model itself ends within the budget, whatever it would still take, and what it ended is told.
TEST(Diagnosis, TheFitOfAQuickModelEndsWithinTheBudget) {
  const Quick quick({.tone = 0.2, .frequency = 0.63});
  const Diagnosis whole = quick.diagnosed(Quick::groups());
  EXPECT_THAT(whole.skipped, IsEmpty());
  const auto tone = std::find_if(whole.candidates.begin(), whole.candidates.end(), [](const auto& c) { return c.explanation.name == "tone"; });
  ASSERT_NE(tone, whole.candidates.end());
  ASSERT_GT(tone->runs, 10);
  const int budget = whole.runs - tone->runs / 2;
  const Diagnosis ended = quick.diagnosed(Quick::groups(), budget);
  EXPECT_LE(ended.runs, budget);
  ASSERT_FALSE(ended.skipped.empty());
  EXPECT_THAT(ended.skipped.back(), ::testing::HasSubstr("diagnosis.max_runs"));
}

TEST(Diagnosis, AGaugeThatFadesIsNamedInTheTrueModel) {
  const Diagnosis d = Quick({.fade = -0.1}).diagnosed(Quick::groups());
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("sensor_response")) << d.verdict.reason;
  EXPECT_EQ(d.candidates[0].sensor, "S2");
  EXPECT_THAT(d.candidates[0].other_sensors, IsEmpty());
  ASSERT_EQ(d.candidates[0].numbers.size(), 2u);
  EXPECT_EQ(d.candidates[0].numbers[1].name, "S2.sensor_response.drift");
  EXPECT_NEAR(d.candidates[0].numbers[1].mean, -0.1, 4 * d.candidates[0].numbers[1].sd);
}

TEST(Diagnosis, OfAQuickModelNothingMissingIsNoneAndWhatNobodyOffersUnknown) {
  EXPECT_EQ(Quick({}).diagnosed(Quick::groups()).verdict.kind, VerdictKind::none);
  EXPECT_EQ(Quick({.foreign = 0.3}).diagnosed(Quick::groups()).verdict.kind, VerdictKind::unknown);
}

/// One record of a pulse that runs far: a model that is exact and costs nothing, whose parameters shift what it shows by many of its standard deviations. Late oscillations, where
/// the dispersion is not 0; a lag is the rival.
struct Traveller {
  std::vector<Parameter> parameters{handbook("speed", 1, 0.02), handbook("gain", 1, 0.02)};
  static double signal(double t, double speed, double gain, double dispersion, double lag) {
    const double s = 1e6 * t - 60 / speed, w = 8 + lag;
    const double front = 0.5 * (1 + std::tanh(s / w)), tail = s > -20 ? std::sin(0.9 * s / (1 + 3 * dispersion)) * std::exp(-std::pow((s - 12) / 14, 2)) : 0;
    return gain * (front + dispersion * tail);
  }
  AnalyticModel model;
  Recordings recordings;
  RecordingOptions options;
  Problem problem;
  explicit Traveller(double dispersion)
      : model(parameters, {[=](auto p, double t) { return signal(t, p[0], p[1], dispersion, 0); }}, 120, 1e-6, "V"),
        recordings(pulses_of(model, {1.013, 0.99}, {.pulses = 1, .noise = 1e-3}, 3)), options(noise()), problem(make_problem(model.shape(), recordings, options)) {}
  static RecordingOptions noise() {
    RecordingOptions o;
    o.unit = "V", o.noise = 1e-3;
    return o;
  }
  [[nodiscard]] Diagnosis diagnosed() const {
    PosteriorInputs base{.problem = problem, .recordings = recordings, .recording_options = options, .errors = {.values = 120, .band = 5e5}, .emulator = {}};
    base.parameters = parameters, base.levels = 1, base.discrepancy = true, base.draw_in = true;
    base.centre = {1, 1}, base.half_width = {0.04, 0.04};
    AddedParameter dispersion = added("dispersion", "strength", 0, 0.4, {0.1}), lag = added("lag", "time", 0, 8, {2});
    const DiagnosisInputs in{.base = base,
                             .groups = {{.name = "dispersion", .added = {dispersion}}, {.name = "lag", .added = {lag}}},
                             .run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> a) {
                               std::vector<RunRecord> all(level.size());
                               for (std::size_t i = 0; i < level.size(); ++i) {
                                 const auto theta = thetas.col(Eigen::Index(i));
                                 double by_dispersion = 0, by_lag = 0;
                                 for (std::size_t k = 0; k < a.size(); ++k) (a[k].parameter.name == "lag.time" ? by_lag : by_dispersion) = theta[Eigen::Index(2 + k)];
                                 all[i].done = true;
                                 for (int t = 0; t < 120; ++t) all[i].mean.push_back(float(signal(1e-6 * t, theta[0], theta[1], by_dispersion, by_lag)));
                               }
                               return all;
                             },
                             .options = {},
                             .say = {}};
    return diagnose(in);
  }
};

TEST(Diagnosis, OfAnExactModelAndASingleRecordNamesWhatIsConcealed) {
  const Diagnosis d = Traveller(0.15).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("dispersion"));
  const Alternative& c = d.candidates[0];
  EXPECT_NEAR(c.numbers[0].mean, 0.15, 3 * c.numbers[0].sd);
  EXPECT_LT(c.numbers[0].sd, 0.01);
  EXPECT_NEAR(c.base_parameters[0].mean, 1.013, 3 * c.base_parameters[0].sd);
  EXPECT_LT(d.held_out_after, 0.3 * d.held_out_before);  // by parts of the only record
  EXPECT_THAT(d.separating, ::testing::HasSubstr(" V ("));
}

TEST(Diagnosis, OfAnExactModelFindsNothingWhereNothingIsMissing) {
  const Diagnosis d = Traveller(0).diagnosed();
  EXPECT_EQ(d.verdict.kind, VerdictKind::none) << d.verdict.reason;
}

TEST(Folds, OfASingleRecordAreQuartersOfItsTimeElseGauges) {
  const Traveller one(0);
  const auto quarters = folds_by_face(one.problem, Decimation(one.problem, 120), {});
  ASSERT_EQ(quarters.size(), 4u);
  EXPECT_EQ(quarters[1].rows.front(), 30);
  EXPECT_EQ(quarters[3].rows.back(), 119);
  EXPECT_DOUBLE_EQ(quarters[0].records, 0.25);
  const Experiment six(0, 0, 0, 1, 1);
  const Decimation grid(six.problem, 240);
  const auto gauges = folds_by_face(six.problem, grid, {});
  ASSERT_EQ(gauges.size(), 6u);
  EXPECT_EQ(gauges[2].rows.front(), Eigen::Index(grid.offset(2)));
  EXPECT_EQ(gauges[2].rows.size(), grid.windows(2).size());
}

}  // namespace
}  // namespace calomel
