// The diagnosis on models that are formulas: nothing missing, one effect concealed, one faulty gauge, an effect that nobody offers. And its parts alone.
#include "uq/diagnosis/diagnosis_artefacts.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "base/netcdf_file.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/uq/experiment.hpp"
#include "uq/diagnosis/plain_words.hpp"
#include "uq/posterior_moments.hpp"

namespace calomel {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Le;

TEST(Diagnosis, NothingMissingIsNone) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Diagnosis d = Experiment(0, 0, 0, 1, seed).diagnosed();
    EXPECT_EQ(d.verdict.kind, VerdictKind::none) << d.verdict.reason;
    EXPECT_DOUBLE_EQ(d.held_out_after, d.held_out_before);
    EXPECT_EQ(shown_explanation(d), nullptr);
    EXPECT_FALSE(d.missing);
    // What is told of numbers is under the likelihood to the power that the evidences are taken to.
    const LogPosterior& posterior = *d.base.posterior;
    const Moments sharp = sampled_moments(posterior, d.base.modes[0], 1), weak = sampled_moments(posterior.to_the_power(0.5), d.base.modes[0], 1);
    EXPECT_GT(weak.sd[1], 1.2 * sharp.sd[1]);
    EXPECT_GT(d.base_parameters[1].sd, 0.95 * weak.sd[1]);
    EXPECT_NEAR(d.base_parameters[1].mean, weak.mean[1], 0.1 * weak.sd[1]);
  }
}

// Two conditions of three gauges each.
TEST(Diagnosis, AConditionIsPredictedByTheOthersBetterWithWhatIsNamed) {
  const std::vector<std::string> powers{"low", "high"};
  const auto folder = scratch("diagnosis_conditions");
  const Diagnosis d = Experiment(0.3, 0, 0, 1, 1, powers).diagnosed(folder);
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("echo")) << d.verdict.reason;
  ASSERT_EQ(d.held_out_conditions.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(d.held_out_conditions[c].name, powers[c]);
    EXPECT_LT(d.held_out_conditions[c].after, 0.5 * d.held_out_conditions[c].before);
  }
  EXPECT_EQ(read_json(folder / "diagnosis.json").at("conditions")[1].at("name"), "high");
  const Diagnosis none = Experiment(0, 0, 0, 1, 1, powers).diagnosed();
  for (const auto& c : none.held_out_conditions) EXPECT_EQ(c.after, c.before);
  EXPECT_THAT(Experiment(0, 0, 0, 1, 1).diagnosed().held_out_conditions, IsEmpty());
}

