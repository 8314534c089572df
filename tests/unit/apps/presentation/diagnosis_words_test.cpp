// What people are told of a verdict: every kind, every gate, every reason.
#include "apps/presentation/diagnosis_words.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "apps/presentation/diagnosis_reasons.hpp"
#include "base/random.hpp"

namespace calomel {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

AddedParameter number(const std::string& name, const std::string& unit, double off, const std::string& doc) {
  AddedParameter a;
  a.parameter = {.name = name, .key = "mechanism." + name, .min = -1, .max = 1};
  a.parameter.nominal = off, a.unit = unit, a.doc = doc;
  return a;
}

std::vector<ParameterGroup> groups() {
  AddedParameter filter = number("sensor_response.low_pass", "Hz", 0, "-3 dB frequency");
  filter.inverse = true;
  return {{.name = "beam_profile",
           .added = {number("beam_profile.offset_z", "m", 0, "of the axis, upwards"), number("beam_profile.width_ratio_z", "", 1, "of the width")},
           .plain = "the proton beam's profile",
           .check = "compare it with the beam monitors"},
          {.name = "wall_thinning",
           .place = "top",
           .added = {number("wall_thinning.fraction", "", 0, "of the thickness that is gone")},
           .plain = "a wall that is thinner than drawn",
           .check = "measure that wall"},
          {.name = "sensor_response",
           .added = {number("sensor_response.gain", "", 1, "reading per true strain"), filter},
           .by_sensor = true,
           .plain = "the response of the gauges",
           .check = "check the gauges"},
          {.name = "numerics", .added = {number("numerics.hourglass", "", 0, "")}, .numerical = true, .plain = "the simulation's own discretisation"},
          {.name = "novel", .added = {number("novel.strength", "", 0, "")}}};
}

Alternative beam() {
  Alternative a;
  a.explanation = {.name = "beam_profile",
                   .log_bayes_factor = 106,
                   .by_scale = {{0, 0.5, 108}, {0.08, 0.5, 98}},
                   .chi2 = 70,
                   .misfit = 0.05,
                   .farthest = 1,
                   .base_prior_deviation = 0.3,
                   .fitted = true};
  a.groups = {"beam_profile"};
  a.numbers = {{"beam_profile.width_ratio_z", 0.99, 0.02}, {"beam_profile.offset_z", 2.312e-3, 1.61e-4}};
  a.held_out = {0.12, 0.06};
  return a;
}

Alternative wall(double log_bayes_factor) {
  Alternative a;
  a.explanation = {.name = "wall_thinning",
                   .log_bayes_factor = log_bayes_factor,
                   .by_scale = {{0, 0.5, log_bayes_factor - 1}, {0.08, 0.5, log_bayes_factor - 0.5}},
                   .chi2 = 300,
                   .misfit = 0.08,
                   .base_prior_deviation = 1,
                   .fitted = true};
  a.groups = {"wall_thinning"}, a.places = {{"wall_thinning", "top"}};
  a.numbers = {{"wall_thinning.fraction", 0.12, 0.04}};
  return a;
}

/// A judged diagnosis, all fits of which have settled; the base model's chi-squared is 400 for 100 values.
Diagnosis judged(std::vector<Alternative> candidates, double base_chi2 = 400) {
  for (auto& c : candidates) c.settled = true;
  Diagnosis d;
  d.base.fit.settled = true;
  d.base.evidence = {
      .values = 100, .chi2 = base_chi2, .misfit = 0.1, .held_out = 0.1, .by_scale = {{0, 0.5, -1}, {0.08, 0.5, -0.5}}, .base_prior_deviation = 0.5};
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.explanation.log_bayes_factor > b.explanation.log_bayes_factor; });
  d.candidates = std::move(candidates);
  std::vector<Explanation> all;
  for (const auto& c : d.candidates) all.push_back(c.explanation);
  d.verdict = judge(d.base.evidence, all);
  d.location.first_sensor = "S03", d.location.first_time = 120e-6;
  d.separating = SeparatingMeasurement{
      .first = "beam_profile", .second = "wall_thinning", .gauge = "S07", .time = 210e-6, .difference = 3.2, .unit = "microstrain", .standard_deviations = 4.6};
  return d;
}

