#pragma once
/// The posterior from runs of the true model: places the emulator's box, makes runs at the most informative points, and fits until the answer is stable.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "forward/simulation/inference_hints.hpp"
#include "forward/simulation/run_record.hpp"
#include "inverse/posterior/mode.hpp"

namespace calomel {

/// `[emulator]`: the runs that the emulator of the posterior is trained on.
struct EmulatorOptions {
  std::vector<double> element_sizes;
  double viscosity = 2000;
  double viscosity_sd = 0.6;
  int coarse_runs = 0;
  int fine_runs = 0;
  int round_coarse = 8;
  int round_fine = 4;
  int rounds = 12;
  double enough = 0.3;
  double stable = 0.25;
  std::string start = "auto";
  int check_coarse = 2;
  int check_fine = 2;

  template <class V>
  void visit(V& v) {
    v("element_sizes", element_sizes,
      {.unit = "m",
       .range = above(0),
       .doc = "of the meshes whose runs train the emulator, finest last; default: the case's element_size and its half. The result is that of the last one"});
    v("viscosity", viscosity,
      {.unit = "Pa s",
       .range = above(0),
       .doc = "median of the prior of the regularising viscosity, which is a coordinate of the posterior, the same on all meshes"});
    v("viscosity_sd", viscosity_sd, {.range = between(0, 3), .doc = "prior sd of its logarithm; 0 holds it"});
    v("coarse_runs", coarse_runs, {.range = between(0, 10000), .doc = "runs of each coarser mesh to begin with; 0 = four a coefficient of the emulator"});
    v("fine_runs", fine_runs, {.range = between(0, 10000), .doc = "runs of the finest mesh to begin with; 0 = four a coefficient of its own"});
    v("round_coarse", round_coarse, {.range = between(0, 1000), .doc = "runs of the next coarser mesh in each later round"});
    v("round_fine", round_fine, {.range = between(0, 1000), .doc = "runs of the finest mesh in each later round"});
    v("rounds", rounds, {.range = between(0, 100), .doc = "later rounds at most"});
    v("enough", enough,
      {.range = above(0),
       .doc = "no more runs once the emulator's variance, in units of one run's numerical noise, is below this over the posterior and the mean is stable"});
    v("stable", stable, {.range = above(0), .doc = "the mean is stable if a round changes it by less than this, in standard deviations"});
    v("start", start,
      {.doc = "middle of the first box: the nominal values, the best point of the campaign's surrogate, or the one where every parameter has a prior and the "
              "other where not (auto)",
       .choices = {"auto", "nominal", "surrogate"}});
    v("check_coarse", check_coarse,
      {.range = between(0, 1000), .doc = "runs of the next coarser mesh at the mode and at draws that hold the emulator against the true model"});
    v("check_fine", check_fine, {.range = between(0, 1000), .doc = "those of the finest mesh"});
  }
  /// Errors: InputError for sizes that do not fall.
  void validate() const;
  /// Runs of the finest mesh, and of each coarser one, that a box of so many parameters begins with: those of the options, or four a coefficient that the mesh
  /// determines. With fewer the residuals underestimate the noise (docs/benchmarks/posterior.md). The finest of several meshes adds a linear difference, a mesh
  /// alone determines everything.
  [[nodiscard]] int finest_to_begin(Eigen::Index parameters, int levels) const;
  [[nodiscard]] int coarser_to_begin(Eigen::Index parameters) const;
};

/// A run on which the emulator may be trained.
struct TrainingRun {
  std::vector<double> theta;
  int level = 0;
  RunRecord record;
};

/// Where the gauges are [m]; empty where they have no place, or the target no faces.
struct GaugePlaces {
  Eigen::MatrixXd positions;  ///< (sensors, 3)
  Eigen::MatrixXd outermost;  ///< (2, 3): the target's least and greatest coordinates
};

/// What the set-up of a posterior found that its user should know.
struct SetupFindings {
  std::vector<std::string> uniform_priors;  ///< parameters of an external model that may imitate what the model leaves out
  double jitter_standard_errors = 0;        ///< by which two runs of nearly one point differ, where the model does not repeat itself; 0: it does
};

/// How the box of the emulator is placed and resized from round to round.
struct BoxStrategy {
  enum class Kind {
    /// Runs are expensive and carry numerical noise. The box follows the mode where that nears an edge, and never shrinks.
    follow,
    /// Runs cost little and carry no numerical noise, so that what the emulator misses is the curvature of the model over its box. The box shrinks about the
    /// mode.
    shrink,
    /// As `shrink`. A diagnosis places each box where multistart least squares with the model itself ends, and holds the fit to the model there.
    least_squares
  };
  Kind kind = Kind::follow;
  /// Least distance between the mode and an edge of a box that follows it, in standard deviations of the posterior; nearer, the box is placed again. A box that
  /// shrinks has 1, since the deviations still shrink from round to round.
  double clear_of_edge = 2;
  /// Variance of one run about the model's mean, summed over the values compared, where the model does not repeat itself. No narrower box removes it, so that
  /// it never makes a box shrink.
  double run_variance = 0;

