// The diagnosis of models with cheap runs, which are searched without an emulator: of several records, and of a single one.
#include "uq/diagnosis/diagnosis.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "tests/unit/inverse/lines.hpp"
#include "tests/unit/uq/experiment.hpp"
#include "tests/unit/uq/diagnosis/traveller.hpp"

namespace calomel {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;

/// A model with cheap runs, one mesh and no noise: amplitude and speed, and a tone of its own frequency that may be missing, or a gauge that fades.
struct CheapModel {
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
  explicit CheapModel(const Truth& truth)
      : model({handbook("amplitude", 1, 0.03), handbook("speed", 1, 0.03)}, functions(truth), times, 1e-6, "strain"),
        recordings(pulses_of(model, {1.02, 0.985}, {.pulses = 12, .noise = 2e-6, .noise_time = 3e-6}, 5)),
        problem(make_problem(model.shape(), recordings, {})) {}

  static RunAdded runs() {
    return [](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) {
        const auto theta = thetas.col(Eigen::Index(i));
        Truth x{.frequency = 0.5};
        std::array<double, sensors> gain, drift;
        gain.fill(1);
        drift.fill(0);
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
      gain.parameter.nominal = 1;
      gain.parameter.key = "gain." + std::to_string(s);
      drift.parameter.key = "drift." + std::to_string(s);
      const std::string name = "S" + std::to_string(s);
      all.push_back({.name = "sensor_response", .place = name, .added = {gain, drift}, .sensor = name});
    }
    return all;
  }
  [[nodiscard]] Diagnosis diagnosed(std::vector<ParameterGroup> offered, int max_runs = 10000) const {
    PosteriorInputs base{.problem = problem,
                         .recordings = recordings,
                         .recording_options = recording_options,
                         .errors = {.values = 180,
                                    .band = 2e5,
                                    .energy_scale_sd = 0,
                                    .gain_sd = 0,
                                    .baseline = 0,
                                    .coherent_noise = 0,
                                    .young_sd = 0,
                                    .beyond = 0,
                                    .beyond_sd = 0,
                                    .beyond_rest = 0,
                                    .record_noise = 0},
                         .emulator = {}};
    base.parameters = model.shape().parameters;
    base.levels = 1;
    base.discrepancy = true;
    base.box.kind = BoxStrategy::Kind::least_squares;
    base.centre = {1, 1};
    base.half_width = {0.06, 0.06};
    return diagnose({.base = base,
                     .groups = std::move(offered),
                     .run = runs(),
                     .options = {.max_runs = max_runs, .leaders = 2, .pairs = false},
                     .report = {},
                     .round = {}});
  }
};

TEST(Diagnosis, ANumberThatDoesNothingAloneIsFittedWithTheOthers) {
  const CheapModel cheap({.tone = 0.2, .frequency = 0.63});
  const auto groups = with_idle_numbers_as_shapes(CheapModel::groups(), CheapModel::runs(), std::vector{1.0, 1.0});
  ASSERT_EQ(groups[0].added.size(), 1u);
  ASSERT_EQ(groups[0].shapes.size(), 1u);
  EXPECT_EQ(groups[0].shapes[0].parameter.name, "tone.frequency");
  EXPECT_EQ(groups[1].added.size(), 2u);  // both of a gauge act alone
  const Diagnosis d = cheap.diagnosed(groups);
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("tone")) << described(d.verdict);
  ASSERT_EQ(d.candidates[0].numbers.size(), 2u);
  EXPECT_NEAR(d.candidates[0].numbers[0].mean, 0.2, 4 * d.candidates[0].numbers[0].sd);
  EXPECT_NEAR(d.candidates[0].numbers[1].mean, 0.63, 4 * d.candidates[0].numbers[1].sd);
  EXPECT_LT(d.candidates[0].numbers[1].sd, 0.02);
  // The control: held at what the case leaves it, the frequency is another, and the name is not given.
  auto held = CheapModel::groups();
  held[0].added.pop_back();
  EXPECT_NE(cheap.diagnosed(held).verdict.kind, VerdictKind::named);
}

