#pragma once
/// Which parameters a model's records depend on: by variance, by elementary effects and by a polynomial.
#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "forward/model.hpp"
#include "uq/sensitivity/chaos_indices.hpp"
#include "uq/sensitivity/morris.hpp"
#include "uq/sensitivity/sobol_indices.hpp"

namespace calomel {

struct Provenance;

/// `[sensitivity]` of a case file.
struct SensitivityOptions {
  int samples = 2048;
  std::string measure = "uniform";
  int trajectories = 64;
  bool run_totals = false;
  template <class V>
  void visit(V& v) {
    v("samples", samples, {.range = between(16, 1000000), .doc = "rows of the design of Sobol' indices; each is two evaluations and one more a parameter"});
    v("measure", measure, {.doc = "how parameters vary: evenly between their bounds, or by their priors there", .choices = {"uniform", "prior"}});
    v("trajectories", trajectories, {.range = between(2, 100000), .doc = "of elementary effects; each is one evaluation and one more a parameter"});
    v("run_totals", run_totals,
      {.doc =
           "dissipated energy and time at cutoff too: one more run, with an energy balance, at each point of the campaign; not of a line or a model outside"});
  }
};

/// Runs that are there already: of the model itself where indices are those of its surrogate.
struct KnownRuns {
  Eigen::MatrixXd thetas;  ///< (n_parameters, n)
  Eigen::MatrixXd means;   ///< (values, n), NaN columns where a run failed
};

/// The share of Provenance::options: `run_totals` only where it is asked for, so that what was made before there were any is not due again.
Json identity_options(const SensitivityOptions& options);

/// Numbers that a run has beside its record, at the points where it was made.
struct TotalsOfRuns {
  struct Which {
    std::string name, condition, unit;
  };
  std::vector<Which> which;
  Eigen::MatrixXd thetas;  ///< (n_parameters, n)
  Eigen::MatrixXd values;  ///< (which, n), NaN where a run failed
};

struct SensitivityInputs {
  const ForwardModel& model;
  SensitivityOptions options;
  std::uint64_t seed = 1;
  int threads = 1;
  /// Values of the parameters at points of the unit cube, (n_parameters, n) both.
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& unit)> theta;
  std::optional<KnownRuns> runs;       ///< what the polynomial is fitted to; without any the points of the design
  std::optional<TotalsOfRuns> totals;  ///< further quantities, each seen through a polynomial of its own
  std::function<void(std::size_t done, std::size_t all)> progress;
  const std::atomic<bool>* stop = nullptr;
};

/// One number of a record or of a run, or a whole record ("record"), whose indices are the generalised ones.
struct QuantitySensitivity {
  std::string name;    ///< "peak", "time_of_peak", "rms", "record"; "value" of a model with one value; a TotalsOfRuns::Which
  std::string sensor;  ///< empty: all records together, or a total of the run
  std::string condition;
  std::string unit;
  double mean = 0, sd = 0;  ///< of a number; of a record the mean is NaN, the sd the root of its variance summed over the record
  SobolIndices sobol;
  std::vector<MorrisEffect> morris;                               ///< empty for a record
  std::optional<LegendreChaos> chaos;                             ///< of a number, with the uniform measure
  std::string source;                                             ///< of a total: what the indices are those of; empty: the model that was evaluated
  double left_out_r2 = std::numeric_limits<double>::quiet_NaN();  ///< of a total: of that polynomial, whatever the measure
  std::string note;                                               ///< why there are no shares, or why they say little; empty: they are what they are
};

struct Sensitivity {
  std::vector<QuantitySensitivity> quantities;  ///< all records together last
  Eigen::MatrixXd first_order, total_order;     ///< (values, n_parameters)
  Eigen::VectorXd sd;                           ///< (values)
  std::size_t evaluations = 0, failed = 0;
  std::size_t rows = 0;  ///< of the design that are whole: a row with an evaluation that failed is left out
  std::string doubt;     ///< why the shares are not to be trusted, as a sentence; empty: they are
};

/// Evaluations that fail leave their rows and steps out; where more than a fifth do, the result says that it is not to be trusted.
/// Errors: NumericsError when no row of the design is whole; Interrupted.
[[nodiscard]] Sensitivity analyse_sensitivity(const SensitivityInputs& in);

/// The contents of sensitivity.json. `source`: a sentence on what was evaluated.
[[nodiscard]] Json sensitivity_json(const Sensitivity& s, const SensitivityInputs& in, const std::string& source, const Provenance& provenance);
/// One line a quantity and parameter: quantity, condition, sensor, unit, mean, sd, parameter, its bounds, both indices with their intervals, elementary
/// effects, the polynomial's indices and left-out R2. A field is empty where a quantity has no such number.
[[nodiscard]] std::string sensitivity_csv(const Sensitivity& s, const std::vector<Parameter>& parameters);
/// sensitivity.nc: indices (condition, sensor, time, parameter); `totals`, which may be null: of each run its parameters (run, parameter) and totals (run), or
/// (run, condition).
void write_sensitivity(const std::filesystem::path& path, const Sensitivity& s, const ModelShape& shape, const TotalsOfRuns* totals,
                       const Provenance& provenance);

}  // namespace calomel