PlainSummary told(Diagnosis d, const VerdictMisfits& m = {.before = 0.112, .after = 0.053, .held_out_before = 0.121, .held_out_after = 0.0604}) {
  d.misfits = m;
  return plain_summary(d, groups());
}

// Many numbers of one kind say nothing one by one.
TEST(PlainWords, ManySmallNumbersAreToldTogether) {
  Alternative a;
  a.explanation.name = "left", a.groups = {"left"};
  a.numbers = {{"left.a_1", 0.03, 0.01}, {"left.a_2", 0, 0.01}, {"left.a_3", -0.04, 0.01}};
  const std::vector<ParameterGroup> many{
      {.name = "left", .added = {number("left.a_1", "", 0, ""), number("left.a_2", "", 0, ""), number("left.a_3", "", 0, "")}, .linear = true}};
  EXPECT_EQ(plain_size(a, many), "a_1 to a_3 together 0.05 (root of the sum of squares) in place of 0");
}

TEST(PlainWords, ANamedMechanismIsToldWithWhatItMendsAndWhatToDo) {
  const Diagnosis d = judged({beam(), wall(8)});
  ASSERT_EQ(d.verdict.kind, VerdictKind::named);
  const auto s = told(d);
  EXPECT_EQ(s.finding,
            "The simulation leaves something out: the proton beam's profile (beam_profile); with it the misfit of the records falls from 11 % to 5.3 %, and on "
            "gauges that were left out of the fit from 12 % to 6.0 %.");
  EXPECT_EQ(s.next_step,
            "Compare it with the beam monitors; if that agrees, make it part of the model ([mechanism.beam_profile], enabled = true, with the numbers found) "
            "and calibrate again.");
  EXPECT_EQ(s.text(), s.finding + ' ' + s.next_step);
}

TEST(PlainWords, ItSaysWhereHeldOutGaugesDoNotGain) {
  const Diagnosis d = judged({beam()});
  EXPECT_THAT(told(d, {.before = 0.1, .after = 0.05, .held_out_before = 0.12, .held_out_after = 0.13}).finding,
              HasSubstr("but on gauges that were left out of the fit it does not fall (12 % to 13 %)"));
  Alternative untried = beam();
  untried.held_out.clear();
  EXPECT_THAT(told(judged({untried})).finding, AllOf(Not(HasSubstr("left out of the fit")), EndsWith("falls from 11 % to 5.3 %.")));
}

TEST(PlainWords, ItSaysWhyTheRecordsThatWereFittedMayBeNoNearer) {
  EXPECT_THAT(told(judged({beam()}), {.before = 0.037, .after = 0.04, .held_out_before = 0.054, .held_out_after = 0.041}).finding,
              HasSubstr("with it the misfit of gauges that were left out of the fit falls from 5.4 % to 4.1 % (that of the records that were fitted goes from "
                        "3.7 % to 4.0 %: without it the base parameters had bent to them)."));
}

TEST(PlainWords, AFaultyGaugeIsCalledByItsName) {
  Alternative a = beam();
  a.explanation.name = "sensor_response", a.groups = {"sensor_response"}, a.sensor = "S02", a.numbers = {{"S02.sensor_response.gain", 1.12, 0.013}},
  a.held_out.clear();
  const auto s = told(judged({a}));
  EXPECT_THAT(s.finding, StartsWith("Gauge S02 does not read true (sensor_response: gain 1.120 ± 0.013 in place of 1), and the simulation explains the records "
                                    "once that is allowed for"));
  EXPECT_THAT(s.next_step, HasSubstr("recordings.exclude"));
  EXPECT_EQ(plain_name(a, groups()), "a fault of gauge S02");
}

