// The two sentences of a verdict: every kind, every gate that the leading explanation may fail, and what comes before them.
#include "apps/presentation/diagnosis_words.hpp"

#include <gmock/gmock.h>

#include "apps/presentation/data_check_words.hpp"
#include "tests/unit/apps/presentation/judged_diagnosis.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

PlainSummary summary_of(const Diagnosis& d) { return plain_summary(d, judged_groups()); }

const std::string look =
    "Look first at gauge S03 from 120 µs on, where the mismatch is first significant. An effect outside the catalogue may be missing, such as a part of the "
    "geometry, or several effects at once. Until it is found, do not use calibrated values as properties of the material.";
const std::string nearest_beam =
    "The simulation leaves something out (misfit 11 %), and the cause is unknown. The nearest explanation is the proton beam's profile";

TEST(DiagnosisWords, ANamedMechanismHasItsEffectOnTheMisfitAndTheNextStep) {
  const Diagnosis d = judged({beam(), wall(8)});
  ASSERT_EQ(d.verdict.kind, VerdictKind::named);
  const auto s = summary_of(d);
  EXPECT_EQ(
      s.finding,
      "The simulation leaves something out: the proton beam's profile (beam_profile). With it the misfit of the records falls from 11 % to 5.3 %, and that "
      "of gauges that were left out of the fit from 12 % to 6.0 %.");
  EXPECT_EQ(
      s.next_step,
      "Compare it with the beam monitors. If that agrees, make it part of the model ([mechanism.beam_profile], enabled = true, with the numbers found) and "
      "calibrate again.");
  EXPECT_EQ(s.text(), s.finding + ' ' + s.next_step);
}

TEST(DiagnosisWords, HeldOutRecordsMayNotGain) {
  Diagnosis d = judged({beam()});
  d.misfits = {.before = 0.1, .after = 0.05, .held_out_before = 0.12, .held_out_after = 0.13};
  EXPECT_EQ(
      summary_of(d).finding,
      "The simulation leaves something out: the proton beam's profile (beam_profile). With it the misfit of the records falls from 10 % to 5.0 %, but that "
      "of gauges that were left out of the fit does not fall (12 % to 13 %).");
  d.misfits.single_record = true;
  EXPECT_EQ(
      summary_of(d).finding,
      "The simulation leaves something out: the proton beam's profile (beam_profile). With it the misfit of the records falls from 10 % to 5.0 %, but that "
      "of stretches of the record that were left out of the fit does not fall (12 % to 13 %).");
  Alternative untried = beam();
  untried.held_out.clear();
  EXPECT_EQ(summary_of(judged({untried})).finding,
            "The simulation leaves something out: the proton beam's profile (beam_profile). With it the misfit of the records falls from 11 % to 5.3 %.");
}

TEST(DiagnosisWords, TheFittedRecordsMayNotGain) {
  Diagnosis d = judged({beam()});
  d.misfits = {.before = 0.037, .after = 0.04, .held_out_before = 0.054, .held_out_after = 0.041};
  EXPECT_EQ(
      summary_of(d).finding,
      "The simulation leaves something out: the proton beam's profile (beam_profile). With it the misfit of gauges that were left out of the fit falls from "
      "5.4 % to 4.1 %. That of the fitted records goes from 3.7 % to 4.0 %, because without it the base parameters had adapted to them.");
}

TEST(DiagnosisWords, AFaultyGaugeIsCalledByItsName) {
  Alternative a = beam();
  a.explanation.name = "sensor_response";
  a.groups = {"sensor_response"};
  a.sensor = "S02";
  a.numbers = {{"S02.sensor_response.gain", 1.12, 0.013}};
  a.held_out.clear();
  const auto s = summary_of(judged({a}));
  EXPECT_EQ(
      s.finding,
      "Gauge S02 does not read true (sensor_response: gain 1.120 ± 0.013 in place of 1). With that allowed for, the misfit of the records falls from 11 % "
      "to 5.3 %.");
  EXPECT_EQ(s.next_step,
            "Check the calibration, amplifier, clock and orientation of gauge S02, or leave it out (recordings.exclude). Then run the diagnosis again.");
  a.other_sensors = {"S03", "S05"};
  EXPECT_EQ(
      summary_of(judged({a})).finding,
      "Gauge S02 does not read true (sensor_response: gain 1.120 ± 0.013 in place of 1). With that allowed for, the misfit of the records falls from 11 % "
      "to 5.3 %. The records do not show whether the fault is at this gauge or at S03 or S05.");
}

