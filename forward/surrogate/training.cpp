#include "forward/surrogate/training.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/artefact.hpp"
#include "base/provenance.hpp"

namespace calomel {
namespace {

constexpr std::size_t least_runs = 8;

/// The archive's histories of one quantity over the runs of a split.
TrainingSet training_set(const Archive& archive, const Eigen::MatrixXf& histories, const RunSplit& split) {
  TrainingSet set;
  set.parameters = archive.shape.parameters;
  set.series = archive.shape.conditions.size() * archive.shape.sensors.size();
  set.theta = archive.theta(Eigen::all, split.train);
  set.histories = histories(Eigen::all, split.train);
  set.test_theta = archive.theta(Eigen::all, split.test);
  set.test_histories = histories(Eigen::all, split.test);
  return set;
}

/// Whether the runs of the split differ in this quantity, and are all finite.
bool worth_learning(const Eigen::MatrixXf& histories, const RunSplit& split) {
  if (histories.size() == 0) return false;
  const Eigen::MatrixXf y = histories(Eigen::all, split.train);
  return y.allFinite() && (y.colwise() - y.col(0)).cwiseAbs().maxCoeff() > 0;
}

/// Energy slope and scatter are smooth enough companions of the mean: always Gaussian processes on modes.
std::unique_ptr<TrainedMap> companion(const Archive& archive, const Eigen::MatrixXf& histories, const RunSplit& split, const SurrogateOptions& options,
                                      std::uint64_t seed, int threads) {
  if (!worth_learning(histories, split)) return nullptr;
  TrainingRecord unused;
  return surrogate_kinds().get("mode_gaussian_process").train(training_set(archive, histories, split), options, seed, threads, unused);
}

void score(const Surrogate& surrogate, const Archive& archive, const RunSplit& split, int threads, SurrogateSummary& summary) {
  const ModelShape& shape = archive.shape;
  const Eigen::MatrixXf actual = archive.mean(Eigen::all, split.test);
  const Eigen::MatrixXd thetas = archive.theta(Eigen::all, split.test);
  const Eigen::MatrixXf predicted = surrogate.means(thetas, threads);
  summary.test = fit_metrics(predicted, actual);
  summary.train = fit_metrics(surrogate.means(archive.theta(Eigen::all, split.train), threads), archive.mean(Eigen::all, split.train));
  const auto times = Eigen::Index(shape.times.size());
  for (std::size_t s = 0; s < shape.sensors.size(); ++s) {
    // Conditions side by side, as if they were further times of the sensor.
    const auto conditions = Eigen::Index(shape.conditions.size());
    Eigen::MatrixXf p(conditions * times, actual.cols()), a(p.rows(), p.cols());
    for (Eigen::Index c = 0; c < conditions; ++c) {
      const auto first = Eigen::Index(shape.at(std::size_t(c), s, 0));
      p.middleRows(c * times, times) = predicted.middleRows(first, times);
      a.middleRows(c * times, times) = actual.middleRows(first, times);
    }
    summary.sensors.push_back({shape.sensors[s], fit_metrics(p, a)});
  }
  for (Eigen::Index r = 0; r < actual.cols(); ++r) {
    const Eigen::VectorXd error = (predicted.col(r) - actual.col(r)).cast<double>();
    const double size = actual.col(r).cast<double>().norm();
    summary.run_error.push_back(size > 0 ? error.norm() / size : 0);
  }
}

std::unique_ptr<Surrogate> train_on_split(const SurrogateOptions& options, const std::string& kind, const Archive& archive, const RunSplit& split,
                                          bool with_companions, std::uint64_t seed, int threads, SurrogateSummary& summary) {
  if (!worth_learning(archive.mean, split))
    throw InputError({.problem = "all training runs gave the same histories, so there is nothing to learn",
                      .key = "surrogate",
                      .suggestion = "check that the sensors see the pulse before time.end and that the parameters reach the model"});
  const auto start = std::chrono::steady_clock::now();
  summary.name = summary.kind = kind;
  summary.n_train = int(split.train.size());
  summary.n_test = int(split.test.size());
  Surrogate::Parts parts;
  parts.kind = kind;
  parts.shape = archive.shape;
  parts.mean = surrogate_kinds().get(kind, "surrogate.kind").train(training_set(archive, archive.mean, split), options, seed, threads, summary.record);
  if (with_companions) {
    parts.slope = companion(archive, archive.energy_slope, split, options, seed, threads);
    parts.scatter = companion(archive, archive.scatter, split, options, seed, threads);
  }
  summary.train_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Eigen::MatrixXf error = parts.mean->histories(archive.theta(Eigen::all, split.test), threads) - archive.mean(Eigen::all, split.test);
  parts.held_out = error.cwiseAbs2().rowwise().mean();
  double expected = 0;
  for (const std::size_t r : split.test) {
    const Eigen::VectorXd own = parts.mean->variance(archive.theta.col(Eigen::Index(r)));
    if (own.size() > 0) expected += own.sum();
  }
  if (expected > 0) summary.variance_ratio = error.cast<double>().squaredNorm() / expected;
  parts.variance_factor = std::max(1.0, summary.variance_ratio);
  auto surrogate = std::make_unique<Surrogate>(std::move(parts));
  score(*surrogate, archive, split, threads, summary);
  return surrogate;
}

Json metrics_json(const FitMetrics& fit) { return {{"mae", fit.mae}, {"rmse", fit.rmse}, {"r2", std::isfinite(fit.r2) ? Json(fit.r2) : Json()}}; }

}  // namespace

RunSplit split_runs(const Archive& archive, double test_fraction, std::uint64_t seed) {
  std::vector<std::size_t> usable;
  for (const std::size_t r : archive.completed())
    if (archive.mean.col(Eigen::Index(r)).allFinite()) usable.push_back(r);
  if (usable.size() < least_runs)
    throw InputError({.problem = "the campaign has too few successful runs to train a surrogate",
                      .key = "campaign.runs",
                      .value = std::to_string(usable.size()),
                      .range = ">= " + std::to_string(least_runs),
                      .suggestion = "increase campaign.runs, or see in campaign.json why runs failed"});
  RandomStream random(seed, 0);
  const auto order = random.permutation(usable.size());
  const auto held_out = std::size_t(std::ceil(test_fraction * double(usable.size())));
  RunSplit split;
  split.excluded = archive.runs() - usable.size();
  for (std::size_t i = 0; i < order.size(); ++i) (i < held_out ? split.test : split.train).push_back(usable[order[i]]);
  std::sort(split.train.begin(), split.train.end());
  std::sort(split.test.begin(), split.test.end());
  return split;
}

FitMetrics fit_metrics(const Eigen::MatrixXf& predicted, const Eigen::MatrixXf& actual) {
  expect(predicted.rows() == actual.rows() && predicted.cols() == actual.cols() && actual.size() > 0, "predicted and actual histories match");
  const Eigen::MatrixXd y = actual.cast<double>(), error = predicted.cast<double>() - y;
  const Eigen::VectorXd mean = y.rowwise().mean();
  const double squares = error.squaredNorm(), about_mean = (y.colwise() - mean).squaredNorm(), n = double(error.size());
  return {error.cwiseAbs().sum() / n, std::sqrt(squares / n), about_mean > 0 ? 1 - squares / about_mean : std::numeric_limits<double>::quiet_NaN()};
}

std::unique_ptr<Surrogate> train_surrogate(const SurrogateOptions& options, const Archive& archive, std::uint64_t seed, int threads,
                                           SurrogateSummary& summary) {
  options.validate();
  summary = {};
  return train_on_split(options, options.kind, archive, split_runs(archive, options.test_fraction, seed), true, seed, threads, summary);
}

Training run_training(const Archive& archive, const SurrogateOptions& options, std::uint64_t seed, int threads) {
  options.validate();
  Training training;
  training.summary.unit = archive.shape.unit;
  training.summary.split = split_runs(archive, options.test_fraction, seed);
  std::vector<std::string> kinds{options.kind};
  for (const auto& k : options.compare)
    if (k != options.kind) kinds.push_back(k);
  for (const auto& kind : kinds) {
    SurrogateSummary summary;
    training.surrogates.push_back(train_on_split(options, kind, archive, training.summary.split, kind == options.kind, seed, threads, summary));
    training.summary.surrogates.push_back(std::move(summary));
  }
  return training;
}

void write_train_json(const std::filesystem::path& path, const TrainSummary& summary, const Provenance& provenance) {
  Json surrogates = Json::array();
  for (const auto& s : summary.surrogates) {
    Json row{{"name", s.name}, {"kind", s.kind}, {"n_train", s.n_train}, {"n_test", s.n_test}};
    row.update(metrics_json(s.test));
    row["train"] = metrics_json(s.train);
    row["train_seconds"] = s.train_seconds;
    row["epochs"] = s.record.epochs;
    if (s.record.modes > 0) {
      row["modes"] = s.record.modes;
      row["mode_energy"] = s.record.mode_energy;
    }
    row["variance_ratio"] = s.variance_ratio;
    row["run_error"] = s.run_error;
    Json sensors = Json::array();
    for (const auto& sensor : s.sensors) {
      Json one{{"name", sensor.name}};
      one.update(metrics_json(sensor.fit));
      sensors.push_back(std::move(one));
    }
    row["sensors"] = std::move(sensors);
    row["train_loss"] = s.record.train_loss;
    row["test_loss"] = s.record.test_loss;
    surrogates.push_back(std::move(row));
  }
  write_json(path, {{"surrogates", std::move(surrogates)},
                    {"unit", summary.unit},
                    {"excluded_runs", summary.split.excluded},
                    {"test_runs", summary.split.test},
                    {"provenance", provenance.json()}});
}

}  // namespace calomel
