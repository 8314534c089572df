// The diagnosis of models that are formulas: nothing missing, one effect concealed, one faulty gauge, an effect that nobody offers.
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
#include "uq/posterior_moments.hpp"

namespace calomel {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Le;
using ::testing::UnorderedElementsAre;

TEST(Diagnosis, NothingMissingIsNone) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Diagnosis d = Experiment(0, 0, 0, 1, seed).diagnosed();
    EXPECT_EQ(d.verdict.kind, VerdictKind::none) << described(d.verdict);
    EXPECT_DOUBLE_EQ(d.hold_out.after, d.hold_out.before);
    EXPECT_EQ(shown_explanation(d), nullptr);
    EXPECT_FALSE(d.missing);
    // Numbers are reported under the likelihood to the power that the evidences are taken to.
    const LogPosterior& posterior = *d.base.fit.posterior;
    const Moments sharp = sampled_moments(posterior, d.base.mode(), 1), weak = sampled_moments(posterior.to_the_power(0.5), d.base.mode(), 1);
    EXPECT_GT(weak.sd[1], 1.2 * sharp.sd[1]);
    EXPECT_GT(d.base.parameters[1].sd, 0.95 * weak.sd[1]);
    EXPECT_NEAR(d.base.parameters[1].mean, weak.mean[1], 0.1 * weak.sd[1]);
  }
}

// Two conditions of three gauges each.
TEST(Diagnosis, AConditionIsPredictedByTheOthersBetterWithWhatIsNamed) {
  const std::vector<std::string> powers{"low", "high"};
  const auto folder = scratch("diagnosis_conditions");
  const Diagnosis d = Experiment(0.3, 0, 0, 1, 1, powers).diagnosed(folder);
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("echo")) << described(d.verdict);
  ASSERT_EQ(d.hold_out.conditions.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(d.hold_out.conditions[c].name, powers[c]);
    EXPECT_LT(d.hold_out.conditions[c].after, 0.5 * d.hold_out.conditions[c].before);
  }
  EXPECT_EQ(read_json(folder / "diagnosis.json").at("conditions")[1].at("name"), "high");
  const Diagnosis none = Experiment(0, 0, 0, 1, 1, powers).diagnosed();
  for (const auto& c : none.hold_out.conditions) EXPECT_EQ(c.after, c.before);
  EXPECT_THAT(Experiment(0, 0, 0, 1, 1).diagnosed().hold_out.conditions, IsEmpty());
}

TEST(Diagnosis, AConcealedEffectIsNamedAndGivesTheBaseParametersBack) {
  const auto folder = scratch("diagnosis_artefacts");
  const Experiment experiment(0.3, 0, 0, 1, 1);
  const Diagnosis d = experiment.diagnosed(folder);
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << described(d.verdict);
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("echo"));
  EXPECT_FALSE(d.missing);
  const Alternative& c = d.candidates[0];
  ASSERT_EQ(c.numbers.size(), 1u);
  EXPECT_NEAR(c.numbers[0].mean, 0.3, 3 * c.numbers[0].sd + 0.003);
  EXPECT_NEAR(c.base_parameters[1].mean, 0.985, 3 * c.base_parameters[1].sd + 0.002);
  EXPECT_LT(d.hold_out.after, 0.6 * d.hold_out.before);
  const auto& w = d.location.windows;
  EXPECT_GT(std::max_element(w.begin(), w.end(), [](const auto& a, const auto& b) { return a.score < b.score; })->begin, 40e-6);  // the echo comes after 50 us
  EXPECT_LT(d.location.sensors[0].q_value, 0.05);
  // The location is the first place on the map where the mismatch is more than chance.
  double first = 1;
  for (Eigen::Index i = 0; i < d.location.map_q_values.rows(); ++i)
    for (Eigen::Index k = 0; k < d.location.map_q_values.cols(); ++k)
      if (d.location.map_q_values(i, k) < 0.05) first = std::min(first, w[std::size_t(k)].begin);
  EXPECT_DOUBLE_EQ(first, d.location.first_time);

  // Its artefacts: the words where they belong, the misfit of every gauge, the handbook, the histories.
  const Json json = read_json(folder / "diagnosis.json");
  EXPECT_EQ(json["finding"], "finding");
  EXPECT_EQ(json["reason"], "reason");
  EXPECT_EQ(json["separating_measurement"], "separating measurement");
  EXPECT_EQ(json["summary"], json["finding"].get<std::string>() + ' ' + json["next_step"].get<std::string>());
  double held_out = 0, before = 0;
  ASSERT_EQ(json["gauges"].size(), sensors);
  for (const auto& g : json["gauges"]) {
    EXPECT_LT(g["after"].get<double>(), g["before"].get<double>()) << g["name"];
    held_out += g["heldout_before"].get<double>() / double(sensors);
    before += g["before"].get<double>() / double(sensors);
  }
  EXPECT_NEAR(held_out, d.hold_out.before, 1e-6);  // the mean over the gauges is the rule's own number
  EXPECT_NEAR(before, json["fit"]["before"]["compared_nrmse"].get<double>(), 1e-12);
  EXPECT_EQ(json["base_parameters"]["handbook"]["speed"], (Json{{"mean", 1.0}, {"sd", 0.03}}));
  EXPECT_EQ(json["location"]["map_q_values"].size(), sensors);
  for (const auto& r : json["ranking"]) EXPECT_EQ(r["why"], "why of " + r["name"].get<std::string>());
  EXPECT_GT(json["ranking"][0]["explained"].get<double>(), 0.5);

  const NetcdfReader file(folder / "diagnosis.nc");
  EXPECT_EQ(file.attribute("explanation"), "echo");
  const auto base = file.doubles("base"), explained = file.doubles("explained"), out = file.doubles("held_out_explained"),
             out_base = file.doubles("held_out_base"), mean = file.doubles("record_mean");
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