TEST(DiagnosisWords, APairIsTwo) {
  Alternative a = beam();
  a.explanation.name = "beam_profile+wall_thinning";
  a.groups = {"beam_profile", "wall_thinning"};
  a.places = {{"beam_profile", ""}, {"wall_thinning", "top"}};
  const auto s = summary_of(judged({a}));
  EXPECT_EQ(
      s.finding,
      "The simulation leaves something out: the proton beam's profile, together with a wall that is thinner than drawn (top) (beam_profile+wall_thinning). "
      "With it the misfit of the records falls from 11 % to 5.3 %, and that of gauges that were left out of the fit from 12 % to 6.0 %.");
  EXPECT_EQ(s.next_step,
            "Compare it with the beam monitors and measure that wall. If that agrees, make it part of the model ([mechanism.beam_profile] and "
            "[mechanism.wall_thinning], enabled = true, with the numbers found) and calibrate again.");
}

TEST(DiagnosisWords, AMechanismWithoutWordsKeepsItsOwnName) {
  Alternative a = beam();
  a.explanation.name = "novel";
  a.groups = {"novel"};
  a.numbers = {};
  const auto s = summary_of(judged({a}));
  EXPECT_EQ(
      s.finding,
      "The simulation leaves something out: novel. With it the misfit of the records falls from 11 % to 5.3 %, and that of gauges that were left out of the "
      "fit from 12 % to 6.0 %.");
  EXPECT_EQ(s.next_step, "Make it part of the model ([mechanism.novel], enabled = true, with the numbers found) and calibrate again.");
}

TEST(DiagnosisWords, NoneClaimsNoMoreThanTheErrorsAllow) {
  const Diagnosis d = judged({wall(2)}, 66);
  ASSERT_EQ(d.verdict.kind, VerdictKind::none);
  const auto s = summary_of(d);
  EXPECT_EQ(s.finding, "The simulation explains these records within their known errors (misfit 11 %). They show no effect that was left out.");
  EXPECT_EQ(s.next_step, "Calibrate with the model as it is. More pulses, or gauges whose places are better known, would show smaller effects.");
}

TEST(DiagnosisWords, AmbiguousListsAllAndTheMeasurementThatDistinguishesThem) {
  Alternative near = wall(109 - 0.9 * Gates{}.lead);  // 108 without a discrepancy, less
  near.explanation.chi2 = 80;
  const Diagnosis d = judged({beam(), near});
  ASSERT_EQ(d.verdict.kind, VerdictKind::ambiguous);
  const auto s = summary_of(d);
  EXPECT_EQ(
      s.finding,
      "The simulation leaves something out, and these records do not show whether it is the proton beam's profile (beam_profile) or a wall that is thinner "
      "than drawn (top) (wall_thinning). With the first of them the misfit of the records goes from 11 % to 5.3 %.");
  EXPECT_EQ(s.next_step,
            "To distinguish them: beam_profile and wall_thinning differ most at gauge S07 at about 210 µs, by 3.2 microstrain (4.6 standard deviations of the "
            "errors there); more pulses, or a second gauge beside it, would distinguish them best.");
}

TEST(DiagnosisWords, AMeasurementMayDistinguishTheBaseModelOrNothing) {
  SeparatingMeasurement m = *judged({}).separating;
  m.second.clear();
  EXPECT_EQ(separating_text(m),
            "beam_profile and the base model differ most at gauge S07 at about 210 µs, by 3.2 microstrain (4.6 standard deviations of the errors there); more "
            "pulses, or a second gauge beside it, would distinguish them best");
  EXPECT_EQ(separating_text({}), "nothing was fitted that a further measurement could distinguish");
}

/// The sentences of "unknown", for the one explanation that leads.
PlainSummary unknown(const Alternative& a) {
  const Diagnosis d = judged({a});
  EXPECT_EQ(d.verdict.kind, VerdictKind::unknown);
  return summary_of(d);
}

