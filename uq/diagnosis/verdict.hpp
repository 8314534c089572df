#pragma once
/// The rule that turns evidences into a verdict: which omitted physics is named, that nothing is missing, or that the cause is unknown.
#include <optional>
#include <string>
#include <vector>

namespace calomel {

/// Evidence under the hypotheses about the errors with a discrepancy of one scale.
struct ScaleEvidence {
  double scale = 0;         ///< standard deviation over the record's size; 0: no discrepancy
  double weight = 1;        ///< prior weight of these hypotheses; all weights sum to 1
  double log_evidence = 0;  ///< over that of the base model's whole mixture
};
/// One entry a scale, rising.
using EvidenceByScale = std::vector<ScaleEvidence>;

/// Log evidence of the scales up to `scale`, and of those beyond it, each part by itself: -infinity of a part without a scale.
[[nodiscard]] double log_within(const EvidenceByScale& e, double scale);
[[nodiscard]] double log_beyond(const EvidenceByScale& e, double scale);
/// Posterior mean of the scale of the discrepancy.
[[nodiscard]] double mean_scale(const EvidenceByScale& e);

/// Hold-out prediction of many small numbers. So many numbers can imitate anything that leaves a target moving, but cannot predict it. Misfits as in
/// Explanation.
struct HoldOutPrediction {
  double misfit_before = 0;     ///< of the records, by the base model or the explanation that the numbers are added to
  double gauges_before = 0;     ///< of held-out gauges, by the same
  double beginning_before = 0;  ///< of the first quarter of all records, held out of the fit, by the same
  double beginning = 0;         ///< of that quarter, with the numbers
};

/// One explanation beside the base model, as the rule sees it.
struct Explanation {
  std::string name;                      ///< mechanism, pair "a+b" in alphabetical order, or a numerical alternative
  bool numerical = false;                ///< a number of the discretisation, which is no physics
  bool of_two = false;                   ///< a pair, the second of which was chosen to take what the first leaves
  bool of_a_gauge = false;               ///< a fault of one gauge, which predicts nothing of the others
  double log_bayes_factor = 0;           ///< against the base model, under the same errors
  EvidenceByScale by_scale;              ///< its evidence, scale by scale of a discrepancy
  double chi2 = 0;                       ///< with it, without any discrepancy
  std::optional<double> base_chi2 = {};  ///< the base model's under the same covariance, its emulator's noise included; none: BaseEvidence::chi2 is
  double misfit = 0;                     ///< with it, |history - record| / |record|, mean over the gauges
  std::optional<double> held_out;        ///< misfit of what was held out of the fit; none: nothing was
  std::optional<HoldOutPrediction> hold_out_prediction = {};  ///< of many small numbers
  double farthest = 0;                                        ///< greatest distance of its numbers from the middle of their priors, in standard deviations
  double base_prior_deviation = 0;   ///< root mean square of the base parameters' prior deviations (distances from the handbook, in its standard deviations)
  bool fitted = false;               ///< in the true model; else to first order only
  std::vector<std::string> same_as;  ///< others that no record of these gauges distinguishes from it
};

/// The base model, as the rule sees it.
struct BaseEvidence {
  double values = 0;                 ///< number of values compared
  double chi2 = 0;                   ///< at its best, without any discrepancy
  double misfit = 0;                 ///< |history - record| / |record|, mean over the gauges
  double held_out = 0;               ///< misfit of what was held out of the fit
  EvidenceByScale by_scale;          ///< its evidence, scale by scale of a discrepancy
  std::optional<double> local = {};  ///< log evidence with a discrepancy in one place alone, over that of the whole mixture; none: the gauges have no places
  double base_prior_deviation = 0;   ///< as in Explanation
};

/// Numbers of the rule, frozen before cases are judged.
struct Gates {
  double log_bayes_factor = 7;
  double lead = 5;             ///< of evidence_of_name over that of the next explanation that is not of the same class
  double explained = 0.5;      ///< share of the excess of chi-squared: below it the reason is this share, above it the remainder
  double null_chi2 = 0.65;     ///< chi-squared over values where nothing is missing, because the errors are wide
  double adequate = 0.01;      ///< p-value of chi-squared of an adequate fit, at least
  double remainder = 1.0 / 4;  ///< remainder of a single name over that of the base model, at most, as amplitudes: no law is the target's to the last digit
  double misfit = 1;           ///< misfit of the records with a name over that without it, at most, where nothing was held out of the fit
  double held_out = 0.4;   ///< share of the squared misfit that held-out gauges lose with a name, over that which the records lose, at least: an effect that
                           ///< only imitates the cause does not predict them
  double farthest = 3;     ///< prior deviation of a number of a name, at most
  double handbook = 2;     ///< base_prior_deviation that is not implausible
  double temperature = 2;  ///< log evidences are divided by it before they become probabilities: Laplace on an emulator is that much too sure
  double prior_none = 0.5, prior_unknown = 0.25;  ///< prior probabilities; the names have the rest
  double prior_pairs = 0.2;                       ///< share of all pairs of mechanisms in the names' prior: a pair was chosen among some eighty
  double believed = 0.9;                          ///< probability of what is named, or of its class, is greater than this
  int revision = 10;                              ///< raised with every change of judge() or of its inputs, so that no two rules have one name
};

enum class VerdictKind { none, named, ambiguous, unknown };
std::string text(VerdictKind kind);

struct Ranked {
  std::string name;  ///< "none", "unknown", or an explanation's
  double probability = 0;
  double log_evidence = 0;  ///< over the base model's whole: "none" without a discrepancy, a name with no more than it may leave, "unknown" the base model and
                            ///< all explanations with more
};

/// The gates of the rule, in their order; the first one that an explanation fails.
enum class Gate {
  passed,
  fitted,
  evidence,
  numerical,
  competitor,
  numerical_competitor,
  explained,
  remainder,
  misfit,
  held_out,
  plausible,
  handbook,
  probability
};

/// The facts that decided a verdict.
struct VerdictReason {
  bool base_adequate = false;        ///< the base model explains the records within their errors
  std::string leading;               ///< explanation with the greatest evidence; empty: nothing was offered
  Gate gate = Gate::passed;          ///< that the leading explanation fails
  double explained = 0;              ///< share of the excess that the leading explanation takes away
  double lead = 0;                   ///< of its evidence over that of the next class
  double probability = 0;            ///< of its class, where the gate is `probability`
  std::string numerical_competitor;  ///< where the gate is `numerical_competitor`
};

struct Verdict {
  VerdictKind kind = VerdictKind::unknown;
  std::vector<std::string> mechanisms;  ///< named, or the class that the records do not distinguish
  std::vector<Ranked> ranking;  ///< most probable first; probabilities sum to 1. Where a gate refuses the leading explanation, refused ones have 0 and follow
                                ///< "unknown"
  VerdictReason reason;
};

/// Log evidence of an explanation with no more of a discrepancy than a name may leave, over that of the base model's whole. Explanations are compared by it:
/// with any discrepancy beside it, one that explains half of what another explains may have as much evidence.
[[nodiscard]] double evidence_of_name(const BaseEvidence& base, const Explanation& e, const Gates& gates = {});

/// The greatest evidence_of_name first.
void sort_by_evidence(const BaseEvidence& base, std::vector<Explanation>& all, const Gates& gates = {});

/// The first gate that the i-th of all explanations fails, in the order of sort_by_evidence. `competitor`: the best is not of its class and leads it too far.
[[nodiscard]] Gate gate_not_passed(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& gates = {});

/// Share, 0 to 1, of the excess of chi-squared above that of nothing missing which an explanation takes away; nothing where there is no excess.
[[nodiscard]] std::optional<double> share_explained(const BaseEvidence& base, const Explanation& e, const Gates& gates = {});

/// Probability of the i-th explanation together with those that the records do not distinguish from it.
[[nodiscard]] double class_probability(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& gates = {});

/// Whether no record of these gauges distinguishes the two.
[[nodiscard]] bool same_class(const Explanation& a, const Explanation& b);

/// The least share of the excess of chi-squared that a name must explain where the records are not explained within their errors.
[[nodiscard]] double least_explained(const Gates& gates = {});

/// The greatest scale of a discrepancy that a name may leave, for its probability.
[[nodiscard]] double greatest_remainder(const BaseEvidence& base, const Gates& gates = {});

/// The greatest chi-squared that is not implausible of an adequate fit.
[[nodiscard]] double greatest_plausible(const BaseEvidence& base, const Gates& gates = {});

/// The rule of docs/theory/diagnosis.md. Explanations in any order.
[[nodiscard]] Verdict judge(const BaseEvidence& base, std::vector<Explanation> explanations, const Gates& gates = {});

}  // namespace calomel
