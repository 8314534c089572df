#pragma once
/// Evolutionary neural calibration: rounds of population optimisers on a surrogate, the best distinct points re-run in the
/// true model. Seed paper, section "Evolutionary Optimization"; Radaideh et al.
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/artefact.hpp"
#include "inverse/objective.hpp"
#include "inverse/optimizer/optimizer.hpp"
#include "inverse/problem.hpp"

namespace calomel {

/// `[enc]` of a case file.
struct EncOptions {
  int rounds = 100;
  int generations = 100;
  int population = 40;
  std::vector<std::string> optimizers{"es", "gwo", "de", "mfo"};
  int candidates = 8;
  double separation = 0.03;
  std::string objective = "paper_enc";

  template <class V>
  void visit(V& v) {
    v("rounds", rounds, {.range = at_least(1), .doc = "rounds; in each one optimiser is drawn at random"});
    v("generations", generations, {.range = at_least(1), .doc = "generations of a round"});
    v("population", population, {.range = at_least(5), .doc = "points of a generation"});
    v("optimizers", optimizers, {.doc = "optimisers that are drawn from", .choices = calomel::optimizers().names(), .least_size = 1});
    v("candidates", candidates, {.range = between(1, 50), .doc = "best distinct points that are re-run in the true model"});
    v("separation", separation,
      {.range = between(0, 0.5), .doc = "least distance of two candidates, the largest over the parameters in units of their bounds"});
    v("objective", objective, {.doc = "formulation of the misfit", .choices = objectives().names()});
  }
};

struct EncRound {
  std::string optimizer;
  std::vector<double> theta;  ///< (n_parameters)
  double objective = 0;       ///< on the surrogate, in the objective's own sense; NaN when every point failed
  std::vector<double> trace;  ///< (generations + 1) best objective so far
  std::size_t evaluations = 0;
};

struct EncCandidate {
  std::vector<double> theta;
  double objective_surrogate = 0;
  std::optional<double> objective_model;  ///< empty: the true model failed there
  std::string message;                    ///< why it failed
  Score score;
};

/// Rounds of one optimiser together.
struct EncOptimizer {
  std::string name;
  int rounds = 0;
  double mean = 0, sd = 0, best = 0;  ///< of the objective after the last generation; sd is NaN for one round
  std::vector<double> trace;          ///< of its best round
};

enum class EncStatus { not_run, done, no_candidate };

struct EncSummary {
  EncStatus status = EncStatus::not_run;
  std::string message = "the calibration was not run";
  Objective objective;
  std::vector<double> theta, nominal;              ///< (n_parameters) in declared order
  EncCandidate best, at_nominal;                   ///< as the true model has them
  std::vector<EncCandidate> candidates;            ///< best by the true model first; failed ones only when no other was left
  std::vector<EncCandidate> failed;                ///< candidates replaced by another because the true model failed
  std::vector<double> calibrated, nominal_values;  ///< (condition, sensor, time) true-model means; empty where failed
  std::vector<EncRound> rounds;
  std::vector<EncOptimizer> optimizers;
  std::vector<std::string> warnings;
  std::size_t evaluations = 0;       ///< of the surrogate
  std::size_t model_runs = 0;        ///< of the true model
  double search_s = 0, model_s = 0;  ///< wall time of the rounds and of the true-model runs [s]
  [[nodiscard]] bool trusted() const { return status == EncStatus::done; }
};

/// What is done and what there is to do, of "rounds" or "true-model runs"; called from any thread, one at a time.
using EncProgress = std::function<void(const std::string& what, std::size_t done, std::size_t total)>;

/// The rounds run side by side on `threads` threads; the result depends on the seed alone. `surrogate` and `true_model`
/// have the shape of `problem`.
/// Errors: InputError for an unknown optimiser or objective; what the models throw.
[[nodiscard]] EncSummary run_enc(const Problem& problem, const ForwardModel& surrogate, const ForwardModel& true_model, const EncOptions& options,
                                 std::uint64_t seed, int threads, const EncProgress& progress = {});

/// The contents of enc.json.
Json enc_json(const EncSummary& summary, const Problem& problem, const Provenance& provenance);
/// Writes enc.nc, then enc.json, into `out_dir`: time; calibrated, nominal (condition, sensor, time); record_time; record_mean, band_low,
/// band_high (condition, sensor, record_time).
void write_enc(const EncSummary& summary, const Problem& problem, const Provenance& provenance, const std::filesystem::path& out_dir);

}  // namespace calomel
