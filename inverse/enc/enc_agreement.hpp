#pragma once
/// Whether optimisers and formulations of the misfit lead to one answer: the same search by other optimisers, and by other objectives.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "inverse/enc/enc_rounds.hpp"

namespace calomel {

/// Rounds of each compared optimiser and objective: enough to know their scatter, little beside the calibration's own.
inline constexpr int compared_rounds = 4;
/// Answers agree when they differ by no more than this, the largest over the parameters in units of their bounds.
inline constexpr double agreement_tolerance = 0.05;

/// Rounds of one optimiser together, of the calibration's own or of those it is compared with.
struct ComparedOptimizer {
  std::string name;
  int rounds = 0;
  double mean = 0, sd = 0, best = 0;  ///< of the objective at the end of a round; sd is NaN for one round
  std::vector<double> theta;          ///< (n_parameters) of its best round
  double distance = 0;                ///< of it from the best of all, the largest over the parameters in units of their bounds
  double shortfall = 0;               ///< what its best misses of the best of all, >= 0
  double share = 0;                   ///< of its rounds that ended within the tolerance of the best of all
  bool agrees = false;                ///< distance within the tolerance
};

/// The answer by one objective on the surrogate, and the result of the true model there.
struct EncFormulation {
  std::string objective;
  std::vector<double> theta;  ///< (n_parameters) best of its rounds
  double distance = 0;        ///< from the calibration's own on the surrogate, as above
  bool agrees = false;
  Candidate model;                                                    ///< `objective_model`: by the calibration's own objective
  std::vector<std::pair<std::string, std::optional<double>>> values;  ///< by the true model, each of the compared objectives
};

struct EncAgreement {
  std::vector<ComparedOptimizer> optimizers;
  std::vector<EncFormulation> objectives;  ///< the calibration's own first; empty when none is compared
  bool optimizers_agree = false, objectives_agree = false;
  std::size_t evaluations = 0;  ///< of the surrogate, beside the calibration's own
};

/// What is compared with the rounds of a calibration.
struct AgreementPlan {
  std::vector<std::string> optimizers, objectives;
  RoundPlan rounds;  ///< of each of them; its optimisers are those of the calibration
};

/// Runs the other searches, and the true model once an objective. `own`: the calibration's rounds by `objective`.
EncAgreement find_agreement(const Problem& problem, const ForwardModel& surrogate, const ForwardModel& true_model, const Objective& objective,
                            const std::vector<EncRound>& own, const AgreementPlan& plan, std::uint64_t seed, int threads,
                            const CalibrationProgress& progress = {});

/// agreement of enc.json: {tolerance, optimizers, objectives, optimizers_agree, objectives_agree, sentence, evaluations}
/// sentence: whether they agree, for people.
Json agreement_json(const EncAgreement& agreement, const Problem& problem, const std::string& sentence);

}  // namespace calomel
