#pragma once
/// The errors of mean records and of the models behind them, as a list of named Gaussian covariances on one coarse grid. Every term occurs once.
#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/options.hpp"
#include "inverse/data/decimation.hpp"
#include "inverse/data/replicate_noise.hpp"
#include "inverse/data/problem.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

/// `[errors]`: what is known of the records' and the model's errors, for all methods alike.
struct ErrorOptions {
  int values = 800;
  double band = 20e3;
  double energy_scale_sd = 0.015;
  double gain_sd = 0.01;
  double baseline = 1;
  double coherent_noise = 0.1;
  double young_sd = 0.015;
  double wall_film = 5e-5;
  double wall_film_sd = 7e-5;
  double gauge_place_sd = 0.0004;
  double trigger_sd = 0;
  double beyond = 0.15;
  double beyond_sd = 0.15;
  double beyond_rest = 0.5;
  double record_noise = 1;
  std::optional<double> mesh;
  double discrepancy = 0.1;
  std::vector<double> discrepancy_times{15e-6, 40e-6};
  double discrepancy_distance = 0.03;
  double amplitude_time = 25e-6;
  std::optional<double> arrival_share;

  template <class V>
  void visit(V& v) {
    v("values", values,
      {.range = between(10, 4000), .doc = "at most so many values of all gauges; records and simulations are decimated to them by one filter"});
    v("band", band, {.unit = "Hz", .range = above(0), .doc = "frequency up to which records are compared"});
    v("energy_scale_sd", energy_scale_sd, {.range = between(0, 0.5), .doc = "relative sd of the absolute pulse energy, common to all gauges; marginalised"});
    v("gain_sd", gain_sd, {.range = between(0, 0.5), .doc = "relative sd of each gauge's gain; marginalised. Of a line and of an external model 0"});
    v("baseline", baseline, {.range = at_least(0), .doc = "sd of each gauge's baseline in units of its noise; marginalised"});
    v("coherent_noise", coherent_noise, {.range = between(0, 1), .doc = "sd of the part of the noise that all pulses share, over that of one pulse"});
    v("young_sd", young_sd,
      {.range = between(0, 0.5),
       .doc = "relative sd of the steel's Young modulus about the case's, which is a coordinate of the posterior: it moves resonances, which no first order "
              "follows over a record; 0 holds it"});
    v("wall_film", wall_film,
      {.unit = "m",
       .range = between(0, 5e-4),
       .doc =
           "mercury that remains on a wetted wall when it cavitates there (material.mercury.wall_film); its thickness is unknown and it adds mass to the wall: "
           "prior mean"});
    v("wall_film_sd", wall_film_sd,
      {.unit = "m", .range = between(0, 5e-4), .doc = "its prior sd; it is a coordinate of the posterior, as the modulus is; 0 holds it at the case's own"});
    v("gauge_place_sd", gauge_place_sd,
      {.unit = "m", .range = between(0, 0.1), .doc = "sd of each gauge's place along its direction; marginalised to first order"});
    v("trigger_sd", trigger_sd,
      {.unit = "s",
       .range = at_least(0),
       .doc = "sd of the instant on the record's clock at which the simulation starts (recordings.trigger_offset), the same for all gauges; marginalised to "
              "first order. 0: exactly known"});
    v("beyond", beyond,
      {.range = between(-1, 3), .doc = "multiple of the difference between the two finest meshes that is added to the finest mesh: prior mean"});
    v("beyond_sd", beyond_sd, {.range = between(0, 3), .doc = "prior sd of that multiple, which is a coordinate of the posterior; 0 holds it"});
    v("beyond_rest", beyond_rest, {.range = between(0, 3), .doc = "error of the mesh that no multiple of that difference removes, over its local amplitude"});
    v("record_noise", record_noise,
      {.range = between(0, 10),
       .doc = "numerical noise that the records carry as one realisation of a chaotic law, its sd over that of a run of the finest mesh about the emulator; of "
              "a gauge whose noise is given times sqrt(campaign.pulses / pulses recorded)"});
    v("mesh", mesh,
      {.range = between(0, 1),
       .doc = "error of the mesh over the local amplitude where the emulator has one mesh only, which no run measures; default 0.08 per millimetre of element "
              "size"});
    v("discrepancy", discrepancy,
      {.range = between(0, 1),
       .doc = "omitted physics, for the physical product: scale of the half-normal prior of its sd over the local amplitude of the mean record; "
              "marginalised"});
    v("discrepancy_times", discrepancy_times,
      {.unit = "s", .range = above(0), .doc = "its correlation times (Matern 3/2), each as likely as the others", .least_size = 1});
    v("amplitude_time", amplitude_time,
      {.unit = "s",
       .range = above(0),
       .doc = "averaging time of the local amplitude, for the discrepancy and the errors of mesh and emulator; far below the record's length"});
    v("arrival_share", arrival_share,
      {.range = between(0, 1),
       .doc = "before the first value of a record that exceeds this share of its greatest value the model omits nothing; default 0.05, for a line 0, because "
              "the omitted effect may be the wave speed"});
    v("discrepancy_distance", discrepancy_distance,
      {.unit = "m", .range = above(0), .doc = "distance over which neighbouring gauges share it, exp(-distance)"});
  }
};

