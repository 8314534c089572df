// The rule from evidences to a verdict, case by case.
#include "uq/diagnosis/verdict.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "tests/unit/uq/diagnosis/described.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;

/// Without a discrepancy, and with one of 8 % of the records.
EvidenceByScale with_and_without(double plain, double discrepancy) { return {{0, 0.5, plain}, {0.08, 0.5, discrepancy}}; }
BaseEvidence poor() {
  return {.values = 100, .chi2 = 400, .misfit = 0.2, .held_out = 0.2, .by_scale = with_and_without(-120, -0.1), .base_prior_deviation = 1.5};
}
BaseEvidence good() {
  return {.values = 100, .chi2 = 66, .misfit = 0.05, .held_out = 0.05, .by_scale = with_and_without(-0.2, -1.5), .base_prior_deviation = 0.4};
}
Explanation beam() {
  return {.name = "beam_profile",
          .log_bayes_factor = 100,
          .by_scale = with_and_without(102, 97),
          .chi2 = 70,
          .misfit = 0.04,
          .held_out = 0.04,
          .farthest = 1,
          .base_prior_deviation = 0.3,
          .fitted = true};
}
Explanation rear() {
  return {.name = "rear_reflection",
          .log_bayes_factor = 4,
          .by_scale = with_and_without(-90, 4),
          .chi2 = 350,
          .misfit = 0.18,
          .base_prior_deviation = 1,
          .fitted = true};
}

/// The same with all of its evidence less by so much.
Explanation weaker(Explanation e, double by) {
  e.log_bayes_factor -= by;
  for (auto& s : e.by_scale) s.log_evidence -= by;
  return e;
}

TEST(Verdict, NamesWhatExplainsAndLeads) {
  const Verdict v = judge(poor(), {rear(), beam()});
  EXPECT_EQ(v.kind, VerdictKind::named);
  EXPECT_THAT(v.mechanisms, ElementsAre("beam_profile"));
  EXPECT_EQ(v.ranking[0].name, "beam_profile");
  double sum = 0;
  for (const auto& r : v.ranking) sum += r.probability;
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_EQ(v.ranking.size(), 4u);
}

// The numerical alternative may be of the best's class, or behind another explanation.
TEST(Verdict, NumericsThatExplainAsMuchAreUnknownWhateverLiesBetween) {
  Explanation numerics = weaker(beam(), 3), second = weaker(beam(), 2);
  numerics.name = "numerics";
  numerics.numerical = true;
  second.name = "previous_pulses";
  const Verdict behind = judge(poor(), {beam(), second, numerics});
  EXPECT_EQ(behind.kind, VerdictKind::unknown);
  EXPECT_EQ(behind.reason.gate, Gate::numerical_competitor);
  EXPECT_EQ(behind.reason.numerical_competitor, "numerics");
  EXPECT_EQ(behind.reason.leading, "beam_profile");
  numerics = weaker(beam(), 30);
  numerics.name = "numerics";
  numerics.numerical = true;
  numerics.same_as = {"beam_profile"};
  EXPECT_EQ(judge(poor(), {beam(), numerics}).kind, VerdictKind::unknown);
  numerics.same_as.clear();  // the control: far behind and of another class
  EXPECT_THAT(judge(poor(), {beam(), numerics}).mechanisms, ElementsAre("beam_profile"));
}

TEST(Verdict, IsSureOfUnknownWhereAllNeedADiscrepancy) {
  Explanation part = beam();  // gains much, and still leaves what only a discrepancy takes up
  part.by_scale = with_and_without(-30, 100);
  part.chi2 = 200;
  const Verdict v = judge(poor(), {part, rear()});
  EXPECT_EQ(v.kind, VerdictKind::unknown);
  EXPECT_EQ(v.ranking[0].name, "unknown");
  EXPECT_GT(v.ranking[0].probability, 0.99);
}

// Each hypothesis has a prior and a tempered evidence of its own. Here one explanation is as likely without anything beside it as with; the base model is out
// of the question.
TEST(Verdict, AnExplanationIsAsProbableAsItsEvidenceAndPriorSay) {
  const Gates g;
  BaseEvidence base = poor();
  base.by_scale = with_and_without(-1000, -1000);
  Explanation one = beam();
  one.by_scale = with_and_without(50, 50);
  const Verdict v = judge(base, {one});
  ASSERT_EQ(v.ranking[0].name, "beam_profile");
  const double name = 1 - g.prior_none - g.prior_unknown, unknown = 0.5 * g.prior_unknown;
  EXPECT_NEAR(v.ranking[0].probability, name / (name + unknown), 1e-12);
  EXPECT_EQ(v.ranking[1].name, "unknown");
  EXPECT_NEAR(v.ranking[1].log_evidence, 50 + std::log(0.5), 1e-9);
}