TEST(PlainWords, APairIsToldAsTwo) {
  Alternative a = beam();
  a.explanation.name = "beam_profile+wall_thinning", a.groups = {"beam_profile", "wall_thinning"}, a.places = {{"beam_profile", ""}, {"wall_thinning", "top"}};
  const auto s = told(judged({a}));
  EXPECT_THAT(s.finding, HasSubstr("the proton beam's profile, together with a wall that is thinner than drawn (top) (beam_profile+wall_thinning)"));
  EXPECT_THAT(s.next_step, StartsWith("Compare it with the beam monitors and measure that wall; if that agrees, make it part of the model "
                                      "([mechanism.beam_profile] and [mechanism.wall_thinning]"));
}

TEST(PlainWords, AStretchIsToldAsItWasFitted) {
  const std::vector<Estimate> numbers{{"wall_thinning.fraction", 0.1, 0.01}, {"wall_thinning.begin", 0.0103, 1e-3}, {"wall_thinning.end", 0.02547, 1e-3}};
  EXPECT_EQ(fitted_place("wall_thinning", "front, 14.2 to 23.8 mm", numbers), "front, 10.3 to 25.5 mm");
  EXPECT_EQ(fitted_place("wall_thinning", "front", numbers), "front, 10.3 to 25.5 mm");
  EXPECT_EQ(fitted_place("interface", "top", numbers), "top");
}

TEST(PlainWords, WithoutWordsAMechanismKeepsItsOwnName) {
  Alternative a = beam();
  a.explanation.name = "novel", a.groups = {"novel"}, a.numbers = {};
  const auto s = told(judged({a}));
  EXPECT_THAT(s.finding, StartsWith("The simulation leaves something out: novel;"));
  EXPECT_THAT(s.next_step, StartsWith("Make it part of the model"));
}

TEST(PlainWords, NoneClaimsNoMoreThanTheErrorsAllow) {
  Alternative weak = wall(2);
  const Diagnosis d = judged({weak}, 66);
  ASSERT_EQ(d.verdict.kind, VerdictKind::none);
  const auto s = told(d);
  EXPECT_THAT(s.finding,
              AllOf(HasSubstr("explains these records within what is known of their errors (misfit 11 %)"), HasSubstr("nothing that they could show")));
  EXPECT_THAT(s.next_step, HasSubstr("smaller effects"));
}

TEST(PlainWords, AmbiguousNamesAllAndWhatTellsThemApart) {
  Alternative near = wall(109 - 0.9 * Gates{}.lead);  // 108 without a discrepancy, less
  near.explanation.chi2 = 80;
  const Diagnosis d = judged({beam(), near});
  ASSERT_EQ(d.verdict.kind, VerdictKind::ambiguous);
  const auto s = told(d);
  EXPECT_THAT(s.finding,
              HasSubstr("do not tell whether it is the proton beam's profile (beam_profile) or a wall that is thinner than drawn (top) (wall_thinning)"));
  EXPECT_EQ(s.next_step, "To tell them apart: " + separating_text(d.separating) + '.');
}

