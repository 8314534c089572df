#pragma once
/// Maximum a posteriori by least squares: Gauss-Newton on whitened residuals from many starts on the surrogate, then secants of
/// the true model, its covariance, what the data pin and leave free, Laplace evidence, and whether the fit is adequate.
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "inverse/answer_spread.hpp"
#include "inverse/calibration.hpp"
#include "inverse/identify.hpp"
#include "inverse/map_models.hpp"
#include "inverse/map_rival.hpp"
#include "inverse/prior.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// `[map.unknowns]`: what no case file tells exactly and moves the records as much as the parameters do.
struct UnknownOptions {
  double young_sd = 0.015;
  double gauge_place_sd = 0.0004;

  template <class V>
  void visit(V& v) {
    v("young_sd", young_sd, {.range = between(0, 0.5), .doc = "relative sd of the steel's Young modulus about the case's; marginalised by secants of the model"});
    v("gauge_place_sd", gauge_place_sd, {.unit = "m", .range = between(0, 0.1), .doc = "sd of each gauge's place along its direction; marginalised likewise"});
  }
};

/// `[map]` of a case file.
struct MapOptions {
  std::string product = "tuned";
  int starts = 8;
  int design = 512;
  int candidates = 4;
  double separation = 0.03;
  bool polish = true;
  int polish_runs = 40;
  double secant = 1;
  bool widen = true;
  std::optional<double> mesh_error;
  int added_runs = 18;
  int mesh_pairs = 12;
  double mesh_beyond = 1;
  double mesh_beyond_sd = 0.5;
  double stable = 0.25;
  bool screen = true;
  std::string compare_with;
  LikelihoodOptions likelihood;
  DiscrepancyOptions discrepancy;
  UnknownOptions unknowns;

  template <class V>
  void visit(V& v) {
    v("product", product,
      {.doc = "tuned: the case's own priors, no discrepancy, not a material property; physical: handbook priors and a discrepancy",
       .choices = {"tuned", "physical"}});
    v("starts", starts, {.range = between(1, 1000), .doc = "least-squares searches on the surrogate, from the best points of a design"});
    v("design", design, {.range = between(1, 100000), .doc = "points of the design on which starts are chosen"});
    v("candidates", candidates, {.range = between(1, 50), .doc = "best distinct optima that are run in the true model"});
    v("separation", separation,
      {.range = between(0, 0.5), .doc = "least distance of two candidates, the largest over the parameters in units of their bounds"});
    v("polish", polish, {.doc = "improve the best candidate on the true model itself"});
    v("polish_runs", polish_runs, {.range = at_least(0), .doc = "at most so many runs of the true model for that"});
    v("secant", secant, {.range = between(0.3, 3), .doc = "half width of the true model's secants, which is rough: in posterior standard deviations, and at least in units of 1.5 % of density, 3 % of sound speed, 35 % of the cutoff"});
    v("widen", widen, {.doc = "multiply the covariance by chi-squared over its expectation where the fit is not adequate"});
    v("mesh_error", mesh_error,
      {.range = between(0, 1), .doc = "error of the mesh over the local amplitude where no finer mesh has measured it; default 0.08 per millimetre of element size"});
    v("added_runs", added_runs,
      {.range = between(0, 200), .doc = "at most so many runs of the true model added to the campaign near the optimum and where the surrogate is unsure"});
    v("mesh_pairs", mesh_pairs,
      {.range = between(0, 20),
       .doc = "at most so many of them paired with a run of half the element size, 8 times as costly (16 in three dimensions): they tell the mesh's error; 0 takes mesh_error for granted"});
    v("mesh_beyond", mesh_beyond,
      {.range = between(0, 3), .doc = "how far beyond the finer mesh the records lie, in units of (finer - working): 0 on it, 1 at vanishing elements where errors fall with the element size"});
    v("mesh_beyond_sd", mesh_beyond_sd, {.range = between(0, 3), .doc = "standard deviation of that multiple; marginalised"});
    v("stable", stable, {.range = above(0), .doc = "no more runs are added once the optimum has moved by less than this since the last ones, in posterior standard deviations, or twice running by less than the model's roughness moves it"});
    v("screen", screen,
      {.doc = "look whether the residual at the answer points where a mechanism that the case does not enable would show, by secants of the true model: two runs a key, about two dozen"});
    v("compare_with", compare_with,
      {.doc = "output directory of a finished fit of the same records by a model with fewer of these parameters, relative to the case: both are judged under one covariance"});
    v.table("likelihood", likelihood, "covariance of data and model");
    v.table("discrepancy", discrepancy, "what the model leaves out, for the physical product");
    v.table("unknowns", unknowns, "nuisances of the target and its gauges");
  }
};

