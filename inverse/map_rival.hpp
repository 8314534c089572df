#pragma once
/// Two fits of the same records, one by a model that the other's holds as a special case, judged by one yardstick: the same pairs of meshes, the same
/// covariance, the same runs of the true model.
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "inverse/calibration.hpp"
#include "inverse/map_models.hpp"

namespace calomel {

struct MapOptions;

/// An earlier fit that sought some of this problem's parameters and held the others at their nominal values.
struct RivalFit {
  std::string name;                ///< where it stands
  std::vector<std::string> sought; ///< its parameters
  std::vector<double> theta;       ///< its answer, in this problem's parameters
  std::vector<double> history;     ///< what its model said there, (values); empty: not compared
  std::vector<AddedRun> runs;      ///< in this problem's parameters
  double discrepancy_scale = 0;    ///< of the physical product
};

/// What a hypothesis is worth under a covariance.
struct JudgedFit {
  std::vector<double> theta;  ///< the best that was run, in this problem's parameters
  double log_likelihood = 0, log_posterior = 0;
  double log_evidence = 0;    ///< Laplace, of the prior's mass within the bounds
  double chi2 = 0;
};

/// Both hypotheses under the same covariance.
struct SharedJudgement {
  std::string covariance;  ///< in words: whose
  JudgedFit smaller, larger;
  double roughness = 0;    ///< sd of log_bayes_factor by how rough the model is, as seen at the secants' points
  [[nodiscard]] double log_bayes_factor() const { return larger.log_evidence - smaller.log_evidence; }
};

enum class RivalVerdict { undecided, added_favoured, added_not_favoured };

struct RivalComparison {
  std::string rival;                        ///< RivalFit::name
  std::vector<std::string> added;           ///< the parameters that only the larger model has
  std::vector<SharedJudgement> judgements;  ///< under the mean covariance, that at the smaller's answer, that at the larger's
  std::size_t values = 0, model_runs = 0;
  double log_bayes_factor = 0;  ///< under the mean; above 0 for the larger model
  double low = 0, high = 0;     ///< over the covariances, two sds of the roughness, and priors of the added parameters half and twice as wide
  double prior_change = 0;      ///< of which by these priors
  RivalVerdict verdict = RivalVerdict::undecided;
  std::string sentence;
};

/// Judges this problem's fit at `theta` and `rival` by one yardstick. The pairs of meshes of both fits (`runs` and rival.runs) make one shift for both;
/// covariances are taken at either answer and their mean is the one that counts, the two themselves tell how much hangs on it. Under each, both hypotheses
/// are polished on the true model, each from its own answer and from the other's with the added parameters as they are held, so that neither is
/// judged where the other's covariance put it; only points that were run count, never the secants' extrapolation. Evidence is Laplace's with the secants'
/// curvature and the share of that Gaussian within the bounds. `scale`: of the discrepancy of the own fit.
/// `models`: without surrogate. Errors: InputError when the rival sought a parameter that is not this problem's, or all of them, or when this model at its
/// nominal values is not the rival's; NumericsError when no point of a hypothesis can be run.
[[nodiscard]] RivalComparison compare_with_rival(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options,
                                                 const MapModels& models, const MapOptions& options, const std::vector<double>& theta, double scale,
                                                 const std::vector<AddedRun>& runs, const RivalFit& rival, std::uint64_t seed, int threads,
                                                 const CalibrationProgress& progress = {});

/// For map.json.
Json rival_json(const RivalComparison& comparison, const ModelShape& shape);

}  // namespace calomel