TEST(PlainWords, UnknownSaysWhyAndWhereToLook) {
  const auto finding = [&](const Alternative& a) {
    const Diagnosis d = judged({a});
    EXPECT_EQ(d.verdict.kind, VerdictKind::unknown);
    return told(d);
  };
  Alternative a = beam();
  a.explanation.log_bayes_factor = 0.8 * Gates{}.log_bayes_factor;
  EXPECT_THAT(finding(a).finding,
              AllOf(HasSubstr("(misfit 11 %)"), HasSubstr("nothing that was tried is sure enough to be named: the proton beam's profile comes nearest")));
  EXPECT_THAT(finding(a).next_step, HasSubstr("Look first at gauge S03 from 120 µs on, where the mismatch is first seen"));
  a.explanation.log_bayes_factor = 1;
  EXPECT_THAT(finding(a).finding, HasSubstr("none of the effects that were tried is it"));
  a = beam(), a.explanation.chi2 = 300;
  EXPECT_THAT(finding(a).finding, HasSubstr("the proton beam's profile comes nearest, but accounts for only 30 % of the mismatch"));  // 100 of 335
  a = beam(), a.explanation.chi2 = 140, a.explanation.by_scale = {{0, 0.5, 98}, {0.08, 0.5, 108}};
  EXPECT_THAT(finding(a).finding, HasSubstr("with it the records are still not explained"));
  a = beam(), a.explanation.farthest = 4;
  EXPECT_THAT(finding(a).finding,
              HasSubstr("stronger than is plausible (offset_z 2.31 ± 0.16 mm in place of 0 mm and width_ratio_z 0.990 ± 0.020 in place of 1)"));
  a = beam(), a.explanation.base_prior_deviation = 3;
  EXPECT_THAT(finding(a).finding, HasSubstr("farther from the handbook"));
  a = beam(), a.explanation.name = "numerics", a.groups = {"numerics"}, a.explanation.numerical = true;
  EXPECT_THAT(finding(a).finding, HasSubstr("own discretisation accounts for it better than any physics"));
  EXPECT_THAT(finding(a).next_step, HasSubstr("emulator.element_sizes"));
  a.explanation.log_bayes_factor = 106 - 0.9 * Gates{}.lead;
  for (auto& s : a.explanation.by_scale) s.log_evidence -= 0.9 * Gates{}.lead;
  const Diagnosis rival = judged({beam(), a});
  EXPECT_EQ(rival.verdict.kind, VerdictKind::unknown);
  EXPECT_THAT(told(rival).finding, HasSubstr("own discretisation does so nearly as well"));
  EXPECT_THAT(told(judged({})).finding, HasSubstr("none of the effects that were tried"));
  Diagnosis one_place = judged({});
  one_place.base.evidence.local = 12, one_place.base.likeliest_place = {"S03", "S04"};
  EXPECT_THAT(told(one_place).next_step, HasSubstr("first seen (it shows near gauges S03 and S04 alone): something"));
  one_place.base.likeliest_place = {"S04"};
  EXPECT_THAT(told(one_place).next_step, HasSubstr("(it shows near gauge S04 alone: see whether it reads true)"));
  one_place.base.evidence.local = 3;
  EXPECT_THAT(told(one_place).next_step, Not(HasSubstr("alone")));
}

TEST(PlainWords, NothingIsToBeActedOnBeforeTheFitThatItHangsOnSettled) {
  Diagnosis d = judged({beam()});
  d.base.fit.settled = false;  // it wanders where physics is left out
  EXPECT_THAT(d.unsettled(), ::testing::IsEmpty());
  EXPECT_THAT(told(d).text(), Not(HasSubstr("Do not act")));
  d.candidates[0].settled = false;
  EXPECT_THAT(d.unsettled(), ElementsAre("beam_profile"));
  EXPECT_THAT(told(d).finding, HasSubstr("the proton beam's profile"));
  EXPECT_THAT(told(d).next_step, StartsWith("Do not act on this yet: the fit of the proton beam's profile (beam_profile) has not settled"));

  Diagnosis none = judged({}, 90);
  EXPECT_THAT(none.unsettled(), ::testing::IsEmpty());
  none.base.fit.settled = false;
  EXPECT_THAT(none.unsettled(), ElementsAre("base"));
  EXPECT_THAT(told(none).next_step, StartsWith("Do not act on this yet: the fit of the base model has not settled"));
}

