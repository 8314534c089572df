#pragma once
/// A hypothesis about the records: some parameters of a model free, the others held; and every run of the true model, kept for all hypotheses.
#include <map>
#include <mutex>

#include "inverse/map_rival.hpp"
#include "inverse/map_search.hpp"

namespace calomel {

/// Runs of the true model by their parameters, so that none is made twice.
class RunStore {
 public:
  /// `model` outlives the object.
  explicit RunStore(const ForwardModel& model) : model_(model) {}
  /// The history at theta, (values); empty where the model fails. Safe from many threads.
  std::vector<double> history(std::span<const double> theta);
  /// A run made elsewhere.
  void put(const std::vector<double>& theta, std::vector<double> history);
  [[nodiscard]] const std::map<std::vector<double>, std::vector<double>>& all() const { return runs_; }
  [[nodiscard]] const ForwardModel& model() const { return model_; }
  [[nodiscard]] std::size_t made() const { return made_; }

 private:
  const ForwardModel& model_;
  std::mutex lock_;
  std::map<std::vector<double>, std::vector<double>> runs_;
  std::size_t made_ = 0;
};

/// The true model with the mesh's shift, as a function of the free parameters alone.
class HypothesisModel final : public ForwardModel {
 public:
  /// `held`: all parameters; those of `free` are taken from theta. `store` and `mesh` outlive the object.
  HypothesisModel(RunStore& store, const MeshError& mesh, std::vector<double> held, std::vector<std::size_t> free);
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  /// A run's history with the mesh's shift at all its parameters.
  [[nodiscard]] std::vector<double> shifted(std::span<const double> all, std::vector<double> history) const;
  /// All parameters, the free ones as theta has them.
  [[nodiscard]] std::vector<double> full(std::span<const double> theta) const;
  /// The free ones of all.
  [[nodiscard]] std::vector<double> reduced(std::span<const double> all) const;
  /// Whether the others are as they are held.
  [[nodiscard]] bool holds(std::span<const double> all) const;

 private:
  RunStore& store_;
  const MeshError& mesh_;
  std::vector<double> held_;
  std::vector<std::size_t> free_;
  ModelShape shape_;
};

/// Options of the judgement that are the same for all hypotheses.
struct JudgeSettings {
  int polish_runs = 40;
  double secant = 1;
  int threads = 1;
  std::uint64_t seed = 1;
};

/// Where a hypothesis stands after its search under a likelihood.
struct JudgedPoint {
  JudgedFit fit;
  double roughness = 0;  ///< sd of a log posterior about what the secants say, see roughness_of
};

/// Root mean square of log posteriors less those that the secants' straight lines foretell, over the points that the secants were made of but the middle, as
/// the sd of one point: the mean of two sides less the middle has 3/2 of its variance. Each point has the weight 1 / (1 + (foretold drop)^2), for far from the
/// middle a posterior is bent, and what is bent counts as rough here.
double roughness_of(const Linearisation& at, const Likelihood& likelihood, const SearchSpace& space);

class Hypothesis {
 public:
  /// `parameters`: those of the model, with the priors that are meant; the rest as for HypothesisModel.
  Hypothesis(RunStore& store, const MeshError& mesh, const std::vector<Parameter>& parameters, std::vector<double> held, std::vector<std::size_t> free);

  /// Searches under `likelihood`, which has no shift of its own, from the best runs of the store that belong to this hypothesis.
  /// Errors: NumericsError when there is none or the model fails all about it.
  JudgedPoint judge(const Likelihood& likelihood, const JudgeSettings& settings, const CalibrationProgress& progress);
  /// Sees to it that a point of all parameters is in the store, the others held.
  void try_at(const std::vector<double>& all);
  [[nodiscard]] const SearchSpace& space() const { return space_; }

 private:
  [[nodiscard]] std::vector<PosteriorPoint> best_known(const Likelihood& likelihood, std::size_t wanted) const;
  RunStore& store_;
  HypothesisModel model_;
  SearchSpace space_;
  Eigen::VectorXd widths_;  ///< of secants, once chosen: the same under every likelihood, so that runs serve all
};

/// Share of a Gaussian N(x, covariance) within the space's bounds, by 4000 draws, at least one of them.
double share_within(const SearchSpace& space, const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance, std::uint64_t seed);

}  // namespace calomel