TEST(DiagnosisWords, UnknownNamesTheGateThatTheNearestExplanationFails) {
  Alternative a = beam();
  a.explanation.log_bayes_factor = 0.8 * Gates{}.log_bayes_factor;
  EXPECT_EQ(unknown(a).finding,
            "The simulation leaves something out (misfit 11 %), and no effect has enough evidence to be named. The nearest explanation is the proton beam's "
            "profile.");
  EXPECT_EQ(unknown(a).next_step, look);
  a = beam();
  a.explanation.fitted = false;
  EXPECT_EQ(unknown(a).finding, nearest_beam + ", which was estimated to first order and not fitted.");
  EXPECT_EQ(unknown(a).next_step,
            "Run the diagnosis again with --fresh and a greater diagnosis.leaders or diagnosis.max_runs. The runs that were made are kept.");
  a = beam();
  a.explanation.chi2 = 300;
  EXPECT_EQ(unknown(a).finding, nearest_beam + ", but it accounts for only 30 % of the mismatch.");  // 100 of 335
  a = beam();
  a.explanation.chi2 = 140;
  a.explanation.by_scale = {{0, 0.5, 98}, {0.08, 0.5, 108}};
  EXPECT_EQ(unknown(a).finding, nearest_beam + ", but with it the records are still not explained.");
  a = beam();
  a.explanation.by_scale = {{0, 0.5, 100}, {0.08, 0.5, 101.5}};
  EXPECT_EQ(unknown(a).finding, nearest_beam + ", but its probability of 49 % is not enough for a name.");
  a = beam();
  a.explanation.misfit = 0.1;
  EXPECT_EQ(unknown(a).finding, nearest_beam + ". It has the evidence, but with it the misfit of the records does not fall.");
  a = beam();
  a.explanation.held_out = 0.1;
  EXPECT_EQ(unknown(a).finding, nearest_beam +
                                    ". It has the evidence, but the misfit of records that were left out of the fit falls too little with it. It may imitate "
                                    "another effect.");
  a = beam();
  a.explanation.farthest = 4;
  EXPECT_EQ(unknown(a).finding,
            nearest_beam +
                ". It would explain the records, but only if it were stronger than is plausible (offset_z 2.31 ± 0.16 mm in place of 0 mm and "
                "width_ratio_z 0.990 ± 0.020 in place of 1).");
  EXPECT_EQ(unknown(a).next_step, "Find out whether it can be that strong. If not, look at gauge S03 from 120 µs on, where the mismatch is first significant.");
  a = beam();
  a.explanation.base_prior_deviation = 3;
  EXPECT_EQ(unknown(a).finding, nearest_beam + ". It would explain the records, but only with material properties farther from the handbook than without it.");
}

TEST(DiagnosisWords, UnknownMayBeTheDiscretisation) {
  const std::string finer = "Repeat the diagnosis on finer meshes (emulator.element_sizes) before any physics is blamed.";
  EXPECT_EQ(
      unknown(numerics()).finding,
      "The simulation and the records differ (misfit 11 %), but the simulation's own discretisation explains the difference better than any physics that was "
      "tried.");
  EXPECT_EQ(unknown(numerics()).next_step, finer);
  const Diagnosis competing = judged({beam(), numerics(0.9 * Gates{}.lead)});
  EXPECT_EQ(competing.verdict.kind, VerdictKind::unknown);
  EXPECT_EQ(summary_of(competing).finding,
            "The simulation and the records differ (misfit 11 %). An effect, the proton beam's profile, would explain the difference, but the simulation's own "
            "discretisation explains it nearly as well.");
  EXPECT_EQ(summary_of(competing).next_step, finer);
}

TEST(DiagnosisWords, UnknownMayHaveNoExplanationAtAll) {
  const std::string nothing = "The simulation leaves something out (misfit 11 %), and none of the effects that were tried explains it.";
  Alternative a = beam();
  a.explanation.log_bayes_factor = 1;
  EXPECT_EQ(unknown(a).finding, nothing);
  EXPECT_EQ(summary_of(judged({})).finding, nothing);
}

TEST(DiagnosisWords, UnknownNamesThePlaceToInvestigate) {
  const std::string rest =
      " An effect outside the catalogue may be missing, such as a part of the geometry, or several effects at once. Until it is found, do not use calibrated "
      "values as properties of the material.";
  Diagnosis d = judged({});
  d.base.evidence.local = 12;
  d.base.likeliest_place = {"S03", "S04"};
  const std::string first = "Look first at gauge S03 from 120 µs on, where the mismatch is first significant.";
  EXPECT_EQ(summary_of(d).next_step, first + " The mismatch shows near gauges S03 and S04 alone." + rest);
  d.base.likeliest_place = {"S04"};
  EXPECT_EQ(summary_of(d).next_step, first + " The mismatch shows near gauge S04 alone, so check whether that gauge reads true." + rest);
  d.base.evidence.local = 3;
  EXPECT_EQ(summary_of(d).next_step, first + rest);
  d.location.first_time = 0;
  EXPECT_EQ(summary_of(d).next_step, "Look first at gauge S03, which shows the mismatch from the start." + rest);
  d.location.first_sensor.clear();
  EXPECT_EQ(summary_of(d).next_step, "Look first at the gauges with the greatest mismatch." + rest);
  d.location.sensors.resize(2);
  d.location.sensors[0].name = "S01";
  d.location.sensors[1].name = "S02";
  d.location.sensors[1].score = 3;
  EXPECT_EQ(summary_of(d).next_step, "Look first at gauge S02, where the mismatch is greatest." + rest);
}

