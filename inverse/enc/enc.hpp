#pragma once
/// Evolutionary neural calibration: rounds of population optimisers on a surrogate, the best distinct points re-run in the
/// true model. Seed paper, section "Evolutionary Optimization"; Radaideh et al.
#include <filesystem>
#include <string>
#include <vector>

#include "inverse/calibration/calibration.hpp"
#include "inverse/enc/enc_agreement.hpp"
#include "inverse/enc/enc_rounds.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// `[enc]` of a case file.
struct EncOptions {
  int rounds = 100;
  int generations = 100;
  int population = 40;
  std::vector<std::string> optimizers{"es", "gwo", "de", "mfo"};
  int candidates = 8;
  double separation = 0.03;
  std::string objective = "paper_enc";
  std::vector<std::string> compare_optimizers{"cmaes_restarts", gradient_search};
  std::vector<std::string> compare_objectives{"rrmse"};
  bool mesh_correction = true;

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
    v("compare_optimizers", compare_optimizers,
      {.doc = "optimisers whose results are compared with the calibration's; gradient: multi-start L-BFGS on the smoothed objective, where the surrogate has a "
              "gradient",
       .choices = and_gradient_search(calomel::optimizers().names())});
    v("compare_objectives", compare_objectives,
      {.doc = "formulations whose results are compared with the calibration's, each run once in the true model", .choices = objectives().names()});
    v.renamed("compare_rounds", "each compared optimiser and objective always has four rounds");
    v.renamed("agreement", "results agree if they differ by no more than 5 % of the bounds");
    visit_mesh_correction(v, mesh_correction);
  }

 private:
  static std::vector<std::string> and_gradient_search(std::vector<std::string> names) {
    names.push_back(gradient_search);
    return names;
  }
};

/// Rounds of one optimiser together.
struct EncOptimizer {
  std::string name;
  int rounds = 0;
  double mean = 0, sd = 0, best = 0;  ///< of the objective after the last generation; sd is NaN for one round
  std::vector<double> trace;          ///< of its best round
};

struct EncSummary : Calibration {
  std::vector<EncRound> rounds;
  std::vector<EncOptimizer> optimizers;
  EncAgreement agreement;
  double agreement_s = 0;  ///< wall time of its searches and runs [s]
};

/// The rounds run side by side on `threads` threads; the result depends on the seed alone. `surrogate` and `true_model` have the shape of `problem`.
/// `correction`: for the mesh, of every prediction of either; null, or an empty one: as published.
/// Errors: InputError for an unknown optimiser or objective; what the models throw.
[[nodiscard]] EncSummary run_enc(const Problem& problem, const ForwardModel& surrogate, const ForwardModel& true_model, const EncOptions& options,
                                 std::uint64_t seed, int threads, const CalibrationProgress& progress = {}, const MeshCorrection* correction = nullptr);

/// The sentences of enc.json for people.
struct EncWords {
  CalibrationWords calibration;
  std::string agreement;  ///< whether other optimisers and objectives lead to the same answer; empty where none is compared
};

/// The contents of enc.json.
Json enc_json(const EncSummary& summary, const Problem& problem, const EncWords& words, const Provenance& provenance);
/// Writes enc.nc, then enc.json, into `out_dir`: time; calibrated, nominal (condition, sensor, time); record_time; record_mean, band_low,
/// band_high (condition, sensor, record_time).
void write_enc(const EncSummary& summary, const Problem& problem, const EncWords& words, const Provenance& provenance, const std::filesystem::path& out_dir);

}  // namespace calomel