  [[nodiscard]] bool shrinks() const { return kind != Kind::follow; }
  [[nodiscard]] bool by_least_squares() const { return kind == Kind::least_squares; }
};

/// What a fit works on; what is referred to outlives it.
struct PosteriorInputs {
  const Problem& problem;
  const Recordings& recordings;
  const RecordingOptions& recording_options;
  ErrorOptions errors;
  EmulatorOptions emulator;
  std::vector<Parameter> parameters;  ///< with their final priors, the viscosity among them where it has one
  int levels = 1;                     ///< meshes
  int pulses = 1;                     ///< whose mean a run is
  double energy_sd = 0;               ///< relative, from pulse to pulse
  GaugePlaces places;
  /// Runs the columns of thetas (n_parameters, n), each on its level's mesh, 0 the finest.
  std::function<std::vector<RunRecord>(const Eigen::MatrixXd& thetas, const std::vector<int>& level)> run;
  /// Changes of the model's values by one sd of each gauge's place, (values, gauges); empty: none.
  std::function<Eigen::MatrixXd(std::span<const double> theta)> gauge_places;
  std::vector<double> centre;      ///< (n_parameters) of the first box
  std::vector<double> half_width;  ///< (n_parameters) of it, in the coordinates of the parameters
  bool discrepancy = false;        ///< whether a discrepancy is marginalised: the physical product
  double mesh = 0;                 ///< error of the mesh over the local amplitude that is taken for granted where there is one mesh only
  BoxStrategy box;
  /// A nested hypothesis, by these parameters (index, value) held, and its assumed place, (n_parameters); both empty where there is none.
  std::vector<std::pair<Eigen::Index, double>> held;
  std::vector<double> nested_centre;
  std::vector<TrainingRun> known;          ///< runs that are there already
  std::size_t known_dimension = 0;         ///< they differ in the first so many parameters
  std::vector<std::string> identified;     ///< InferenceHints::identified
  std::vector<PowerProduct> combinations;  ///< InferenceHints::combinations
  SetupFindings findings;
  std::vector<std::string> warnings;  ///< what is known against the meshes; goes with the answers
  std::uint64_t seed = 1;