TEST(DiagnosisWords, NothingIsToBeActedOnBeforeTheFitThatDecidesHasSettled) {
  Diagnosis d = judged({beam()});
  const std::string settled = summary_of(d).text();
  d.base.fit.settled = false;  // it wanders where physics is left out
  EXPECT_THAT(d.unsettled(), IsEmpty());
  EXPECT_EQ(summary_of(d).text(), settled);
  d.candidates[0].settled = false;
  EXPECT_THAT(d.unsettled(), ElementsAre("beam_profile"));
  EXPECT_EQ(summary_of(d).finding, summary_of(judged({beam()})).finding);
  EXPECT_EQ(
      summary_of(d).next_step,
      "Do not act on this yet, because the fit of the proton beam's profile (beam_profile) has not settled. Run the diagnosis again with --fresh and more "
      "rounds, or more runs a round (emulator.rounds, emulator.round_fine). The runs that were made are kept.");

  Diagnosis none = judged({}, 90);
  EXPECT_THAT(none.unsettled(), IsEmpty());
  none.base.fit.settled = false;
  none.budget_exhausted = true;
  EXPECT_THAT(none.unsettled(), ElementsAre("base"));
  EXPECT_EQ(
      summary_of(none).next_step,
      "Do not act on this yet, because the fit of the base model has not settled. Run the diagnosis again with --fresh and more runs (diagnosis.max_runs). "
      "The runs that were made are kept.");
}

TEST(DiagnosisWords, UnknownReportsThatRunsWereUsedUpBeforeASecondEffectWasTried) {
  const std::string more = "Run the diagnosis again with --fresh and more runs (diagnosis.max_runs). The runs that were made are kept.";
  Alternative half = beam();
  half.explanation.chi2 = 200;
  half.explanation.by_scale = {{0, 0.5, 30}, {0.08, 0.5, 98}};
  Diagnosis d = judged({half});
  ASSERT_EQ(d.verdict.kind, VerdictKind::unknown);
  EXPECT_THAT(d.unsettled(), IsEmpty());
  d.budget_exhausted = true;
  EXPECT_THAT(d.unsettled(), ElementsAre("beam_profile"));
  EXPECT_EQ(
      summary_of(d).finding,
      "The simulation and the records differ. The nearest explanation, the proton beam's profile (beam_profile), leaves a part of the difference. No runs "
      "were left to look for a second effect beside it.");
  EXPECT_EQ(summary_of(d).next_step, more);
  d.candidates[0].explanation.of_two = true;  // the pair itself leaves it: more runs do not help
  EXPECT_THAT(d.unsettled(), IsEmpty());
  Alternative unfitted = beam();
  unfitted.explanation.fitted = false;
  Diagnosis first_order = judged({unfitted});
  first_order.budget_exhausted = true;
  EXPECT_EQ(
      summary_of(first_order).finding,
      "The simulation and the records differ. The nearest explanation to first order, the proton beam's profile (beam_profile), was not fitted, because no "
      "runs were left.");
  EXPECT_EQ(summary_of(first_order).next_step, more);
}