/// Correlation along a record by the distance in time [s].
using TimeKernel = std::function<double(double seconds)>;
/// Matern 3/2, of physics left out.
TimeKernel matern32(double time);
/// White noise behind the grid's filter: the autocorrelation of its Hann window, 1/6 at the distance of two windows and 0 at twice that. Of the mesh's error,
/// whose correlation along a record is 0.27, 0.17 and 0.05 over 1, 2 and 3 us, and which gauges do not share (docs/benchmarks/mesh_error.md).
TimeKernel white_noise(const Decimation& grid);

/// Names of the terms for the mesh and for the numerical noise.
inline constexpr const char* beyond_term = "beyond the finest mesh";
inline constexpr const char* mesh_term = "mesh";
inline constexpr const char* record_noise_term = "numerical noise of the records";

/// A Gaussian error, (size, size) on the coarse grid.
struct ErrorTerm {
  std::string name;
  Eigen::MatrixXd covariance;
};

/// A number that is marginalised: what one standard deviation of it does to the records, (size).
struct MarginalDirection {
  std::string term;   ///< of the covariance
  std::string gauge;  ///< Problem::label of the observation, a gauge or a condition; empty: of all records
  Eigen::VectorXd change;
};

/// What the model knows of itself: what moves its values to first order, on its own output times, and what a run is.
struct ErrorDirections {
  Eigen::VectorXd energy_slope;     ///< (values) by relative pulse energy, or empty: strain in proportion to energy
  Eigen::MatrixXd gauge_places;     ///< (values, gauges): by one sd of each gauge's place
  Eigen::VectorXd last_difference;  ///< (values): finest mesh less the next coarser one, or empty
  double mesh = 0;                  ///< error of the mesh over the local amplitude that is taken for granted, where there is one mesh only
  int pulses = 1;                   ///< whose mean a run is
  double energy_sd = 0;             ///< relative, from pulse to pulse, if the recordings do not contain it
};

/// Mean records on the coarse grid and the covariance of all errors between them and the emulator's mean.
class ErrorModel {
 public:
  /// Errors: InputError for a single pulse without noise.
  ErrorModel(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const ErrorOptions& options,
             const ErrorDirections& directions);