// A pair is one of all pairs that there could be, and they share a fifth of the prior probability of names.
TEST(Verdict, APairIsOneOfMany) {
  const Gates g;
  BaseEvidence base = poor();
  base.by_scale = with_and_without(-1000, -1000);
  Explanation pair = beam(), third = rear();
  pair.name = "beam_profile+rear_reflection";
  pair.by_scale = with_and_without(60, 50);
  third.name = "interface";
  const auto of_pair = [&](std::vector<Explanation> all) {
    for (auto& e : all)
      if (e.name != pair.name) e.by_scale = with_and_without(-1000, -1000);
    for (const auto& r : judge(base, all).ranking)
      if (r.name == pair.name) return r.probability / (1 - r.probability);
    return 0.0;
  };
  // It competes with itself beside a discrepancy, which has half of the prior of "unknown".
  const double names = 1 - g.prior_none - g.prior_unknown, expected = std::exp(5.0) * names / (0.5 * g.prior_unknown);
  EXPECT_NEAR(of_pair({pair, beam(), rear(), third}) / expected, 1, 1e-6);
  // With something beside it that needs a discrepancy, odds fall as there are more mechanisms.
  const auto against = [&](std::size_t mechanisms) {
    std::vector<Explanation> all{pair};
    for (std::size_t i = 0; i < mechanisms; ++i) {
      all.push_back(rear());
      all.back().name = std::string(1, char('a' + i));
      all.back().by_scale = with_and_without(-1000, i == 0 ? 55 : -1000);
    }
    double named = 0, unknown = 0;
    for (const auto& r : judge(base, all).ranking) {
      if (r.name == pair.name) named = r.probability;
      if (r.name == "unknown") unknown = r.probability;
    }
    return named / unknown;
  };
  EXPECT_GT(against(3), 2 * against(13));
}

TEST(Verdict, IsNoneIfTheBaseModelIsAdequate) {
  Explanation weak = beam();
  weak.log_bayes_factor = 2;
  const Verdict v = judge(good(), {weak, rear()});
  EXPECT_EQ(v.kind, VerdictKind::none);
  EXPECT_TRUE(v.mechanisms.empty());
  const Verdict alone = judge(good(), {});
  EXPECT_EQ(alone.kind, VerdictKind::none);
  EXPECT_EQ(alone.ranking[0].name, "none");
}

/// The reason of the verdict "unknown".
VerdictReason reason_of_unknown(const BaseEvidence& base, std::vector<Explanation> all) {
  const Verdict v = judge(base, std::move(all));
  EXPECT_EQ(v.kind, VerdictKind::unknown) << described(v);
  EXPECT_TRUE(v.mechanisms.empty());
  return v.reason;
}
Gate gate_of_unknown(const BaseEvidence& base, std::vector<Explanation> all) { return reason_of_unknown(base, std::move(all)).gate; }

TEST(Verdict, IsUnknownForEachReason) {
  Explanation x = beam();
  x.log_bayes_factor = Gates{}.log_bayes_factor - 0.5;
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::evidence);
  x = beam();
  x.chi2 = 300;
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::explained);
  x = beam();
  x.chi2 = 140;
  x.by_scale = with_and_without(97, 102);
  const VerdictReason remainder = reason_of_unknown(poor(), {x});
  EXPECT_EQ(remainder.gate, Gate::remainder);
  EXPECT_NEAR(1 - remainder.explained, 0.22, 0.005);
  // An explanation that leaves no more than chance is a name, however little there was to explain.
  BaseEvidence hardly = poor();
  hardly.chi2 = 1.05 * greatest_plausible(hardly);
  x = beam();
  x.chi2 = 0.95 * greatest_plausible(hardly);
  EXPECT_LT(*share_explained(hardly, x), Gates{}.explained);
  EXPECT_EQ(judge(hardly, {x}).kind, VerdictKind::named) << described(judge(hardly, {x}));
  x = beam();
  x.farthest = 4;
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::plausible);
  x = beam();
  x.base_prior_deviation = 3;
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::handbook);
  x = beam();
  x.numerical = true;
  x.name = "numerics";
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::numerical);
  Explanation mesh = weaker(beam(), 0.9 * Gates{}.lead);
  mesh.name = "numerics";
  mesh.numerical = true;
  EXPECT_EQ(reason_of_unknown(poor(), {beam(), mesh}).numerical_competitor, "numerics");
  EXPECT_EQ(reason_of_unknown(poor(), {}).leading, "");
  EXPECT_FALSE(reason_of_unknown(poor(), {}).base_adequate);
  x = beam();
  x.by_scale = with_and_without(-30, 100);
  const VerdictReason improbable = reason_of_unknown(poor(), {x});
  EXPECT_EQ(improbable.gate, Gate::probability);
  EXPECT_LT(improbable.probability, 0.005);
}