// The effect of a share of another number sets in at once, whatever the share. It is a step, the evidence is that of the effect, and the number is reported in
// the unit of the whole.
TEST(Diagnosis, AnEffectThatSetsInAtOnceIsNamed) {
  const Experiment experiment(0.3, 0, 0, 1, 1);
  ParameterGroup opened = Experiment::groups()[1];
  opened.name = "opened";
  AddedParameter& a = opened.added[0];
  a = added("opened", "strength", 0, 1, {0});
  a.parameter.nominal = 1;
  a.share_of = "material.mercury.tensile_cutoff";
  a.whole = 2e5;
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
    return diagnose({.base = base, .groups = {Experiment::groups()[0], std::move(group)}, .run = runs, .options = {.leaders = 2}, .report = {}, .round = {}});
  };
  const Diagnosis d = diagnosed(opened);
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("opened")) << described(d.verdict);
  const Estimate& strength = d.candidates[0].numbers[0];
  EXPECT_GT(strength.mean, 0.1 * a.whole);
  EXPECT_LT(strength.mean, 0.9 * a.whole);
  EXPECT_GT(strength.sd, 0.15 * a.whole) << "the records do not narrow the share";
  EXPECT_FALSE(strength.from_records);
  // Control: the same step as a number like any other, whose box holds the base model's runs, has less evidence.
  ParameterGroup plain = opened;
  plain.added[0].share_of.clear();
  double other = 0;
  for (const auto& c : diagnosed(plain).candidates)
    if (c.explanation.name == "opened") other = c.explanation.log_bayes_factor;
  EXPECT_LT(other, d.candidates[0].explanation.log_bayes_factor - 5);
}

TEST(Diagnosis, AFaultyGaugeIsItselfNamed) {
  const Diagnosis d = Experiment(0, 0, 0, 1.12, 1).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << described(d.verdict);
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("sensor_response"));
  EXPECT_EQ(d.candidates[0].sensor, "S2");
  EXPECT_NEAR(d.candidates[0].numbers[0].mean, 0.12, 0.03);
  EXPECT_TRUE(d.candidates[0].settled);
  EXPECT_THAT(d.candidates[0].runs, AllOf(Gt(0), Le(4 * 3))) << "on the base model's emulator: a fit of its own would take 20 and more";
}

// Such a gauge leads the fit astray: the diagnosis ends after the runs that a box begins with, and screens no mechanism.
TEST(Diagnosis, EndsIfChannelsAreMixedUp) {
  const auto folder = scratch("diagnosis_mixed_up");
  for (const double gain : {-1.0, 0.1}) {
    const Diagnosis d = Experiment(0.25, 0, 0, gain, 21).diagnosed(folder);
    ASSERT_EQ(d.base.mislabelled.size(), 1u);
    EXPECT_EQ(d.base.mislabelled[0].gauge, "S2");
    EXPECT_EQ(d.verdict.kind, VerdictKind::unknown);
    EXPECT_THAT(d.candidates, IsEmpty());
    EXPECT_EQ(d.runs, 24 + 10);
    const Json json = read_json(folder / "diagnosis.json");
    EXPECT_EQ(json["mixed_up"][0]["gauge"], "S2");
    EXPECT_EQ(json["mixed_up"][0]["text"], "mislabelled S2");
    ASSERT_EQ(d.skipped.size(), 1u);
    EXPECT_EQ(d.skipped[0].kind, SkippedStep::Kind::mechanisms);
  }
}

