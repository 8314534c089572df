// The reason of a verdict, and of every entry of its ranking.
#include "apps/presentation/diagnosis_reasons.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "tests/unit/apps/presentation/judged_diagnosis.hpp"

namespace calomel {
namespace {

std::string reason_of(std::vector<Alternative> candidates, double base_chi2 = 400) { return verdict_reason_text(judged(std::move(candidates), base_chi2)); }

TEST(VerdictReason, OfANameIsWhatItExplains) {
  EXPECT_EQ(reason_of({beam(), wall(60)}), "beam_profile explains 99 % of the base model's mismatch (log Bayes factor 106, lead 49)");
}

TEST(VerdictReason, OfNoNameIsTheBaseModelOrTooLittleEvidence) {
  EXPECT_EQ(reason_of({wall(2)}, 66), "the base model explains the records within their errors (chi-squared 66 for 100 values)");
  EXPECT_EQ(reason_of({}), "the base model does not explain the records (chi-squared 400 for 100 values), and no mechanism was offered");
  EXPECT_EQ(
      reason_of({wall(6.5)}),
      "the base model does not explain the records (chi-squared 400 for 100 values), and no explanation has enough evidence: the best, wall_thinning, has a "
      "log Bayes factor of 6.5, below 7");
  Diagnosis mislabelled = judged({});
  mislabelled.base.mislabelled = {{.gauge = "T2"}};
  EXPECT_EQ(verdict_reason_text(mislabelled), "channels appear to be mixed up, and no mechanism was screened");
}

TEST(VerdictReason, OfUnknownIsTheGateThatTheNearestExplanationFails) {
  Alternative a = beam();
  a.explanation.fitted = false;
  EXPECT_EQ(reason_of({a}),
            "beam_profile comes nearest, with a log Bayes factor of 106 to first order, but was not fitted in the true model: raise diagnosis.leaders or "
            "diagnosis.max_runs");
  EXPECT_EQ(reason_of({numerics()}), "numerics, a number of the discretisation, explains the records better than any physics that was offered");
  EXPECT_EQ(reason_of({beam(), numerics(0.9 * Gates{}.lead)}), "numerics, a number of the discretisation, explains the records about as well as beam_profile");
  a = beam();
  a.explanation.chi2 = 300;
  EXPECT_EQ(reason_of({a}), "beam_profile comes nearest, but explains only 30 % of the base model's mismatch");
  a = beam();
  a.explanation.chi2 = 140;
  a.explanation.by_scale = {{0, 0.5, 98}, {0.08, 0.5, 108}};
  EXPECT_EQ(reason_of({a}),
            "beam_profile comes nearest, but with it the records are still not explained: it leaves 22 % of the base model's mismatch (chi-squared 140 for 100 "
            "values)");
  a = beam();
  a.explanation.farthest = 4;
  EXPECT_EQ(reason_of({a}), "beam_profile would explain the records, but only with a number 4 standard deviations from the middle of its prior");
  a.explanation.farthest = std::numeric_limits<double>::infinity();
  EXPECT_EQ(reason_of({a}), "beam_profile would explain the records, but only with a number outside its range");
  a = beam();
  a.explanation.base_prior_deviation = 3;
  EXPECT_EQ(reason_of({a}), "beam_profile would explain the records, but only with base parameters farther from the handbook than without it");
  a = beam();
  a.explanation.by_scale = {{0, 0.5, 100}, {0.08, 0.5, 101.5}};
  EXPECT_EQ(reason_of({a}), "beam_profile comes nearest, but its probability is only 49 %");
}

TEST(VerdictReason, OfUnknownMayBeAPredictionThatFails) {
  Alternative a = beam();
  a.explanation.misfit = 0.1;
  EXPECT_EQ(reason_of({a}), "beam_profile has the evidence, but with it the misfit of the records does not fall: it is 10 % and was 10 %");
  a = beam();
  a.explanation.held_out = 0.095;
  EXPECT_EQ(reason_of({a}),
            "beam_profile has the evidence, but the misfit of gauges that were left out of the fit falls too little: it is 9.5 % and was 10 %, and that of the "
            "records is 5 % and was 10 %");
  a.explanation.held_out = 0.17;
  a.explanation.hold_out_prediction = HoldOutPrediction{.misfit_before = 0.2, .gauges_before = 0.18, .beginning_before = 0.16, .beginning = 0.15};
  EXPECT_EQ(
      reason_of({a}),
      "beam_profile has the evidence, but the misfit of records that were left out of the fit falls too little: that of gauges is 17 % and was 18 %, and that "
      "of the first quarter of all records is 15 % and was 16 %");
  a.explanation.held_out.reset();  // no gauge was held out
  EXPECT_EQ(
      reason_of({a}),
      "beam_profile has the evidence, but the misfit of records that were left out of the fit falls too little: that of the first quarter of all records is "
      "15 % and was 16 %");
}

Why why_of(const Diagnosis& d, const std::string& name) { return why(d, name, judged_groups()); }
/// For the one explanation of an unknown verdict.
Why why_not(const Alternative& a) { return why_of(judged({a}), a.explanation.name); }

Alternative called(const std::string& name, Alternative a) {
  a.explanation.name = name;
  a.groups = {name};
  return a;
}

TEST(Why, EveryEntryOfTheRankingHasAReason) {
  Alternative unfitted = called("unfitted", wall(0)), failed = called("failed", wall(0)), unsupported = called("unsupported", wall(0));
  unfitted.explanation.fitted = false;
  unfitted.first_order_log_bayes_factor = 6;
  unfitted.status.kind = FitStatus::Kind::first_order;
  failed.explanation.fitted = false;
  failed.status = {.kind = FitStatus::Kind::failed, .message = "no run succeeded"};
  unsupported.explanation.fitted = false;
  const Diagnosis d =
      judged({beam(), wall(Gates{}.log_bayes_factor / 1.44), called("none_of_it", wall(0)), unfitted, failed, unsupported, called("other", wall(60))});
  ASSERT_EQ(d.verdict.kind, VerdictKind::named);
  for (const auto& r : d.verdict.ranking) {
    const Why w = why_of(d, r.name);
    EXPECT_FALSE(w.why.empty()) << r.name;
    EXPECT_FALSE(w.would_change.empty()) << r.name;
  }
  EXPECT_EQ(why_of(d, "beam_profile").why,
            "Named: it accounts for 99 % of the mismatch with a log Bayes factor of 106. The evidence of the next explanation, other, is 49 lower.");
  EXPECT_EQ(why_of(d, "beam_profile").would_change, "Another explanation whose evidence comes within 5 of it, or a record that it does not explain.");
  EXPECT_EQ(why_of(d, "wall_thinning").why, "The records support it too weakly: its log Bayes factor is 4.86, and a name needs 7.");
  EXPECT_EQ(why_of(d, "wall_thinning").would_change, "An effect about 1.2 times as large, or errors smaller by that factor.");  // the root of 1.44
  EXPECT_EQ(why_of(d, "none_of_it").why, "Nothing in these records supports it (log Bayes factor 0).");
  EXPECT_EQ(why_of(d, "none_of_it").would_change, "Records in which its effect shows: other gauges, or more pulses.");
  EXPECT_EQ(why_of(d, "unfitted").why,
            "It was estimated to first order only (log Bayes factor 6), because other explanations had more evidence and were fitted.");
  EXPECT_EQ(why_of(d, "unfitted").would_change, "A fit of its own: raise diagnosis.leaders.");
  EXPECT_EQ(why_of(d, "failed").why, "Its fit failed: no run succeeded.");
  EXPECT_EQ(why_of(d, "failed").would_change, "A fit that succeeds.");
  EXPECT_EQ(why_of(d, "unsupported").why, "Nothing in these records supports it.");
  EXPECT_EQ(why_of(d, "other").why, "The proton beam's profile explains the records better (evidence 108 against 59).");
  EXPECT_EQ(why_of(d, "other").would_change, "Records that support it and not the proton beam's profile.");
  EXPECT_EQ(why_of(judged({beam()}), "beam_profile").why,
            "Named: it accounts for 99 % of the mismatch with a log Bayes factor of 106. Nothing else was tried.");
}

TEST(Why, TheBaseModelMayOrMayNotExplainTheRecords) {
  const Diagnosis named = judged({beam()}), none = judged({}, 66), unknown = judged({});
  EXPECT_EQ(why_of(named, "none").why,
            "The base model differs from the records by more than their known errors (chi-squared 400 for 100 values, where up to 135.8 is plausible).");
  EXPECT_EQ(why_of(named, "none").would_change, "Errors larger than those of [errors].");
  EXPECT_EQ(why_of(none, "none").why,
            "The base model differs from the records by no more than their known errors (chi-squared 66 for 100 values, where up to 135.8 is plausible).");
  EXPECT_EQ(why_of(none, "none").would_change, "More pulses or better known gauges: smaller errors show smaller effects.");
  EXPECT_EQ(why_of(named, "unknown").why, "It represents any cause that was not tried.");
  EXPECT_EQ(why_of(named, "unknown").would_change, "A base model that does not explain the records, while no explanation passes the tests.");
  EXPECT_EQ(why_of(unknown, "unknown").why, "The base model does not explain the records, and no explanation that was tried passes every test.");
  EXPECT_EQ(why_of(unknown, "unknown").would_change, "An effect that passes all tests: offer more mechanisms, or add one.");
}

TEST(Why, OfAClassNamesTheOthers) {
  Alternative near = wall(109 - 0.9 * Gates{}.lead);
  near.explanation.chi2 = 80;
  const Diagnosis d = judged({beam(), near});
  EXPECT_EQ(
      why_of(d, "beam_profile").why,
      "It may be the cause: it accounts for 99 % of the mismatch (log Bayes factor 106). These records do not distinguish it from a wall that is thinner than "
      "drawn (top).");
  EXPECT_EQ(why_of(d, "beam_profile").would_change, "A measurement that distinguishes them.");
}

TEST(Why, TheDiscretisationIsNoPhysics) {
  EXPECT_EQ(why_not(numerics()).why, "It is no physics: a number of the simulation's discretisation explains the records.");
  EXPECT_EQ(why_not(numerics()).would_change, "Finer meshes (emulator.element_sizes).");
  const Diagnosis d = judged({beam(), numerics(0.9 * Gates{}.lead)});
  EXPECT_EQ(why_of(d, "beam_profile").why, "A number of the simulation's discretisation explains the records nearly as well.");
}

TEST(Why, AnExplanationMayLeaveTooLargeARemainder) {
  Alternative a = beam();
  a.explanation.chi2 = 300;
  EXPECT_EQ(why_not(a).why, "It accounts for only 30 % of the mismatch. A name that leaves more than chance does has to account for 94 %.");
  EXPECT_EQ(why_not(a).would_change, "A second effect that accounts for the rest.");
  a.explanation.chi2 = 140;
  EXPECT_EQ(
      why_not(a).why,
      "With it the records are still not explained (chi-squared 140 for 100 values, where up to 135.8 is plausible). It leaves 22 % of the mismatch, and a "
      "name may leave 6 %.");
  a.explanation.of_two = true;
  EXPECT_EQ(why_not(a).why,
            "With both mechanisms the records are still not explained (chi-squared 140 for 100 values, where up to 135.8 is plausible): they leave 22 % of the "
            "mismatch. Two mechanisms may leave no more than chance does.");
  EXPECT_EQ(why_not(a).would_change, "Physics that was not offered, which the two imitate together.");
}

TEST(Why, AnExplanationMayPredictTooLittle) {
  Alternative a = beam();
  a.explanation.misfit = 0.1;
  EXPECT_EQ(why_not(a).why, "With it the misfit of the records does not fall: it is 10 %, and 10 % without it.");
  EXPECT_EQ(why_not(a).would_change, "A fit with it that comes nearer to the records.");
  a = beam();
  a.explanation.held_out = 0.095;
  EXPECT_EQ(why_not(a).why, "The misfit of records that were left out of the fit falls too little with it: it is 9.5 %, and 10 % without it.");
  EXPECT_EQ(why_not(a).would_change, "More gauges, so that its predictions can be tested.");
  a.explanation.held_out = 0.17;
  a.explanation.hold_out_prediction = HoldOutPrediction{.misfit_before = 0.2, .gauges_before = 0.18, .beginning_before = 0.16, .beginning = 0.15};
  EXPECT_EQ(
      why_not(a).why,
      "The misfit of records that were left out of the fit falls too little with it: that of gauges is 17 %, and 18 % without it; that of the first quarter of "
      "the records is 15 %, and 16 % without it.");
  EXPECT_EQ(why_not(a).would_change, "Records that begin before the pulse, and more gauges: all of them show the remains of earlier pulses.");
}

TEST(Why, AnExplanationMayBeImplausible) {
  Alternative a = beam();
  a.explanation.farthest = 4;
  EXPECT_EQ(why_not(a).why,
            "It would have to be stronger than is plausible (offset_z 2.31 ± 0.16 mm in place of 0 mm and width_ratio_z 0.990 ± 0.020 in place of 1).");
  EXPECT_EQ(why_not(a).would_change, "Independent evidence that it can be that strong.");
  a = beam();
  a.explanation.base_prior_deviation = 3;
  EXPECT_EQ(why_not(a).why, "With it the base parameters lie farther from the handbook than without it.");
  EXPECT_EQ(why_not(a).would_change, "Handbook values that are known to differ from the priors.");
  a = beam();
  a.explanation.by_scale = {{0, 0.5, 100}, {0.08, 0.5, 101.5}};
  EXPECT_EQ(why_not(a).why, "Its probability is 49 %, and a name needs more than 90 %. Another effect, or a further one beside it, is possible as well.");
  EXPECT_EQ(why_not(a).would_change, "Records that support it and not the others, or a second effect that accounts for the rest.");
}

}  // namespace
}  // namespace calomel
