#pragma once
/// Sensitivity of a model's records to its parameters: by variance, by elementary effects and by a polynomial.
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
      {.doc = "dissipated energy and time at cutoff too: one more run, with an energy balance, at each point of the campaign; not of a line or an external "
              "model"});
  }
};

/// Finished runs. Where the indices are those of a surrogate, these are runs of the model itself.
struct KnownRuns {
  Eigen::MatrixXd thetas;  ///< (n_parameters, n)
  Eigen::MatrixXd means;   ///< (values, n); the column of a failed run is NaN
};

/// The options on which the result depends. `run_totals` is present only when set, so that results from before it existed remain valid.
Json identity_options(const SensitivityOptions& options);

/// Numbers that a run has in addition to its record, for some runs.
struct TotalsOfRuns {
  struct Which {
    std::string name;
    std::string condition;
    std::string unit;
  };
  std::vector<Which> which;
  Eigen::MatrixXd thetas;  ///< (n_parameters, n)
  Eigen::MatrixXd values;  ///< (which, n); NaN for a failed run
};

/// The inputs of an analysis.
struct SensitivityInputs {
  const ForwardModel& model;
  SensitivityOptions options;
  std::uint64_t seed = 1;
  int threads = 1;
  /// Maps points of the unit cube to values of the parameters; both are (n_parameters, n).
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& unit)> theta;
  std::optional<KnownRuns> runs;       ///< the runs to which the polynomial is fitted; without them it is fitted to the points of the design
  std::optional<TotalsOfRuns> totals;  ///< further quantities, each represented by its own polynomial
  std::function<void(std::size_t done, std::size_t all)> progress;
  const std::atomic<bool>* stop = nullptr;
};

/// Why a quantity has no shares, or why its shares are unreliable.
enum class ShareFinding {
  reliable,
  constant,          ///< the quantity does not vary within the bounds
  no_run,            ///< a total that no run has
  same_in_all_runs,  ///< a total that has one value in all runs
  few_runs,          ///< a total that too few runs have for a polynomial
  poor_polynomial    ///< a total whose polynomial does not follow the runs
};

/// The sensitivity of one quantity: a number of a record or of a run, or a whole record ("record") with generalised indices.
struct QuantitySensitivity {
  std::string name;    ///< "peak", "time_of_peak", "rms", "record"; "value" for a model with one value; or the name of a TotalsOfRuns::Which
  std::string sensor;  ///< empty for all records together and for a total of the run
  std::string condition;
  std::string unit;
  double mean = 0;  ///< NaN for a record
  double sd = 0;    ///< for a record, the root of its variance summed over the record
  SobolIndices sobol;
  std::vector<MorrisEffect> morris;                               ///< empty for a record
  std::optional<LegendreChaos> chaos;                             ///< set for a number with the uniform measure
  std::optional<int> polynomial_order;                            ///< for a total, of the polynomial that was evaluated in place of the model
  double left_out_r2 = std::numeric_limits<double>::quiet_NaN();  ///< for a total, that of its polynomial, whatever the measure
  std::size_t runs = 0;                                           ///< for a total, that have it
  std::size_t needed_runs = 0;                                    ///< for a total, that a polynomial takes
  ShareFinding finding = ShareFinding::reliable;
};

/// The result of an analysis.
struct Sensitivity {
  std::vector<QuantitySensitivity> quantities;  ///< the last one is all records together
  Eigen::MatrixXd first_order;                  ///< (values, n_parameters)
  Eigen::MatrixXd total_order;                  ///< (values, n_parameters)
  Eigen::VectorXd sd;                           ///< (values)
  std::size_t evaluations = 0;
  std::size_t failed = 0;       ///< evaluations that failed
  std::size_t rows = 0;         ///< complete rows of the design; a row with a failed evaluation is left out
  std::size_t design_rows = 0;  ///< rows of the design
  bool many_failed = false;     ///< more than a fifth of the evaluations failed: the shares are not to be trusted
};

/// Analyses the model. A failed evaluation leaves out its row and its steps. Errors: NumericsError when no row of the design is complete; Interrupted.
[[nodiscard]] Sensitivity analyse_sensitivity(const SensitivityInputs& in);

/// The sentences of sensitivity.json for people.
struct SensitivityWords {
  std::string source;                ///< what was evaluated
  std::string doubt;                 ///< why the shares are not to be trusted; empty where they are
  std::vector<std::string> sources;  ///< of Sensitivity::quantities: what was evaluated in place of the model; empty where it was the model
  std::vector<std::string> notes;    ///< of Sensitivity::quantities: ShareFinding
};

/// The contents of sensitivity.json. Errors: a contract failure where `words` are not about `s`.
[[nodiscard]] Json sensitivity_json(const Sensitivity& s, const SensitivityInputs& in, const SensitivityWords& words, const Provenance& provenance);
/// The contents of sensitivity.csv, one line for each quantity and parameter: quantity, condition, sensor, unit, mean, sd, parameter, its bounds, both indices
/// with their intervals, elementary effects, the polynomial's indices and left-out R2. A field is empty where a quantity has no such number.
[[nodiscard]] std::string sensitivity_csv(const Sensitivity& s, const std::vector<Parameter>& parameters);
/// Writes sensitivity.nc: the indices (condition, sensor, time, parameter), and for `totals`, which may be null, each run's parameters (run, parameter) and
/// totals (run) or (run, condition).
void write_sensitivity(const std::filesystem::path& path, const Sensitivity& s, const ModelShape& shape, const TotalsOfRuns* totals,
                       const Provenance& provenance);

}  // namespace calomel