TEST(Verdict, ANameHasToPredictWhatWasHeldOut) {
  Explanation x = beam();
  x.misfit = 0.2;
  x.held_out.reset();
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::misfit);
  x = beam();
  x.misfit = 0.21;  // the base model bent its parameters to the records; what was held out comes nearer
  EXPECT_EQ(judge(poor(), {x}).kind, VerdictKind::named);
  x.held_out = 0.21;
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::held_out);
  x = beam();
  x.held_out = 0.17;  // the records lose 96 % of the square, what is held out 28 %
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::held_out);
  x.of_a_gauge = true;  // which predicts nothing of the others
  EXPECT_EQ(judge(poor(), {x}).kind, VerdictKind::named);
  x.held_out = 0.21;
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::held_out);
}

// The beginning of the records counts as much as the gauges.
TEST(Verdict, ManySmallNumbersHaveToPredictTheBeginningOfTheRecords) {
  Explanation x = beam();
  x.held_out = 0.17;
  x.hold_out_prediction = HoldOutPrediction{.misfit_before = 0.2, .gauges_before = 0.18, .beginning_before = 0.16, .beginning = 0.08};
  EXPECT_EQ(judge(poor(), {x}).kind, VerdictKind::named);  // of the squares gauges lose 11 %, the beginning 75 %, the records 96 %
  x.hold_out_prediction->beginning = 0.15;
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::held_out);
  x.held_out = 0.06;  // of which 89 %
  EXPECT_EQ(judge(poor(), {x}).kind, VerdictKind::named);
  x.held_out.reset();  // no gauge was held out
  EXPECT_EQ(gate_of_unknown(poor(), {x}), Gate::held_out);
  x.hold_out_prediction->misfit_before = 0.041;  // on top of another explanation, which had done nearly all
  x.misfit = 0.04;
  EXPECT_EQ(judge(poor(), {x}).kind, VerdictKind::named);
}

// A leading explanation that fails a test of substance is not what the target does. The ranking has "unknown" first, and then that explanation.
TEST(Verdict, AnExplanationThatAGateRefusesCountsAsUnknown) {
  Explanation refused = beam(), other = rear();
  refused.farthest = 4;
  other.log_bayes_factor = 40;
  other.by_scale = with_and_without(90, 40);
  const Verdict named = judge(poor(), {beam(), other}), v = judge(poor(), {refused, other});
  const auto probability_of = [](const Verdict& of, const std::string& name) {
    return std::find_if(of.ranking.begin(), of.ranking.end(), [&](const Ranked& r) { return r.name == name; })->probability;
  };
  EXPECT_EQ(named.ranking[0].name, "beam_profile");
  EXPECT_GT(probability_of(named, "beam_profile"), Gates{}.believed);
  EXPECT_EQ(v.kind, VerdictKind::unknown);
  EXPECT_EQ(v.ranking[0].name, "unknown");
  EXPECT_EQ(v.ranking[1].name, "beam_profile");
  EXPECT_DOUBLE_EQ(v.ranking[1].probability, 0);
  EXPECT_DOUBLE_EQ(v.ranking[1].log_evidence, named.ranking[0].log_evidence);
  EXPECT_DOUBLE_EQ(v.ranking[0].probability, probability_of(named, "unknown") + probability_of(named, "beam_profile"));
  EXPECT_DOUBLE_EQ(probability_of(v, "rear_reflection"), probability_of(named, "rear_reflection"));
  // So does an explanation of its class that fails the same test. One that is only less probable keeps its share.
  Explanation twin = weaker(refused, 1);
  twin.name = "interface";
  twin.same_as = {"beam_profile"};
  const Verdict both = judge(poor(), {refused, twin, other});
  EXPECT_DOUBLE_EQ(probability_of(both, "interface"), 0);
  EXPECT_EQ(both.ranking[2].name, "interface");
  EXPECT_GT(probability_of(both, "rear_reflection"), 0);
  double sum = 0;
  for (const auto& r : both.ranking) sum += r.probability;
  EXPECT_NEAR(sum, 1, 1e-12);
  // The control: explanations that pass are not refused for being indistinguishable.
  twin.farthest = 1;
  twin.same_as.clear();
  const Verdict close = judge(poor(), {beam(), twin, other});
  EXPECT_EQ(close.ranking[0].name, "beam_profile");
  EXPECT_GT(close.ranking[0].probability, 0.5);
}