TEST(Diagnosis, AConcealedEffectIsNamedAndGivesTheBaseParametersBack) {
  const auto folder = scratch("diagnosis_artefacts");
  const Experiment experiment(0.3, 0, 0, 1, 1);
  const Diagnosis d = experiment.diagnosed(folder);
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("echo"));
  EXPECT_FALSE(d.missing);
  const Alternative& c = d.candidates[0];
  ASSERT_EQ(c.numbers.size(), 1u);
  EXPECT_NEAR(c.numbers[0].mean, 0.3, 3 * c.numbers[0].sd + 0.003);
  EXPECT_NEAR(c.base_parameters[1].mean, 0.985, 3 * c.base_parameters[1].sd + 0.002);
  EXPECT_LT(d.held_out_after, 0.6 * d.held_out_before);
  const auto& w = d.location.windows;
  EXPECT_GT(std::max_element(w.begin(), w.end(), [](const auto& a, const auto& b) { return a.score < b.score; })->begin, 40e-6);  // the echo comes after 50 us
  EXPECT_LT(d.location.sensors[0].q_value, 0.05);
  // The first place on the map where the mismatch is more than chance is the one that is told.
  double first = 1;
  for (Eigen::Index i = 0; i < d.location.map_q_values.rows(); ++i)
    for (Eigen::Index k = 0; k < d.location.map_q_values.cols(); ++k)
      if (d.location.map_q_values(i, k) < 0.05) first = std::min(first, w[std::size_t(k)].begin);
  EXPECT_DOUBLE_EQ(first, d.location.first_time);

  // Its artefacts: the sentences, the misfit of every gauge, the handbook, the histories.
  const Json json = read_json(folder / "diagnosis.json");
  EXPECT_THAT(json["finding"].get<std::string>(), ::testing::HasSubstr("leaves something out: echo; with it the misfit of the records falls from"));
  EXPECT_EQ(json["summary"], json["finding"].get<std::string>() + ' ' + json["next_step"].get<std::string>());
  double held_out = 0, before = 0;
  ASSERT_EQ(json["gauges"].size(), sensors);
  for (const auto& g : json["gauges"]) {
    EXPECT_LT(g["after"].get<double>(), g["before"].get<double>()) << g["name"];
    held_out += g["heldout_before"].get<double>() / double(sensors), before += g["before"].get<double>() / double(sensors);
  }
  EXPECT_NEAR(held_out, d.held_out_before, 1e-6);  // the mean over the gauges is the rule's own number
  EXPECT_NEAR(before, json["fit"]["before"]["compared_nrmse"].get<double>(), 1e-12);
  EXPECT_EQ(json["base_parameters"]["handbook"]["speed"], (Json{{"mean", 1.0}, {"sd", 0.03}}));
  EXPECT_EQ(json["location"]["map_q_values"].size(), sensors);
  for (const auto& r : json["ranking"]) EXPECT_FALSE(r["why"].get<std::string>().empty()) << r["name"];
  EXPECT_GT(json["ranking"][0]["explained"].get<double>(), 0.5);

  const NetcdfReader file(folder / "diagnosis.nc");
  EXPECT_EQ(file.attribute("explanation"), "echo");
  const auto base = file.doubles("base"), explained = file.doubles("explained"), out = file.doubles("held_out_explained"), out_base = file.doubles("held_out_base"), mean = file.doubles("record_mean");
  ASSERT_EQ(mean.size(), sensors * times);
  const auto distance = [&](const std::vector<double>& x) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - mean[i]) * (x[i] - mean[i]);
    return std::sqrt(sum);
  };
  EXPECT_LT(distance(explained), 0.5 * distance(base));
  EXPECT_LT(distance(out), 0.5 * distance(out_base));
  EXPECT_NE(out_base, base);
}

// A share of another number sets in at once, whatever the share: its effect is a step, the evidence that of the effect, and the number is told in the unit of the whole.
TEST(Diagnosis, AnEffectThatSetsInAtOnceIsNamed) {
  const Experiment experiment(0.3, 0, 0, 1, 1);
  ParameterGroup opened = Experiment::groups()[1];
  opened.name = "opened";
  AddedParameter& a = opened.added[0];
  a = added("opened", "strength", 0, 1, {0});
  a.parameter.nominal = 1, a.share_of = "material.mercury.tensile_cutoff", a.whole = 2e5;
  const RunAdded runs = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> which) {
    std::vector<AddedParameter> known(which.begin(), which.end());
    Eigen::MatrixXd with = thetas;
    for (std::size_t k = 0; k < which.size(); ++k) {
      if (which[k].parameter.name != "opened.strength") continue;
      known[k].parameter.name = "echo.strength";
      for (auto& share : with.row(Eigen::Index(2 + k))) share = share < 1 ? 0.3 + 0.005 * share : 0;
    }
    return Experiment::runs()(with, level, known);
  };
  const PosteriorInputs base = experiment.base();
  const auto diagnosed = [&](ParameterGroup group) {
    return diagnose({.base = base, .groups = {Experiment::groups()[0], std::move(group)}, .run = runs, .options = {.leaders = 2}, .say = {}, .round = {}});
  };
  const Diagnosis d = diagnosed(opened);
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("opened")) << d.verdict.reason;
  const Estimate& strength = d.candidates[0].numbers[0];
  EXPECT_GT(strength.mean, 0.1 * a.whole);
  EXPECT_LT(strength.mean, 0.9 * a.whole);
  EXPECT_GT(strength.sd, 0.15 * a.whole) << "the records do not tell the share";
  EXPECT_FALSE(strength.told);
  EXPECT_THAT(plain_number(d.candidates[0], strength, std::vector<ParameterGroup>{opened}).value, ::testing::HasSubstr("the records tell no more"));
  // Control: the same step as a number like any other, whose box holds the base model's runs, is worth less.
  ParameterGroup plain = opened;
  plain.added[0].share_of.clear();
  double other = 0;
  for (const auto& c : diagnosed(plain).candidates)
    if (c.explanation.name == "opened") other = c.explanation.log_bayes_factor;
  EXPECT_LT(other, d.candidates[0].explanation.log_bayes_factor - 5);
}