TEST(PlainWords, WhereRunsWereSpentBeforeASecondEffectWasTriedUnknownSaysSo) {
  Alternative half = beam();
  half.explanation.chi2 = 200, half.explanation.by_scale = {{0, 0.5, 30}, {0.08, 0.5, 98}};
  Diagnosis d = judged({half});
  ASSERT_EQ(d.verdict.kind, VerdictKind::unknown);
  EXPECT_THAT(d.unsettled(), ::testing::IsEmpty());
  d.budget_exhausted = true;
  EXPECT_THAT(d.unsettled(), ElementsAre("beam_profile"));
  EXPECT_THAT(told(d).finding, HasSubstr("no runs were left to look for a second effect beside it"));
  EXPECT_THAT(told(d).next_step, HasSubstr("diagnosis.max_runs"));
  d.candidates[0].explanation.of_two = true;  // the pair itself leaves it: more runs do not help
  EXPECT_THAT(d.unsettled(), ::testing::IsEmpty());
}

// The words repeat the gates of judge(); over random evidences they must agree with it.
TEST(PlainWords, TheGateThatIsNotPassedAgreesWithTheVerdict) {
  RandomStream random(3, 0);
  int named = 0, unknown = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const auto by_scale = [&] {
      return EvidenceByScale{{0, 0.2, 60 * random.uniform()}, {0.02, 0.3, 60 * random.uniform()}, {0.08, 0.5, 60 * random.uniform()}};
    };
    const BaseEvidence base{.values = 100,
                            .chi2 = 150 + 400 * random.uniform(),
                            .misfit = 0.1,
                            .held_out = 0.1,
                            .by_scale = by_scale(),
                            .base_prior_deviation = 2 * random.uniform()};
    std::vector<Explanation> all;
    for (int i = 0; i < 3; ++i)
      all.push_back({.name = std::string(1, char('a' + i)),
                     .numerical = random.uniform() < 0.2,
                     .log_bayes_factor = 150 * random.uniform(),
                     .by_scale = by_scale(),
                     .chi2 = 60 + 200 * random.uniform(),
                     .misfit = 0.12 * random.uniform(),
                     .farthest = 4 * random.uniform(),
                     .base_prior_deviation = 2 * random.uniform(),
                     .fitted = true});
    sort_by_evidence(base, all);
    const Verdict v = judge(base, all);
    const Gate gate = gate_not_passed(base, all, 0);
    EXPECT_EQ(gate == Gate::passed, v.kind == VerdictKind::named || v.kind == VerdictKind::ambiguous);
    named += gate == Gate::passed, unknown += v.kind == VerdictKind::unknown;
  }
  EXPECT_GT(named, 100);
  EXPECT_GT(unknown, 100);
}

TEST(PlainWords, EveryEntryOfTheRankingHasAReason) {
  Alternative small = wall(Gates{}.log_bayes_factor / 1.44), none = wall(0), unfitted = wall(0), failed = wall(0), rival = wall(60);
  none.explanation.name = none.groups[0] = "none_of_it", unfitted.explanation.name = unfitted.groups[0] = "unfitted",
  failed.explanation.name = failed.groups[0] = "failed", rival.explanation.name = rival.groups[0] = "rival";
  unfitted.explanation.fitted = failed.explanation.fitted = false;
  unfitted.first_order_log_bayes_factor = 6;
  unfitted.status.kind = FitStatus::Kind::first_order;
  failed.status = {.kind = FitStatus::Kind::failed, .message = "no run came through"};
  const Diagnosis d = judged({beam(), small, none, unfitted, failed, rival});
  ASSERT_EQ(d.verdict.kind, VerdictKind::named);
  for (const auto& r : d.verdict.ranking) {
    const Why w = why(d, r.name, groups());
    EXPECT_FALSE(w.why.empty()) << r.name;
    EXPECT_FALSE(w.would_change.empty()) << r.name;
  }
  EXPECT_EQ(why(d, "beam_profile", groups()).why,
            "Named: it accounts for 99 % of the mismatch with a log Bayes factor of 106, and the evidence of the next, rival, lies 49 below its own.");
  EXPECT_THAT(why(d, "wall_thinning", groups()).why, HasSubstr("too weakly: a log Bayes factor of"));
  EXPECT_THAT(why(d, "wall_thinning", groups()).would_change, HasSubstr("about 1.2 times as large"));  // the root of 1.44
  EXPECT_THAT(why(d, "none_of_it", groups()).why, HasSubstr("Nothing in these records speaks for it"));
  EXPECT_THAT(why(d, "unfitted", groups()).would_change, HasSubstr("diagnosis.leaders"));
  EXPECT_EQ(why(d, "failed", groups()).why, "Its fit failed: no run came through.");
  EXPECT_EQ(why(d, "rival", groups()).why, "The proton beam's profile explains the records better (evidence 108 against 59).");
  EXPECT_THAT(why(d, "none", groups()).why,
              HasSubstr("by more than is known of their errors (chi-squared 400 for 100 values, where up to 135.8 is plausible)"));
  EXPECT_THAT(why(judged({}, 66), "none", groups()).why, HasSubstr("by no more than is known"));
}