  [[nodiscard]] const Decimation& grid() const { return grid_; }
  [[nodiscard]] const ReplicateNoise& noise() const { return noise_; }
  /// Mean records, (size), carried to mean energy 1 where a gauge lacks pulses.
  [[nodiscard]] const Eigen::VectorXd& data() const { return data_; }
  [[nodiscard]] const std::vector<ErrorTerm>& terms() const { return terms_; }
  /// Of those terms that are sums over numbers.
  [[nodiscard]] const std::vector<MarginalDirection>& directions() const { return directions_; }
  /// Sum of the terms.
  [[nodiscard]] Eigen::MatrixXd covariance() const;
  /// Degrees of freedom of the covariance's scale: the noise's, diluted by what is known otherwise (Satterthwaite 1946); infinity for a Gaussian.
  [[nodiscard]] double freedom() const;
  /// With one more term.
  [[nodiscard]] ErrorModel with(ErrorTerm term) const;
  /// With the numerical noise of the records, `errors.record_noise` times that of a run, whose covariance is `noise`, (size, size). Repeats show how it differs
  /// from pulse to pulse; where a gauge has none, its records carry that of so few pulses, sqrt(pulses of a run / pulses recorded) times that of a run.
  [[nodiscard]] ErrorModel with_record_noise(const Eigen::MatrixXd& noise) const;
  /// About records that are less by `change`, (size): of a model whose values are more by it.
  [[nodiscard]] ErrorModel less(const Eigen::VectorXd& change) const;
  /// Without the term of this name, where there is one.
  [[nodiscard]] ErrorModel without(std::string_view name) const;
  /// Shares of the covariance's trace, by name.
  [[nodiscard]] std::vector<std::pair<std::string, double>> shares() const;

 private:
  void add(std::string name, Eigen::MatrixXd covariance);
  /// A term that is a sum over numbers: changes (size, numbers), of the gauges of these labels.
  void add(const std::string& name, const Eigen::MatrixXd& changes, const std::vector<std::string>& gauges);
  Decimation grid_;
  ReplicateNoise noise_;
  Eigen::VectorXd data_, record_noise_;  ///< of the latter the sd over that of a run, (size)
  std::vector<ErrorTerm> terms_;
  std::vector<MarginalDirection> directions_;
};

/// What an amplitude of a record is at most: its span, so that a constant in it, as of an absolute temperature, makes nothing large; of a record that never
/// changes its size. Of one that begins at rest every root mean square is below it.
[[nodiscard]] double greatest_amplitude(const Eigen::Ref<const Eigen::VectorXd>& record);

/// Covariance of a process along each record with the local root mean square of the mean records over `amplitude_time` as its sd, no more than
/// greatest_amplitude, 0 before the first arrival (`arrival_share`), and `kernel` as its correlation in time, gauges sharing exp(-their distance /
/// `discrepancy_distance`): a discrepancy of scale 1, (size, size). positions: (sensors, 3) [m]; without them gauges share nothing. Conditions share it like
/// one place.
Eigen::MatrixXd discrepancy_shape(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& data, const Eigen::MatrixXd& positions,
                                  const ErrorOptions& options, const TimeKernel& kernel);

/// One hypothesis about the errors, and the logarithm of its prior weight.
struct WeightedErrors {
  ErrorModel errors;
  double log_weight = 0;
  double discrepancy = 0;  ///< its scale
};

/// `plain` with a discrepancy of each of a few scales, 0 among them, and correlation times; weights of the half-normal prior by the trapezium rule. They sum
/// to 1.
std::vector<WeightedErrors> with_discrepancy(const ErrorModel& plain, const Problem& problem, const ErrorOptions& options, const Eigen::MatrixXd& positions);

/// Places where a discrepancy may be alone, each by its sensors: every one that recorded, and every one with that nearest to it. Empty where they have no
/// places (positions: (sensors, 3) [m], or none), or fewer than three recorded.
std::vector<std::vector<std::size_t>> places_of_discrepancy(const Problem& problem, const Eigen::MatrixXd& positions);

/// `plain` with a discrepancy in such a place alone, of the scales of with_discrepancy but 0 as a root mean square over all records, and of each correlation
/// time. Weights sum to 1.
std::vector<WeightedErrors> with_local_discrepancy(const ErrorModel& plain, const Problem& problem, const ErrorOptions& options,
                                                   const Eigen::MatrixXd& positions, const std::vector<std::size_t>& place);

/// Covariance of the numerical noise of one run from residuals that have nothing else in them, (size, runs) on the grid, `freedom` squares of each value:
/// half of it their own, half gauge by gauge a process of one correlation along the record whose variance changes over `local` seconds. Full rank, (size,
/// size).
Eigen::MatrixXd numerical_noise(const Decimation& grid, const Eigen::MatrixXd& residuals, double freedom, double local);

}  // namespace calomel
