#pragma once
/// Maximum a posteriori: the mode of the posterior on the multilevel emulator, verified by runs of the true model, with what the data pin and leave free,
/// whether the fit is adequate, where the residual points, and the evidence of a nested model.
#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "inverse/calibration/calibration.hpp"
#include "inverse/map/nested_model.hpp"
#include "inverse/posterior/goodness_of_fit.hpp"
#include "inverse/posterior/identifiability.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/posterior/score_test.hpp"
#include "inverse/posterior/true_model_check.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// `[map]` of a case file.
struct MapOptions {
  std::string product = "tuned";
  bool score_tests = true;
  std::string compare_with;

  template <class V>
  void visit(V& v) {
    v("product", product,
      {.doc = "of the posterior, its mode and its samples. tuned: the case's own priors, no discrepancy, not a material property; physical: handbook priors "
              "and a discrepancy",
       .choices = {"tuned", "physical"}});
    v("score_tests", score_tests,
      {.doc = "score tests: whether the residual at the mode resembles the effect of a mechanism that the case does not enable; one or two runs a key on the "
              "next to finest mesh, about two dozen"});
    v.renamed("screen", "map.score_tests");
    v("compare_with", compare_with,
      {.doc = "output directory of a finished MAP of the same records by a model with fewer of these parameters, relative to the case: gives the Bayes factor "
              "of the two on one emulator and one covariance"});
    for (const char* gone : {"starts", "design", "candidates", "separation", "polish", "polish_runs", "secant"})
      v.renamed(gone, "the mode is found on the emulator, by [emulator] start, coarse_runs, fine_runs and rounds");
    for (const char* gone : {"added_runs", "mesh_pairs"}) v.renamed(gone, "the runs are those of [emulator]: element_sizes, coarse_runs, fine_runs, rounds");
    v.renamed("mesh_beyond", "errors.beyond");
    v.renamed("mesh_beyond_sd", "errors.beyond_sd");
    v.renamed("mesh_error", "errors.mesh");
    v.renamed("stable", "emulator.stable");
    v.renamed("widen", "nothing is multiplied afterwards: set the errors in [errors]");
    v.renamed("likelihood", "[errors]: values, band, energy_scale_sd, gain_sd, baseline, coherent_noise for all methods");
    v.renamed("discrepancy", "errors.discrepancy, errors.discrepancy_times, errors.discrepancy_distance");
    v.renamed("unknowns", "errors.young_sd, errors.gauge_place_sd");
  }
};

/// The posterior of a coordinate that is no parameter of the case.
struct Nuisance {
  std::string name;
  double value = 0, sd = 0;
  double prior_value = 0, prior_sd = 0;  ///< of a lognormal prior its median, and the sd of the logarithm times it
  double deviation = 0;                  ///< from the centre of the prior, in standard deviations of the prior
};

/// Candidates are the modes, best first by the emulator: a run verifies an answer and does not choose it, for the best of several runs is the luckiest.
struct MapSummary : Calibration {
  Eigen::MatrixXd covariance;       ///< of the case's parameters, Laplace, (n, n), in their own units
  std::vector<Nuisance> nuisances;  ///< regularising viscosity, multiple beyond the finest mesh
  double log_likelihood = 0, log_prior = 0;
  double log_evidence_laplace = 0;
  GoodnessOfFit fit;
  bool adequate = false;  ///< neither chi-squared nor the score tests speak against the fit
  std::optional<ScoreTests> score_tests;
  Identification identification;
  std::optional<NestedModel> nested;
  TrueModelCheck check;
};

/// `left_out`: what mechanisms would do to the model's values at a point; empty: no score tests. `nested`: what is known of the nested model of `fit`, or null.
/// The fit and the inputs outlive nothing: all that is kept is copied. The message and the warnings about the mode are left to apps/presentation; `warnings`
/// are those of the problem and of the inputs.
[[nodiscard]] MapSummary run_map(const PosteriorInputs& in, const PosteriorFit& fit, const std::string& product,
                                 const std::function<std::vector<MechanismDirections>(std::span<const double>)>& left_out, const NestedModel* nested);

/// The sentences of map.json for people.
struct MapWords {
  CalibrationWords calibration;
  std::string adequacy;     ///< whether the records contradict the fit
  std::string check;        ///< how far runs of the true model lie from the emulator
  std::string nested;       ///< which of the nested models is favoured; empty without one
  std::string identified;   ///< which products of the parameters the data determine
  std::string score_tests;  ///< where the residual points; empty without score tests
  std::string emulator;     ///< whether the emulator has settled
};

/// The contents of map.json.
Json map_json(const MapSummary& summary, const PosteriorInputs& in, const PosteriorFit& fit, const MapWords& words, const Provenance& provenance);
/// Writes map.nc, then map.json; see write_calibration.
void write_map(const MapSummary& summary, const PosteriorInputs& in, const PosteriorFit& fit, const MapWords& words, const Provenance& provenance,
               const std::filesystem::path& out_dir);

}  // namespace calomel