TEST(Diagnosis, AFaultyGaugeIsItselfNamed) {
  const Diagnosis d = Experiment(0, 0, 0, 1.12, 1).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("sensor_response"));
  EXPECT_EQ(d.candidates[0].sensor, "S2");
  EXPECT_NEAR(d.candidates[0].numbers[0].mean, 0.12, 0.03);
  EXPECT_TRUE(d.candidates[0].settled);
  EXPECT_THAT(d.candidates[0].runs, AllOf(Gt(0), Le(4 * 3))) << "on the base model's emulator: a fit of its own would take 20 and more";
}

// A fault that is as the square of its number, as that of a turned gauge: linearised where the number comes out.
TEST(Diagnosis, AFaultFarFromLinearIsNamedWithItsNumber) {
  const double size = 3, value = -0.2;
  const Experiment experiment(0, 0, 0, 1 + size * value * value, 1);
  const RunAdded runs = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> which) {
    Eigen::MatrixXd with = thetas;
    for (std::size_t k = 0; k < which.size(); ++k)
      if (which[k].parameter.name == "sensor_response.gain")
        for (auto& v : with.row(Eigen::Index(2 + k))) v *= size * v;
    return Experiment::runs()(with, level, which);
  };
  const PosteriorInputs base = experiment.base();
  auto groups = Experiment::groups();
  groups[2].added[0] = added("sensor_response", "gain", -0.3, 0, {-0.1});
  const Diagnosis d = diagnose({.base = base, .groups = std::move(groups), .run = runs, .options = {.leaders = 2}, .say = {}, .round = {}});
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("sensor_response")) << d.verdict.reason;
  const Alternative& named = d.candidates[0];
  EXPECT_EQ(named.sensor, "S2");
  EXPECT_NEAR(named.numbers[0].mean, value, std::max(3 * named.numbers[0].sd, 0.02));
  EXPECT_LT(named.numbers[0].sd, 0.05);
  EXPECT_GT(named.explanation.log_bayes_factor, 10);
}

TEST(Diagnosis, AFaultyGaugeBesideAnEffectIsNamedWithIt) {
  const Diagnosis d = Experiment(0.015, 0, 0, 1.14, 1).diagnosed();
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("echo+sensor_response")) << d.verdict.reason;
  EXPECT_EQ(d.candidates[0].places.at("sensor_response"), "S2");
  for (const auto& n : d.candidates[0].numbers) EXPECT_NEAR(n.mean, n.name == "echo.strength" ? 0.015 : 0.14, n.name == "echo.strength" ? 0.005 : 0.02) << n.name;
}

// Numbers that do much of what a parameter does: told beside the parameters' mode, they take away what chi-squared says they do.
TEST(Diagnosis, ManySmallNumbersFitTheRecordsAsWellAsTheirChiSquaredSays) {
  const double value = 0.08, of_amplitude = 1;
  const Experiment experiment(value, 0, 0, 1, 1);
  const RunAdded runs = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> which) {
    std::vector<AddedParameter> known(which.begin(), which.end());
    Eigen::MatrixXd with = thetas;
    for (std::size_t k = 0; k < which.size(); ++k) known[k].parameter.name = "echo.strength", with.row(0) += of_amplitude * thetas.row(Eigen::Index(2 + k));
    return Experiment::runs()(with, level, known);
  };
  PosteriorInputs base = experiment.base();
  base.discrepancy = false;  // one hypothesis about the errors
  const ParameterGroup left{.name = "left", .added = {added("left", "a_1", -0.4, 0.4, {0.1})}, .linear = true};
  const Diagnosis d = diagnose({.base = base, .groups = {left}, .run = runs, .options = {}, .say = {}, .round = {}});
  const Explanation& e = d.candidates.at(0).explanation;
  EXPECT_LT(e.chi2, 0.2 * d.evidence.chi2);
  EXPECT_LT(e.misfit, 0.35 * d.evidence.misfit);
  EXPECT_NEAR(d.candidates[0].numbers[0].mean, value, 0.02);  // 0.121 where the amplitude was free once more
}