// The evidence of a discrepancy in one place alone counts for "unknown" as much as that of a discrepancy everywhere.
TEST(Verdict, ADiscrepancyInOnePlaceAloneCompetesWithAName) {
  BaseEvidence base = poor();
  base.local = -20;
  EXPECT_EQ(judge(base, {beam()}).kind, VerdictKind::named);
  base.local = 110;  // beam(): 102
  const Verdict v = judge(base, {beam()});
  EXPECT_EQ(v.kind, VerdictKind::unknown);
  EXPECT_EQ(v.ranking[0].name, "unknown");
  // Half of the prior probability of "unknown" is that of the base model, and half of this is that of one place.
  base.local = 102;
  const Gates g;
  const auto r = judge(base, {beam()}).ranking;
  const double of_name = 1 - g.prior_none - g.prior_unknown;
  ASSERT_EQ(r[0].name, "beam_profile");
  EXPECT_NEAR(r[0].probability, of_name / (of_name + 0.25 * g.prior_unknown + 0.5 * g.prior_unknown * std::exp(0.5 * (97 - 102))), 1e-3);
}

// No law is the target's to the last digit: what is left may be more than the errors, if it is small beside what the name accounts for.
TEST(Verdict, ANameMayLeaveLittleOfWhatTheBaseModelLeaves) {
  BaseEvidence base = poor();
  base.chi2 = 2065;  // 2000 above that of nothing missing
  base.by_scale = {{0, 0.2, -120}, {0.015, 0.3, -60}, {0.08, 0.5, -0.1}};
  Explanation x = beam();
  x.by_scale = {{0, 0.2, 70}, {0.015, 0.3, 100}, {0.08, 0.5, 80}};
  x.chi2 = 65 + 120;  // a sixteenth is 125
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::named);
  EXPECT_GT(judge(base, {x}).ranking[0].probability, 0.99);
  Explanation two = x;  // the second was chosen for what the first leaves, and has to explain all of it
  two.of_two = true;
  EXPECT_EQ(judge(base, {two}).kind, VerdictKind::unknown);
  EXPECT_EQ(gate_not_passed(base, {two}, 0), Gate::remainder);
  two.chi2 = 130;  // p 0.02
  EXPECT_EQ(judge(base, {two}).kind, VerdictKind::named);
  x.chi2 = 65 + 130;
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::unknown);
  x.by_scale[2].log_evidence = 130;  // it needs as much of a discrepancy as the base model
  EXPECT_EQ(judge(base, {x}).ranking[0].name, "unknown");
}

// Two emulators differ in their noise: the share that a name accounts for is measured under the errors of its own fit, which are the narrower ones here.
TEST(Verdict, TheShareThatANameAccountsForIsMeasuredUnderOneCovariance) {
  BaseEvidence base = poor();
  base.chi2 = 265;  // by an emulator so noisy that 200 are above that of nothing missing
  Explanation x = beam();
  x.chi2 = 65 + 20;                                      // a tenth of them
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::named);  // plausible in itself
  x.chi2 = 65 + 80;
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::unknown);
  x.base_chi2 = 65 + 2000;
  EXPECT_DOUBLE_EQ(*share_explained(base, x), 0.96);
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::named) << described(judge(base, {x}));
}

// A weak effect: the base model explains the records within their errors, and there is no excess of chi-squared to take away; the evidence alone speaks.
TEST(Verdict, AWeakEffectIsNamedByItsEvidenceWhereTheBaseModelIsAdequate) {
  BaseEvidence base = good();
  base.chi2 = 95;  // 30 above that of nothing missing, and plausible
  Explanation x = beam();
  x.log_bayes_factor = 12;
  x.by_scale = with_and_without(13, 8);
  x.chi2 = 85;
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::named) << described(judge(base, {x}));
  base.chi2 = 200;  // an excess of 135, and a tenth of it explained
  x.chi2 = 185;
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::unknown);
}