TEST(Diagnosis, GoesOnWithoutADeadGauge) {
  const Diagnosis d = Experiment(0.25, 0, 0, 0, 21).diagnosed();
  EXPECT_THAT(d.dead, ElementsAre("S2"));
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("echo")) << described(d.verdict);
  // Where nothing is missing, the likeliest fault would be that of the gauge that is left out, because no record speaks against it.
  const Diagnosis none = Experiment(0, 0, 0, 0, 1).diagnosed();
  EXPECT_EQ(none.verdict.kind, VerdictKind::none) << described(none.verdict);
  const auto gauge = std::find_if(none.candidates.begin(), none.candidates.end(), [](const auto& c) { return !c.sensor.empty(); });
  ASSERT_NE(gauge, none.candidates.end());
  EXPECT_NE(gauge->sensor, "S2");
}

// A fault that is as the square of its number, like that of a turned gauge, is linearised about its estimate.
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
  const Diagnosis d = diagnose({.base = base, .groups = std::move(groups), .run = runs, .options = {.leaders = 2}, .report = {}, .round = {}});
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("sensor_response")) << described(d.verdict);
  const Alternative& named = d.candidates[0];
  EXPECT_EQ(named.sensor, "S2");
  EXPECT_NEAR(named.numbers[0].mean, value, std::max(3 * named.numbers[0].sd, 0.02));
  EXPECT_LT(named.numbers[0].sd, 0.05);
  EXPECT_GT(named.explanation.log_bayes_factor, 10);
}

TEST(Diagnosis, AFaultyGaugeBesideAnEffectIsNamedWithIt) {
  const Diagnosis d = Experiment(0.015, 0, 0, 1.14, 1).diagnosed();
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("echo+sensor_response")) << described(d.verdict);
  EXPECT_EQ(d.candidates[0].places.at("sensor_response"), "S2");
  for (const auto& n : d.candidates[0].numbers)
    EXPECT_NEAR(n.mean, n.name == "echo.strength" ? 0.015 : 0.14, n.name == "echo.strength" ? 0.005 : 0.02) << n.name;
}

// The numbers have nearly the effect of a parameter. Estimated beside the parameters' mode, they take away as much of chi-squared as is reported.
TEST(Diagnosis, ManySmallParametersFitTheRecordsAsWellAsTheirChiSquared) {
  const double value = 0.08, of_amplitude = 1;
  const Experiment experiment(value, 0, 0, 1, 1);
  const RunAdded runs = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> which) {
    std::vector<AddedParameter> known(which.begin(), which.end());
    Eigen::MatrixXd with = thetas;
    for (std::size_t k = 0; k < which.size(); ++k) {
      known[k].parameter.name = "echo.strength";
      with.row(0) += of_amplitude * thetas.row(Eigen::Index(2 + k));
    }
    return Experiment::runs()(with, level, known);
  };
  PosteriorInputs base = experiment.base();
  base.discrepancy = false;  // one hypothesis about the errors
  const ParameterGroup left{.name = "left", .added = {added("left", "a_1", -0.4, 0.4, {0.1})}, .linear = true};
  const Diagnosis d = diagnose({.base = base, .groups = {left}, .run = runs, .options = {}, .report = {}, .round = {}});
  const Explanation& e = d.candidates.at(0).explanation;
  EXPECT_LT(e.chi2, 0.2 * d.base.evidence.chi2);
  EXPECT_LT(e.misfit, 0.35 * d.base.evidence.misfit);
  EXPECT_NEAR(d.candidates[0].numbers[0].mean, value, 0.02);  // 0.121 where the amplitude was free once more
}

// Many small numbers are one more term of the errors about their estimate, where their effect has another shape than about zero.
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
  const Diagnosis d = diagnose({.base = base, .groups = {left}, .run = runs, .options = {}, .report = {}, .round = {}});
  ASSERT_THAT(d.verdict.mechanisms, ElementsAre("left")) << described(d.verdict);
  const Alternative& named = d.candidates[0];
  EXPECT_NEAR(named.numbers[0].mean, value, 3 * named.numbers[0].sd);
  EXPECT_LT(named.numbers[0].sd, 0.02);
  EXPECT_TRUE(named.settled);
  EXPECT_GT(named.runs, 0);
}