// Many small numbers are one more term of the errors, about where they come out: what they do there has another shape than what they do about zero.
TEST(Diagnosis, ManySmallNumbersAreLinearisedWhereTheyComeOut) {
  const double value = 0.25;
  const auto drift_of = [](double v) { return 6 * v * v; };
  const Experiment experiment(value, drift_of(value), 0, 1, 1);
  const RunAdded runs = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> which) {
    std::vector<AddedParameter> known;
    Eigen::MatrixXd with = thetas.topRows(2);
    for (std::size_t k = 0; k < which.size(); ++k)
      for (const char* name : {"echo.strength", "drift.rate"}) {
        known.emplace_back().parameter.name = name;
        with.conservativeResize(with.rows() + 1, Eigen::NoChange);
        for (Eigen::Index i = 0; i < with.cols(); ++i) {
          const double v = thetas(Eigen::Index(2 + k), i);
          with(with.rows() - 1, i) = *name == 'e' ? v : drift_of(v);
        }
      }
    return Experiment::runs()(with, level, known);
  };
  const PosteriorInputs base = experiment.base();
  const ParameterGroup left{.name = "left", .added = {added("left", "a_1", -0.4, 0.4, {0.1})}, .linear = true};
  const Diagnosis d = diagnose({.base = base, .groups = {left}, .run = runs, .options = {}, .say = {}, .round = {}});
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("left")) << d.verdict.reason;
  const Alternative& named = d.candidates[0];
  EXPECT_NEAR(named.numbers[0].mean, value, 3 * named.numbers[0].sd);
  EXPECT_LT(named.numbers[0].sd, 0.02);
  EXPECT_TRUE(named.settled);
  EXPECT_GT(named.runs, 0);
}

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

TEST(Diagnosis, WhatNobodyOffersIsUnknown) {
  const Diagnosis d = Experiment(0, 0, 0.3, 1, 1).diagnosed();
  EXPECT_EQ(d.verdict.kind, VerdictKind::unknown) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, IsEmpty());
  EXPECT_EQ(d.base_history.size(), d.held_out_history.size());
}

// What is missing is described by the terms that would do it, and not where something is named or nothing is missing.
TEST(Diagnosis, WhatIsMissingIsDescribedByTheTermsThatWouldDoIt) {
  const auto folder = scratch("diagnosis_missing");
  const Diagnosis d = Experiment(0.2, 0, 0.3, 1, 1).diagnosed(folder, {Experiment::groups()[0]});
  ASSERT_EQ(d.verdict.kind, VerdictKind::unknown) << d.verdict.reason;
  ASSERT_TRUE(d.missing);
  ASSERT_EQ(d.missing->terms.size(), 2u);
  for (const auto& t : d.missing->terms) {
    EXPECT_NEAR(t.value, t.what == "foreignness" ? 0.3 : 0.2, 4 * t.sd + 0.01) << t.what;
    EXPECT_GT(t.log_bayes_factor, 5);
  }
  EXPECT_LT(d.missing->misfit_after, 0.3 * d.missing->misfit_before);
  EXPECT_EQ(d.missing->asked, 2u);
  const Json json = read_json(folder / "diagnosis.json");
  EXPECT_EQ(json["missing"]["terms"].size(), 2u);
  EXPECT_THAT(json["missing"]["sentence"].get<std::string>(), ::testing::AllOf(::testing::HasSubstr("acts like a change of"), ::testing::HasSubstr("at the end"), ::testing::HasSubstr("not a name")));

  const Diagnosis spent = Experiment(0, 0, 0.3, 1, 1).diagnosed({}, Experiment::groups(), {.leaders = 2, .term_runs = 4});
  EXPECT_FALSE(spent.missing);
  EXPECT_THAT(spent.skipped, ::testing::Contains(::testing::HasSubstr("what is missing: its terms take 5 runs")));
}