TEST(PlainWords, NumbersHaveUnitsThatAPersonWouldUse) {
  const auto value = [](const std::string& unit, double off, double mean, double sd, bool inverse = false, double max = 1) {
    std::vector<ParameterGroup> g{{.name = "g", .added = {number("g.x", unit, off, "")}}};
    g[0].added[0].inverse = inverse, g[0].added[0].parameter.max = max;
    Alternative a;
    a.groups = {"g"};
    const PlainNumber n = plain_number(a, {"g.x", mean, sd}, g);
    return n.value + " | " + n.off;
  };
  EXPECT_EQ(value("m", 0, 2.312e-3, 1.61e-4), "2.31 ± 0.16 mm | 0 mm");
  EXPECT_EQ(value("m", 0, 1.37e-5, 3.4e-6), "13.7 ± 3.4 µm | 0 µm");
  EXPECT_EQ(value("s", 7e-7, 9.5e-7, 1.2e-7), "0.95 ± 0.12 µs | 0.7 µs");
  EXPECT_EQ(value("Pa", 0, 1.234e5, 2e4), "0.123 ± 0.020 MPa | 0 MPa");
  EXPECT_EQ(value("Pa s", 0, 812, 95), "812 ± 95 Pa s | 0 Pa s");
  EXPECT_EQ(value("", 0, 3.2e-7, 1.1e-8), "3.20e-07 ± 1.1e-08 | 0");
  EXPECT_EQ(value("", 0, 1.0029878, 3.64e-5), "1.002988e+00 ± 3.6e-05 | 0");  // as many digits as tell it from 1
  EXPECT_EQ(value("", 1, 0.94, 0), "0.94 | 1");
  EXPECT_EQ(value("Hz", 0, 1 / 50e3, 1 / 500e3, true), "50.0 ± 5.0 kHz | none");
  EXPECT_EQ(value("Hz", 0, 1e-6, 2e-6, true), "above 200 kHz | none");  // 1 / (1e-6 + 4e-6)
  EXPECT_EQ(value("Pa", 0, -1 / 98e3, 1e-7, true, 0), "-98.00 ± 0.96 kPa | none");
}

// What no physics explains comes before what is left out.
TEST(PlainSummary, BeginsWithGaugesThatLookWiredWrongly) {
  Diagnosis d = judged({beam()});
  d.base.mislabelled = {{.gauge = "T2", .other = "", .own = -0.98, .like = 0.98}, {.gauge = "T3", .other = "B1", .own = 0.31, .like = 0.96}};
  EXPECT_THAT(plain_summary(d, groups()).next_step, AllOf(StartsWith("Gauge T2 reads what is simulated there with the other sign (correlation -0.98)"),
                                                          HasSubstr("Gauge T3 reads what is simulated at B1"), HasSubstr("run the diagnosis again")));
}

}  // namespace
}  // namespace calomel
