#pragma once
/// Sparse polynomial expansion calibration: many sparse polynomial surrogates of the misfit, the optima of all pooled, the modes of
/// their density re-run in the true model. Seed paper, section "Sparse Polynomial Expansions"; Radaideh et al.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "forward/campaign/archive.hpp"
#include "inverse/calibration/calibration.hpp"
#include "inverse/spe/modes.hpp"
#include "inverse/spe/surrogates.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// An optimum of one surrogate.
struct SpeOptimum {
  std::size_t surrogate = 0;  ///< index into SpeSummary::surrogates
  std::vector<double> theta;  ///< (n_parameters)
  double objective = 0;       ///< by that surrogate
  int trials = 0;             ///< searches that ended here
};

struct SpeMode {
  std::vector<double> theta;  ///< (n_parameters)
  double objective = 0;       ///< median over the surrogates
  double density = 0;         ///< of the pooled optima, relative to all of them in one place
  std::size_t optima = 0;     ///< that belong to it
};

/// A round of shrinking: the box of its surrogates, the runs in it, and the least misfit known by then.
struct SpeZoom {
  std::vector<double> low, high;   ///< (n_parameters)
  std::size_t runs = 0, made = 0;  ///< in the box, and of them new in this round
  double best = 0;                 ///< of all known runs, as the objective has it
};

struct SpeSummary : Calibration {
  std::size_t runs_used = 0, runs_excluded = 0;  ///< of the campaign
  std::size_t n_train = 0, n_validation = 0;
  std::size_t runs_added = 0;  ///< true-model runs of earlier rounds that joined the campaign's: candidates, those of shrunken boxes
  std::string design;
  std::vector<SpaceChoice> spaces;
  std::vector<SparsePolynomial> surrogates;
  std::vector<SpeOptimum> optima;   ///< of all surrogates
  std::vector<SpeMode> modes;       ///< densest first
  std::size_t optima_left_out = 0;  ///< of the last round, where runs are likely to fail
  std::vector<SpeZoom> zooms;
  std::vector<std::string> fit_warnings;  ///< of the last fits; they are among `warnings` too
  double fit_s = 0;                       ///< wall time of the fits, of search_s [s]
};

/// The misfit of every usable run at its point of the unit box, split into training and held-out runs by `seed` as the train stage does.
/// Errors: InputError for fewer than 8 usable runs, or a misfit that has no logarithm.
ScatteredData discrepancies(const Problem& problem, const Archive& archive, const Objective& objective, const SpeOptions& options, std::uint64_t seed,
                            std::size_t* excluded = nullptr);

/// The surrogates, optima and modes of the summary are those of the last of 1 + options.zoom + options.refinements rounds; its candidates are the best of
/// all rounds. Fits and searches run on `threads` threads; the result depends on the seed alone. `archive`, `true_model` and `problem` have one
/// shape; runs of the archive that failed are left out. `correction`: for the mesh, of every history; null, or an empty one: as published. Errors: InputError
/// for an unknown objective, too few runs, or when every coefficient of every surrogate vanishes.
[[nodiscard]] SpeSummary run_spe(const Problem& problem, const Archive& archive, const ForwardModel& true_model, const SpeOptions& options, std::uint64_t seed,
                                 int threads, const CalibrationProgress& progress = {}, const MeshCorrection* correction = nullptr);

/// The contents of spe.json.
Json spe_json(const SpeSummary& summary, const Problem& problem, const Provenance& provenance);
/// Writes spe.nc (as enc.nc), then spe.json, into `out_dir`.
void write_spe(const SpeSummary& summary, const Problem& problem, const Provenance& provenance, const std::filesystem::path& out_dir);

}  // namespace calomel