TEST(Diagnosis, SaysSoWhereNoTermDoesWhatIsMissing) {
  MissingTerms none{.asked = 135};
  EXPECT_EQ(plain_missing(none), "None of 135 simple terms, each in a part of the mercury or on a stretch of a wall, would do what is missing.");
  const MissingTerm mass{.what = "mass", .place = "on the top wall", .unit = "kg/m^2", .value = -4.5, .sd = 0.7}, share{.what = "bulk modulus", .place = "in all of the mercury", .unit = "", .value = 0.031, .sd = 0.004};
  EXPECT_EQ(plain_term(mass), "-4.50 ± 0.70 kg/m²");
  EXPECT_EQ(plain_term(share), "+3.10 ± 0.40 %");
  MissingTerms told{.terms = {mass}, .asked = 135, .misfit_before = 0.05, .misfit_after = 0.04};
  EXPECT_EQ(plain_missing(told),
            "What is missing acts like a change of mass by -4.50 ± 0.70 kg/m² on the top wall. With it a run leaves a misfit of 4.0 %, where the base model leaves 5.0 %. This describes an effect and its place; it is not a name.");
  told.misfit_after = 0.06;
  EXPECT_THAT(plain_missing(told), ::testing::HasSubstr("a run with it does not come nearer to the records (a misfit of 6.0 %, where the base model leaves 5.0 %)"));
  told.misfit_before = told.misfit_after = 0;  // it failed
  EXPECT_THAT(plain_missing(told), ::testing::HasSubstr("no run with it came through"));
}

TEST(Diagnosis, TwoConcealedEffectsAreNamedTogether) {
  const Diagnosis d = Experiment(0.3, 0.25, 0, 1, 1).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << d.verdict.reason;
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("drift+echo"));
  EXPECT_THAT(d.candidates[0].groups, ElementsAre("drift", "echo"));
  ASSERT_EQ(d.candidates[0].numbers.size(), 2u);
  for (const auto& n : d.candidates[0].numbers) EXPECT_NEAR(n.mean, n.name == "echo.strength" ? 0.3 : 0.25, 4 * n.sd + 0.003) << n.name;
}

// The evidence of a mechanism that may act on several places is the mean over them.
TEST(Ask, DividesEvidenceBetweenPlaces) {
  const Experiment experiment(0.04, 0, 0, 1, 1);
  const RunAdded smooth = Experiment::runs(0);  // the numerical noise of a run depends on how many numbers are added
  const PosteriorInputs base = [&] {
    PosteriorInputs in = experiment.base();
    in.run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return Experiment::runs()(thetas, level, {}); };
    return in;
  }();
  const PosteriorFit fit = fit_posterior(base);
  const auto best = [&](const std::vector<ParameterGroup>& groups) {
    return ask({.fit = fit, .problem = experiment.problem, .groups = groups, .level = 1, .run = smooth}).questions[0];
  };
  const ParameterGroup echo = Experiment::groups()[1], drift = Experiment::groups()[0];
  ParameterGroup alike = echo, useless = drift, third = drift;
  alike.place = "b", useless.name = third.name = "echo", useless.place = "c", third.place = "d";
  const double alone = best({echo}).worth.log_bayes_factor;
  ASSERT_GT(alone, 5);
  EXPECT_NEAR(best({echo, alike}).worth.log_bayes_factor, alone, 1e-3);
  const Question one_of_three = best({useless, echo, third});
  EXPECT_NEAR(one_of_three.worth.log_bayes_factor, alone - std::log(3), 1e-3);
  EXPECT_NEAR(one_of_three.choice, -std::log(3), 1e-3);
}

/// log density of a Gaussian of this covariance, up to the constant of its dimension.
double log_gaussian(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance) {
  const Cholesky factor(covariance);
  return -0.5 * factor.solve_lower(x).squaredNorm() - factor.half_log_determinant();
}