// The search for the fit of a model with cheap runs ends within the budget, and the diagnosis lists the search that it ended.
TEST(Diagnosis, TheFitOfACheapModelEndsWithinTheBudget) {
  const CheapModel cheap({.tone = 0.2, .frequency = 0.63});
  const Diagnosis whole = cheap.diagnosed(CheapModel::groups());
  EXPECT_THAT(whole.skipped, IsEmpty());
  const auto tone = std::find_if(whole.candidates.begin(), whole.candidates.end(), [](const auto& c) { return c.explanation.name == "tone"; });
  ASSERT_NE(tone, whole.candidates.end());
  ASSERT_GT(tone->runs, 10);
  const int budget = whole.runs - tone->runs / 2;
  const Diagnosis ended = cheap.diagnosed(CheapModel::groups(), budget);
  EXPECT_LE(ended.runs, budget);
  ASSERT_FALSE(ended.skipped.empty());
  EXPECT_EQ(ended.skipped.back().limit, budget);
}

// An explanation for which no runs were left is neither named nor ruled out.
TEST(Diagnosis, AnExplanationThatTheBudgetLeavesOutKeepsItsEvidenceToFirstOrder) {
  const CheapModel cheap({.tone = 0.2, .frequency = 0.5});
  const std::vector<ParameterGroup> tone_alone{CheapModel::groups()[0]};
  const Diagnosis whole = cheap.diagnosed(tone_alone);
  ASSERT_THAT(whole.verdict.mechanisms, ElementsAre("tone")) << described(whole.verdict);
  const Diagnosis d = cheap.diagnosed(tone_alone, whole.runs - whole.candidates[0].runs + 5);
  const Alternative* tone = d.alternative("tone");
  ASSERT_NE(tone, nullptr);
  ASSERT_FALSE(tone->explanation.fitted);
  EXPECT_GT(tone->explanation.log_bayes_factor, Gates{}.log_bayes_factor);
  EXPECT_EQ(d.verdict.kind, VerdictKind::unknown);
  EXPECT_EQ(d.verdict.reason.gate, Gate::fitted);
  EXPECT_EQ(d.verdict.reason.leading, "tone");
  EXPECT_THAT(d.unsettled(), ElementsAre("tone"));  // not to be trusted
  EXPECT_THAT(d.skipped, Contains(Field(&SkippedStep::name, "tone")));
}

TEST(Diagnosis, AGaugeThatFadesIsNamedInTheTrueModel) {
  const Diagnosis d = CheapModel({.fade = -0.1}).diagnosed(CheapModel::groups());
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("sensor_response")) << described(d.verdict);
  EXPECT_EQ(d.candidates[0].sensor, "S2");
  EXPECT_THAT(d.candidates[0].other_sensors, IsEmpty());
  ASSERT_EQ(d.candidates[0].numbers.size(), 2u);
  EXPECT_EQ(d.candidates[0].numbers[1].name, "S2.sensor_response.drift");
  EXPECT_NEAR(d.candidates[0].numbers[1].mean, -0.1, 4 * d.candidates[0].numbers[1].sd);
}

TEST(Diagnosis, OfACheapModelNothingMissingIsNoneAndAnEffectThatNobodyOffersUnknown) {
  EXPECT_EQ(CheapModel({}).diagnosed(CheapModel::groups()).verdict.kind, VerdictKind::none);
  EXPECT_EQ(CheapModel({.foreign = 0.3}).diagnosed(CheapModel::groups()).verdict.kind, VerdictKind::unknown);
}

TEST(Diagnosis, OfAnExactModelAndASingleRecordNamesWhatIsConcealed) {
  const Diagnosis d = Traveller(0.15).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << described(d.verdict);
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("dispersion"));
  const Alternative& c = d.candidates[0];
  EXPECT_NEAR(c.numbers[0].mean, 0.15, 3 * c.numbers[0].sd);
  EXPECT_LT(c.numbers[0].sd, 0.01);
  EXPECT_NEAR(c.base_parameters[0].mean, 1.013, 3 * c.base_parameters[0].sd);
  EXPECT_LT(d.hold_out.after, 0.3 * d.hold_out.before);  // by parts of the only record
  ASSERT_TRUE(d.separating);
  EXPECT_EQ(d.separating->unit, "V");
}

TEST(Diagnosis, OfAnExactModelFindsNothingWhereNothingIsMissing) {
  const Diagnosis d = Traveller(0).diagnosed();
  EXPECT_EQ(d.verdict.kind, VerdictKind::none) << described(d.verdict);
}

}  // namespace
}  // namespace calomel