// Where no scale of a discrepancy is as large as the mismatch of the base model, its misfit is the scale.
TEST(Verdict, ANameIsProbableBesideABaseModelThatNoDiscrepancyExplains) {
  BaseEvidence base = poor();
  base.chi2 = 40000;
  base.misfit = 0.2;
  base.by_scale = {{0, 0.3, 0}, {0.02, 0.3, -900}, {0.2, 0.4, -400}};
  Explanation x = beam();
  x.log_bayes_factor = 1700;
  x.by_scale = {{0, 0.3, 1300}, {0.02, 0.3, 1700}, {0.2, 0.4, 1600}};
  x.chi2 = 900;
  EXPECT_EQ(judge(base, {x}).kind, VerdictKind::named) << described(judge(base, {x}));
  EXPECT_NEAR(greatest_remainder(base), 0.05, 1e-3);
}

TEST(Verdict, PartsOfTheEvidenceAreTheirOwnMeans) {
  const EvidenceByScale e{{0, 0.25, std::log(2)}, {0.01, 0.25, std::log(4)}, {0.03, 0.5, std::log(1)}};
  EXPECT_NEAR(log_within(e, 0), std::log(2), 1e-12);
  EXPECT_NEAR(log_within(e, 0.02), std::log(3), 1e-12);
  EXPECT_NEAR(log_beyond(e, 0), std::log(2), 1e-12);
  EXPECT_EQ(log_beyond(e, 0.03), -std::numeric_limits<double>::infinity());
  EXPECT_NEAR(mean_scale(e), (0.25 * 4 * 0.01 + 0.5 * 0.03) / 2, 1e-12);
}

TEST(Verdict, NamesAClassAsAClass) {
  Explanation near = weaker(beam(), 0.9 * Gates{}.lead), twin = weaker(beam(), 60);
  near.name = "interface";
  EXPECT_EQ(judge(poor(), {beam(), near}).kind, VerdictKind::ambiguous);
  EXPECT_THAT(judge(poor(), {near, beam()}).mechanisms, ElementsAre("beam_profile", "interface"));
  twin.name = "static_pressure";
  twin.same_as = {"beam_profile"};
  EXPECT_THAT(judge(poor(), {beam(), twin, rear()}).mechanisms, ElementsAre("beam_profile", "static_pressure"));
}

// With any discrepancy beside it, an explanation of half the effect may have nearly as much evidence. Explanations are compared with what a name may leave.
TEST(Verdict, ComparesExplanationsByWhatANameMayLeave) {
  Explanation half = weaker(beam(), 0.5 * Gates{}.lead);
  half.name = "rear_reflection";
  half.by_scale = with_and_without(60, 98);
  half.chi2 = 200;
  const Verdict v = judge(poor(), {half, beam()});
  EXPECT_EQ(v.kind, VerdictKind::named) << described(v);
  EXPECT_THAT(v.mechanisms, ElementsAre("beam_profile"));
  half.log_bayes_factor = beam().log_bayes_factor + 3;  // more, with a discrepancy
  EXPECT_THAT(judge(poor(), {half, beam()}).mechanisms, ElementsAre("beam_profile"));
}

// An explanation that is not probable enough is no name.
TEST(Verdict, ANameIsNineTimesAsProbableAsAllElseTogether) {
  Explanation x = beam();
  x.by_scale = with_and_without(100, 96);  // likelier without anything beside it
  EXPECT_EQ(judge(poor(), {x}).kind, VerdictKind::named) << described(judge(poor(), {x}));
  x.by_scale = with_and_without(100, 100.5);  // as likely with something beside it
  const Verdict v = judge(poor(), {x});
  EXPECT_EQ(v.kind, VerdictKind::unknown);
  EXPECT_EQ(v.reason.gate, Gate::probability);
}

// gate_not_passed repeats the gates of judge(); over random evidences the two must agree.
TEST(Verdict, TheGateThatIsNotPassedAgreesWithIt) {
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
    named += gate == Gate::passed;
    unknown += v.kind == VerdictKind::unknown;
  }
  EXPECT_GT(named, 100);
  EXPECT_GT(unknown, 100);
}

}  // namespace
}  // namespace calomel