// The evidence of a linear Gaussian model under two hypotheses about the errors, by dense covariances of the records.
TEST(FirstOrderModel, IsTheEvidenceOfTheLinearModel) {
  const PosteriorFit fit = Experiment(0, 0, 0, 1, 4).diagnosed().base;
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Eigen::MatrixXd> covariances{fit.hypotheses[0].errors.covariance(), fit.hypotheses[4].errors.covariance()};
  const std::vector<double> weights{0.7, 0.3};
  std::vector<RecordErrors> errors;
  for (const std::size_t i : {0, 1}) errors.push_back({covariances[i], fit.errors->data(), infinity, std::log(weights[i])});
  const LogPosterior posterior(fit.posterior->box(), fit.posterior->emulator(), fit.coefficients, errors, fit.noise, fit.posterior->priors(), fit.posterior->beyond_prior());
  const LocalMode mode = find_modes(posterior, {fit.modes[0].q}).at(0);

  const auto n = Eigen::Index(fit.errors->data().size());
  AddedDirections d{.by_number = Eigen::MatrixXd(n, 2), .prior_sd = Eigen::Vector2d(0.2, 1.5)};
  for (Eigen::Index i = 0; i < n; ++i) d.by_number(i, 0) = 2e-5 * std::sin(0.07 * double(i)), d.by_number(i, 1) = 1e-5 * std::cos(0.021 * double(i));
  const Eigen::MatrixXd scaled = d.by_number * d.prior_sd.asDiagonal();

  const auto density = posterior.density(mode.at);
  const std::size_t likeliest = posterior.likeliest(mode.at);
  const Eigen::MatrixXd j = posterior.jacobian(mode.at), whitened = posterior.whiten(j, mode.at, likeliest);
  const SymmetricEigen left = symmetric_eigen(inverse_symmetric(mode.covariance) - whitened.transpose() * whitened);
  const Eigen::MatrixXd prior = left.vectors * left.values.cwiseMax(3.0).cwiseInverse().asDiagonal() * left.vectors.transpose();
  const FirstOrderModel model(posterior, mode);
  const Eigen::VectorXd change = d.by_number * Eigen::Vector2d(0.1, -0.2);
  const auto expected = model.expected(model.block({.by_number = change, .prior_sd = Eigen::VectorXd::Ones(1)}), 0, model.block(d));
  for (const double strength : {0.0, 1.0, 10.0}) {
    const Eigen::VectorXd c = strength * change;
    std::array<double, 2> with{}, without{};
    for (const std::size_t i : {0, 1}) {
      const Eigen::MatrixXd s = covariances[i] + density.variance * fit.noise, first = covariances[0] + density.variance * fit.noise;
      const double common = std::log(weights[i]) - 0.5 * inverse_symmetric(s).cwiseProduct(first).sum();
      const Eigen::MatrixXd base = s + j * prior * j.transpose();
      without[i] = common + log_gaussian(c, base), with[i] = common + log_gaussian(c, base + scaled * scaled.transpose());
    }
    const auto log_sum = [](const std::array<double, 2>& x) { return std::max(x[0], x[1]) + std::log1p(std::exp(-std::abs(x[0] - x[1]))); };
    const double exact = log_sum(with) - log_sum(without);
    EXPECT_NEAR(expected.log_bayes_factor(strength), exact, 1e-6 * std::max(1.0, std::abs(exact))) << strength;
    if (strength == 10.0) {
      EXPECT_GT(exact, 10);
    }
  }
  // Of the records themselves, which lie on the model: the numbers are nothing, within what is said of them.
  const FirstOrder worth = model.worth(d);
  EXPECT_LT(worth.log_bayes_factor, 0);
  for (const Eigen::Index k : {0, 1}) EXPECT_LT(std::abs(worth.value[k]), 4 * worth.sd[k]);
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

TEST(FalseDiscovery, IsThatOfBenjaminiAndYekutieli) {
  // p.adjust(c(0.001, 0.01, 0.02, 0.5), "BY") of R: 4 (1 + 1/2 + 1/3 + 1/4) p / rank, from above.
  const double c = 4 * (1 + 1.0 / 2 + 1.0 / 3 + 1.0 / 4);
  const auto q = false_discovery({0.02, 0.001, 0.5, 0.01});
  EXPECT_NEAR(q[1], 0.001 * c, 1e-12);
  EXPECT_NEAR(q[3], 0.01 * c / 2, 1e-12);
  EXPECT_NEAR(q[0], 0.02 * c / 3, 1e-12);
  EXPECT_NEAR(q[2], 1, 1e-12);
}

}  // namespace
}  // namespace calomel
