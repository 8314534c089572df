#pragma once
/// From evidences to a verdict: which omitted physics is named, that nothing is missing, or that it is not known.
#include <optional>
#include <string>
#include <vector>

namespace calomel {

/// Evidence under the hypotheses about the errors with a discrepancy of one scale.
struct ScaleEvidence {
  double scale = 0;         ///< standard deviation over the record's size; 0: no discrepancy
  double weight = 1;        ///< of these hypotheses before the records; all weights sum to 1
  double log_evidence = 0;  ///< over that of the base model's whole mixture
};
/// One entry a scale, rising.
using EvidenceByScale = std::vector<ScaleEvidence>;

/// Log evidence of the scales up to `scale`, and of those beyond it, each part by itself: -infinity of a part without a scale.
[[nodiscard]] double log_within(const EvidenceByScale& e, double scale);
[[nodiscard]] double log_beyond(const EvidenceByScale& e, double scale);
/// Scale of the discrepancy that the records ask for: its mean over these hypotheses.
[[nodiscard]] double mean_scale(const EvidenceByScale& e);

/// What many small numbers foretell of what they were not shown: with so many anything that leaves a target moving is imitated, but not foretold. Misfits as in
/// Explanation.
struct Foretold {
  double misfit_before = 0;     ///< of the records by what the numbers stand on, the base model or another explanation
  double gauges_before = 0;     ///< of gauges left out by the same
  double beginning_before = 0;  ///< of the first quarter of all records, left out of the fit, by the same
  double beginning = 0;         ///< and with the numbers
};

/// What is known of one explanation beside the base model.
struct Explanation {
  std::string name;  ///< mechanism, pair "a+b" in alphabetical order, or a numerical alternative
  bool numerical = false;
  bool of_two = false;                    ///< a pair, the second of which was chosen to take what the first leaves
  bool of_a_gauge = false;                ///< a fault of one gauge, which predicts nothing of the others
  double log_bayes_factor = 0;            ///< against the base model, under the same errors
  EvidenceByScale by_scale;               ///< the same, scale by scale of a discrepancy
  double chi2 = 0;                        ///< with it, without any discrepancy
  std::optional<double> base_chi2 = {};   ///< the base model's under the same covariance, its emulator's noise included; none: the base model's own is under it
  double misfit = 0;                      ///< with it, |history - record| / |record|, mean over the gauges
  std::optional<double> held_out;         ///< the same of what was left out of the fit; where that was made
  std::optional<Foretold> foretold = {};  ///< of many small numbers
  double farthest = 0;                    ///< of its numbers, in prior standard deviations from their middle
  double base_pull = 0;                   ///< root mean square of the base parameters' distances from the handbook, in its standard deviations
  bool fitted = false;                    ///< in the true model; else to first order only
  std::vector<std::string> same_as;       ///< others that no record of these gauges tells from it
};

/// The base model.
struct BaseEvidence {
  double values = 0;                 ///< compared
  double chi2 = 0;                   ///< at its best, without any discrepancy
  double misfit = 0;                 ///< |history - record| / |record|, mean over the gauges
  double held_out = 0;               ///< the same of what was left out of the fit
  EvidenceByScale by_scale;          ///< its evidence, scale by scale of a discrepancy
  std::optional<double> local = {};  ///< log evidence with a discrepancy in one place alone, over that of the whole mixture; none: the gauges have no places
  double base_pull = 0;
};

/// Numbers of the rule, frozen before cases are judged.
struct Gates {
  double log_bayes_factor = 7;
  double lead = 5;  ///< of evidence_of_name over that of the next explanation that is not of the same class
  double explained =
      0.5;  ///< of what chi-squared has above that of nothing missing: what explains less, and is not enough, is told by that and not by what it leaves
  double null_chi2 = 0.65;  ///< chi-squared over values where nothing is missing, as the errors are wide
  double adequate = 0.01;   ///< p-value of chi-squared of an adequate fit, at least
  double remainder =
      1.0 / 4;  ///< or, of a single name: what it leaves over what the base model leaves, at most, as amplitudes. No law is the target's to the last digit
  double misfit = 1;      ///< of the records with a name over that without it: it has to be below, where nothing was left out of the fit
  double held_out = 0.4;  ///< of the share of its square that the records' misfit loses with a name: what that of gauges left out of the fit loses at least.
                          ///< What imitates an effect does not predict them
  double farthest = 3;
  double handbook = 2;     ///< root mean square of the base parameters' distances from it, in its standard deviations, that is not implausible
  double temperature = 2;  ///< log evidences are divided by it before they become probabilities: Laplace on an emulator is that much too sure
  double prior_none = 0.5, prior_unknown = 0.25;  ///< probabilities before the records; what is left is that of the names
  double prior_pairs = 0.2;  ///< of that, what all pairs of mechanisms together have: one of them is a pair that was chosen among some eighty
  double believed = 0.9;     ///< probability of what is named or not told apart, more than
  int revision = 10;  ///< of what is asked of these numbers: raised with every change of judge() or of what it is told, so that no two rules have one name
};

enum class VerdictKind { none, named, ambiguous, unknown };
std::string text(VerdictKind kind);

struct Ranked {
  std::string name;  ///< "none", "unknown", or an explanation's
  double probability = 0;
  double log_evidence = 0;  ///< over the base model's whole: "none" without a discrepancy, a name with no more than it may leave, "unknown" the base model and
                            ///< all explanations with more
};

struct Verdict {
  VerdictKind kind = VerdictKind::unknown;
  std::vector<std::string> mechanisms;  ///< named, or the class that is not told apart
  std::vector<Ranked> ranking;  ///< most probable first; probabilities sum to 1. Where a gate refuses what leads, what is refused has 0 and follows "unknown"
  std::string reason;           ///< one sentence
};

/// Log evidence of an explanation with no more of a discrepancy than a name may leave, over that of the base model's whole: by this explanations are held
/// against one another. With any discrepancy one that explains half of what another explains may be worth as much.
[[nodiscard]] double evidence_of_name(const BaseEvidence& base, const Explanation& e, const Gates& gates = {});

/// The greatest evidence_of_name first.
void sort_by_evidence(const BaseEvidence& base, std::vector<Explanation>& all, const Gates& gates = {});

/// Which of the rule's gates an explanation meets first that it does not pass.
enum class Gate { passed, fitted, evidence, numerical, rival, numerical_rival, explained, remainder, misfit, held_out, plausible, handbook, probability };

/// Of the i-th of all explanations, which stand as sort_by_evidence leaves them. `rival`: the best is not of its class and leads it too far.
[[nodiscard]] Gate gate_not_passed(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& gates = {});

/// Share of what chi-squared has above that of nothing missing which an explanation takes away, 0 to 1; nothing where there is no such excess.
[[nodiscard]] std::optional<double> share_explained(const BaseEvidence& base, const Explanation& e, const Gates& gates = {});

/// Probability of the i-th explanation together with those that are not told apart from it.
[[nodiscard]] double probability_told(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& gates = {});

/// Whether no record of these gauges tells the two apart.
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