// Mistakes that no physics explains come before physics that is left out.
TEST(DiagnosisWords, DataThatAreNotInOrderComeFirst) {
  const std::string end = "Then run the diagnosis again. Until the data are in order, no verdict on physics holds.";
  Diagnosis d = judged({beam()});
  d.base.mislabelled = {{.gauge = "T2", .other = "", .own = -0.98, .like = 0.98}, {.gauge = "T3", .other = "B1", .own = 0.31, .like = 0.96}};
  EXPECT_EQ(summary_of(d).finding, "The simulation and the records differ (misfit 11 %), but channels appear to be mixed up, so no mechanism was tried.");
  EXPECT_EQ(
      summary_of(d).next_step,
      "The record of gauge T2 has the opposite sign of its simulation (correlation -0.98). Check its wiring and its direction in the case. The record of "
      "gauge T3 is like the simulation at B1, and that of B1 like the simulation at T3 (correlation 0.96; 0.31 with its own). Check whether the two channels "
      "are swapped. " +
          end);
  d.base.mislabelled.clear();
  d.clock = ClockOffset{.delay = 3.07e-6, .sd = 0.12e-6, .log_bayes_factor = 75.6};
  d.dead = {"S09"};
  EXPECT_EQ(summary_of(d).finding, summary_of(judged({beam()})).finding);
  EXPECT_EQ(summary_of(d).next_step,
            "All records look 3.07 ± 0.12 µs late (log Bayes factor 75.6 to first order). Check the instant from which they count, and set "
            "recordings.trigger_offset; where the instant is not known, set errors.trigger_sd. " +
                end + ' ' + dead_gauges_sentence(d.dead));
}

TEST(DiagnosisWords, MissingTermsAreAHintAndNoName) {
  MissingTerms m{.screened = 135};
  EXPECT_EQ(missing_sentence(m), "None of 135 simple terms, each in a part of the mercury or on a stretch of a wall, would reproduce the missing effect.");
  const MissingTerm mass{.what = "mass", .place = "on the top wall", .unit = "kg/m^2", .value = -4.5, .sd = 0.7},
      share{.what = "bulk modulus", .place = "in all of the mercury", .unit = "", .value = 0.031, .sd = 0.004};
  m = {.terms = {mass}, .screened = 135, .misfit_before = 0.05, .misfit_after = 0.04};
  EXPECT_EQ(
      missing_sentence(m),
      "What is missing acts like a change of mass by -4.50 ± 0.70 kg/m² on the top wall. A run with it has a misfit of 4.0 %, and the base model has 5.0 %. "
      "This describes an effect and its place; it names no cause.");
  m.misfit_after = 0.06;
  EXPECT_EQ(
      missing_sentence(m),
      "What is missing acts like a change of mass by -4.50 ± 0.70 kg/m² on the top wall. This was estimated for a small effect: a run with it has a misfit of "
      "6.0 %, and the base model has 5.0 %. Take it as a hint of the place at most.");
  m = {.terms = {mass, share}, .screened = 135};  // the run failed
  EXPECT_EQ(
      missing_sentence(m),
      "What is missing acts like a change of mass by -4.50 ± 0.70 kg/m² on the top wall and of bulk modulus by +3.10 ± 0.40 % in all of the mercury. This "
      "was estimated for a small effect, and the run with them failed: take it as a hint.");
}

TEST(DiagnosisWords, EveryPartOfADiagnosisHasItsWords) {
  Diagnosis d = judged({beam(), wall(8)});
  d.base.mislabelled = {{.gauge = "T2", .other = "", .own = -0.98, .like = 0.98}};
  d.clock = ClockOffset{.delay = 3e-6, .sd = 1e-7, .log_bayes_factor = 70};
  d.missing = MissingTerms{.terms = {{.what = "mass", .unit = "kg/m^2", .value = 4.5, .sd = 0.7}}, .screened = 3, .offered = 3};
  d.skipped = {{.kind = SkippedStep::Kind::no_effect, .name = "novel"}};
  const DiagnosisText text = diagnosis_text(d, judged_groups());
  EXPECT_EQ(text.summary(), summary_of(d).text());
  EXPECT_FALSE(text.reason.empty());
  EXPECT_EQ(text.separating_measurement, separating_text(d.separating));
  EXPECT_EQ(text.mislabelled.size(), 1u);
  EXPECT_FALSE(text.clock.empty());
  EXPECT_EQ(text.missing, missing_sentence(*d.missing));
  EXPECT_THAT(text.missing_terms, ElementsAre("+4.50 ± 0.70 kg/m²"));
  EXPECT_EQ(text.skipped.size(), 1u);
  ASSERT_EQ(text.ranking.size(), d.verdict.ranking.size());
  for (std::size_t i = 0; i < text.ranking.size(); ++i) {
    EXPECT_FALSE(text.ranking[i].why.empty()) << d.verdict.ranking[i].name;
    const Alternative* a = d.alternative(d.verdict.ranking[i].name);
    EXPECT_EQ(text.ranking[i].numbers.size(), a ? a->numbers.size() : 0) << d.verdict.ranking[i].name;
    EXPECT_EQ(text.ranking[i].plain_name.empty(), a == nullptr) << d.verdict.ranking[i].name;
  }
}

}  // namespace
}  // namespace calomel