/// A round of added runs and where the optimum stood after it.
struct RefinementRound {
  int runs = 0, pairs = 0;    ///< added so far
  int failed = 0;             ///< of them
  std::vector<double> theta;  ///< the optimum with them
  double moved = 0;           ///< since the round before, largest over the parameters, in posterior sds
  double roughness = 0;       ///< sd of that parameter's optimum by how rough one run is, likewise; smaller moves tell of nothing else
};

/// Whether the parameters of pairs that the search does not know are found; see validate_pairs.
struct PairValidation {
  std::vector<FoundPair> pairs;  ///< nearest to the optimum first
  Eigen::MatrixXd residuals;  ///< of their records at `found`, on the likelihood's grid, (values, pairs)
  double inflation = 1;     ///< factor of the covariance
  std::string sentence;     ///< empty where nothing was judged
};

/// What added runs and pairs of meshes did.
struct MapRefinement {
  std::vector<double> before;           ///< the optimum without them
  std::vector<RefinementRound> rounds;
  bool stable = false;
  PairValidation validation;
  Eigen::VectorXd moves_share;          ///< of each parameter's variance, what spread_of_rounds adds; empty where nothing was judged
  double base_ratio = 0;                ///< RefinedModel::base_ratio
  double mesh_difference = 0;           ///< |fine - working| / |working| at the optimum, mean over the observations
  Eigen::VectorXd next_halving;         ///< what one more halving would move each parameter by, in its sd; empty without pairs
  std::string sentence;
};

struct MapSummary : Calibration {
  Eigen::MatrixXd covariance;              ///< (n, n), in the parameters' own units, widened where the fit is not adequate
  double widening = 1;                     ///< factor in it for a misfit
  double curvature_seen = 1;               ///< see seen_curvature; the covariance is divided by it where it is below 1
  double roughness = 0;                    ///< sd of the difference of log posteriors by surrogate and true model over the candidates; their spread, weighed at this
                                           ///< temperature, is part of the covariance
  double log_likelihood = 0, log_prior = 0;
  double log_evidence_laplace = 0;
  double chi2 = 0;                         ///< whitened; its expectation is `values` less the parameters
  std::size_t values = 0;                  ///< compared, after decimation
  double effective_data = 0;               ///< ErrorDistribution::effective_data
  double effective_chi2 = 0;               ///< expectation effective_data
  double p_value = 0, effective_p_value = 0;  ///< share of replicated data that would fit worse
  double chi2_critical = 0;                ///< above which chi2 alone would have called the fit not adequate; 0 where it did
  bool adequate = false;                   ///< neither chi2 nor the screening speaks against the fit
  std::string adequacy;                    ///< in a sentence
  std::optional<Screening> screening;      ///< with map.screen also by mechanisms
  Identification identification;           ///< which combination the data pin and which they leave free
  double discrepancy_scale = 0;            ///< s of the physical product
  std::vector<std::pair<double, double>> discrepancy_weights;  ///< (s, posterior weight)
  double scale_spread = 0;                 ///< what the spread over the scales adds to the covariance, over its trace
  std::vector<std::pair<std::string, double>> shares;          ///< of the covariance's trace, by source
  double energy_sd = 0, split_half = 1;    ///< of the replicates
  std::vector<double> noise_time;          ///< correlation time of each observation's noise [s]
  MapRefinement refinement;
  double gradient = 0;                     ///< largest slope of the log posterior on the surrogate at its optimum, times the parameter's sd; NaN without
  int polish_steps = 0;
  std::optional<RivalComparison> rival;    ///< with map.compare_with
};

/// Errors: InputError for a product that the priors do not allow; NumericsError when no point can be evaluated.
[[nodiscard]] MapSummary run_map(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const MapModels& models,
                                 const MapOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress = {});

/// The contents of map.json.
Json map_json(const MapSummary& summary, const Problem& problem, const Provenance& provenance);
/// Writes map.nc, then map.json; see write_calibration.
void write_map(const MapSummary& summary, const Problem& problem, const Provenance& provenance, const std::filesystem::path& out_dir);

}  // namespace calomel
