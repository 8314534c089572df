#pragma once
/// The train stage: the campaign's runs are split once, every requested kind is trained on the same training runs and is
/// scored on the same held-out ones.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "base/random.hpp"
#include "forward/surrogate/surrogate.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// Errors over held-out runs. mae and rmse in the data's unit; r2 is pooled, 1 - sum error^2 / sum (y - mean over the
/// held-out runs)^2, NaN where the runs do not differ.
struct FitMetrics {
  double mae = 0, rmse = 0, r2 = 0;
};

struct SensorMetrics {
  std::string name;
  FitMetrics fit;
};

struct SurrogateSummary {
  std::string name, kind;
  int n_train = 0, n_test = 0;
  FitMetrics test, train;
  std::vector<SensorMetrics> sensors;  ///< on held-out runs, conditions pooled
  std::vector<double> run_error;       ///< of each held-out run: rmse / root mean square of its record
  double variance_ratio = 0;           ///< held-out sum of error^2 / sum of the kind's own variance; 1: calibrated, 0: no variance;
                                       ///< above 1 the surrogate's error_variance is raised by it
  double train_seconds = 0;
  TrainingRecord record;
};

/// Which runs were used for what; indices into the archive.
struct RunSplit {
  std::vector<std::size_t> train, test;
  std::size_t excluded = 0;  ///< failed runs, and done ones with a value that is not finite
};

struct TrainSummary {
  std::vector<SurrogateSummary> surrogates;  ///< the first is `options.kind`, then `options.compare`
  RunSplit split;
  std::string unit;
};

/// Seeded shuffle of the usable runs, the first ceil(test_fraction n) held out, both parts in ascending order.
/// Errors: InputError when fewer than 8 runs are usable.
RunSplit split_runs(const Archive& archive, double test_fraction, std::uint64_t seed);

/// Errors of `predicted` against `actual`, (values, n_runs) both.
FitMetrics fit_metrics(const Eigen::MatrixXf& predicted, const Eigen::MatrixXf& actual);

/// One surrogate of `options.kind` on the split that `seed` gives. The same for any number of threads.
/// Errors: InputError for too few runs or histories that do not vary; NumericsError when the loss diverges.
std::unique_ptr<Surrogate> train_surrogate(const SurrogateOptions& options, const Archive& archive, std::uint64_t seed, int threads, SurrogateSummary& summary);

struct Training {
  TrainSummary summary;
  std::vector<std::unique_ptr<Surrogate>> surrogates;  ///< in the order of the summary; never empty
};

/// The stage: `options.kind` and the kinds to compare.
[[nodiscard]] Training run_training(const Archive& archive, const SurrogateOptions& options, std::uint64_t seed, int threads);

/// train.json, see the contract of artefacts.
void write_train_json(const std::filesystem::path& path, const TrainSummary& summary, const Provenance& provenance);

}  // namespace calomel