// They are followed after all fits, and only where they could still lead. Alone they are followed; beside the echo that was concealed they cost no runs.
TEST(Diagnosis, ManySmallNumbersThatCannotLeadCostNoRuns) {
  const ParameterGroup left{.name = "left", .added = {added("drift", "rate", -1, 1, {0.1})}, .linear = true};
  const Experiment experiment(0.3, 0.12, 0, 1, 1);
  const Diagnosis alone = experiment.diagnosed({}, {left});
  ASSERT_NE(alone.alternative("left"), nullptr);
  EXPECT_GT(alone.alternative("left")->runs, 0) << alone.alternative("left")->explanation.log_bayes_factor;
  const Diagnosis beside = experiment.diagnosed({}, {left, Experiment::groups()[1]});
  ASSERT_NE(beside.alternative("left"), nullptr);
  EXPECT_EQ(beside.alternative("left")->runs, 0);
  EXPECT_GT(beside.alternative("echo")->explanation.log_bayes_factor, beside.alternative("left")->explanation.log_bayes_factor + 20);
}

TEST(Diagnosis, AnEffectThatNobodyOffersIsUnknown) {
  const Diagnosis d = Experiment(0, 0, 0.3, 1, 1).diagnosed();
  EXPECT_EQ(d.verdict.kind, VerdictKind::unknown) << described(d.verdict);
  EXPECT_THAT(d.verdict.mechanisms, IsEmpty());
  EXPECT_EQ(d.base.history.size(), d.hold_out.history.size());
}

// The terms describe what is missing, and are not screened where something is named or nothing is missing.
TEST(Diagnosis, TermsDescribeWhatIsMissing) {
  const auto folder = scratch("diagnosis_missing");
  const Diagnosis d = Experiment(0.2, 0, 0.3, 1, 1).diagnosed(folder, {Experiment::groups()[0]});
  ASSERT_EQ(d.verdict.kind, VerdictKind::unknown) << described(d.verdict);
  ASSERT_TRUE(d.missing);
  ASSERT_EQ(d.missing->terms.size(), 2u);
  for (const auto& t : d.missing->terms) {
    EXPECT_NEAR(t.value, t.what == "foreignness" ? 0.3 : 0.2, 4 * t.sd + 0.01) << t.what;
    EXPECT_GT(t.log_bayes_factor, 5);
  }
  EXPECT_LT(d.missing->misfit_after, 0.3 * d.missing->misfit_before);
  EXPECT_EQ(d.missing->screened, 2u);
  const Json json = read_json(folder / "diagnosis.json");
  EXPECT_EQ(json["missing"]["terms"].size(), 2u);
  EXPECT_EQ(json["missing"]["terms"][0]["value"], "change of " + d.missing->terms[0].what);
  EXPECT_EQ(json["missing"]["sentence"], "missing");
  EXPECT_THAT((std::vector{d.missing->terms[0].place, d.missing->terms[1].place}), UnorderedElementsAre("at the end", "everywhere"));

  const Diagnosis spent = Experiment(0, 0, 0.3, 1, 1).diagnosed({}, Experiment::groups(), {.leaders = 2, .term_runs = 4});
  EXPECT_FALSE(spent.missing);
  ASSERT_FALSE(spent.skipped.empty());
  EXPECT_EQ(spent.skipped.back(), (SkippedStep{.kind = SkippedStep::Kind::missing_terms, .runs = 5, .limit = 4}));
}

TEST(Diagnosis, TwoConcealedEffectsAreNamedTogether) {
  const Diagnosis d = Experiment(0.3, 0.25, 0, 1, 1).diagnosed();
  ASSERT_EQ(d.verdict.kind, VerdictKind::named) << described(d.verdict);
  EXPECT_THAT(d.verdict.mechanisms, ElementsAre("drift+echo"));
  EXPECT_THAT(d.candidates[0].groups, ElementsAre("drift", "echo"));
  ASSERT_EQ(d.candidates[0].numbers.size(), 2u);
  for (const auto& n : d.candidates[0].numbers) EXPECT_NEAR(n.mean, n.name == "echo.strength" ? 0.3 : 0.25, 4 * n.sd + 0.003) << n.name;
}

}  // namespace
}  // namespace calomel