  /// Number of runs of the finest mesh that a box of so many parameters begins with: those of the emulator's options, of a box that shrinks at least twice its
  /// coefficients.
  [[nodiscard]] int finest_to_begin(Eigen::Index parameters) const;
  /// Of the runs that a box begins with on a mesh, greatest number that known ones may replace: the share of its coefficients that their parameters have.
  /// `linear`: of a mesh that adds a linear difference.
  [[nodiscard]] int stood_for(int runs, bool linear) const;
};

/// One round: its runs and the mode after it.
struct PosteriorRound {
  int coarse = 0, fine = 0, failed = 0;  ///< runs so far
  std::vector<double> theta;             ///< the mode
  Eigen::VectorXd sd;                    ///< of u
  std::vector<double> theta_sd;          ///< of theta
  double moved = 0;                      ///< of the mode since the round before, largest over the parameters in sds
  double variance = 0;                   ///< the emulator's over draws from the posterior, 95 % quantile
  bool moved_box = false;                ///< after it
  bool shrank_box = false;               ///< after it
};

/// Leave-one-out errors of one level.
struct LevelError {
  int runs = 0;
  double left_out = 0;  ///< |left out - run| / |run|, root mean square over runs, on the posterior's grid
  double noise = 0;     ///< of the residuals, likewise, their freedom counted
};

/// Whether the emulator of a fit has settled, and its last round.
struct Settling {
  bool settled = false;
  int coarse = 0, fine = 0;  ///< runs
  double moved = 0;          ///< of the mode in the last round, in standard deviations
  double variance = 0;       ///< of the emulator, in units of one run's noise
};

struct PosteriorFit {
  std::optional<LogPosterior> posterior;
  std::optional<ErrorModel> errors;        ///< without a discrepancy
  std::vector<WeightedErrors> hypotheses;  ///< of the posterior: `errors`, and with a discrepancy of each scale and correlation time
  std::vector<LocalMode> modes;            ///< best first
  std::optional<LogPosterior> nested;      ///< with PosteriorInputs::held, on the same emulator and under the same errors
  std::vector<LocalMode> nested_modes;
  std::vector<TrainingRun> runs;  ///< all; those of `used` lie in the box
  std::vector<std::size_t> used;
  Eigen::MatrixXd coefficients;  ///< of the emulator on the grid of `errors`, (size, coefficients)
  Eigen::VectorXd run_at_mode;   ///< (values of the model), of a fit that is held_to_the_model(); else empty
  Eigen::MatrixXd noise;         ///< numerical noise of one run of the finest mesh, (size, size)
  std::vector<PosteriorRound> rounds;
  std::vector<LevelError> levels;
  bool settled = false;

  /// Whether the emulator has settled, and its last round; zeros before the first one.
  [[nodiscard]] Settling settling() const;
  /// Of the runs in use, as columns: their means, or another of their fields, (values of the model, used).
  [[nodiscard]] Eigen::MatrixXd histories(const std::vector<float> RunRecord::*what = &RunRecord::mean) const;
  /// The emulator's history at a point, (values of the model), the records' place beyond the finest mesh or, without it, the finest mesh.
  [[nodiscard]] Eigen::VectorXd history(const Eigen::VectorXd& u, double beyond) const;
  /// The prediction of the emulator at a point, (size) on the grid.
  [[nodiscard]] Eigen::VectorXd prediction(const LogPosterior::Point& at) const;
  /// The hypothesis about the errors that is likeliest at the highest mode.
  [[nodiscard]] const WeightedErrors& likeliest() const { return hypotheses[posterior->likeliest(modes[0].at)]; }
  /// The history of the mode, (values of the model): the run there, or the emulator's.
  [[nodiscard]] Eigen::VectorXd history_at_mode() const;
  /// The posterior on the same emulator, with the same priors, under other errors.
  [[nodiscard]] LogPosterior under(const std::vector<WeightedErrors>& errors) const;
};

/// Follows a fit.
struct FitWatch {
  std::function<void(const PosteriorRound&)> round_done;  ///< called after every round; may be empty
  std::function<bool(const PosteriorFit&)> go_on;         ///< called before every further round; false ends the fit; may be empty
};

/// Errors: NumericsError when too few runs come through; those of `run`.
[[nodiscard]] PosteriorFit fit_posterior(const PosteriorInputs& in, const FitWatch& watch = {});

}  // namespace calomel
