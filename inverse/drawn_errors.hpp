#pragma once
/// Synthetic records and runs for a parametric bootstrap: the errors of the likelihood's covariance drawn about an answer.
#include <functional>
#include <span>
#include <vector>

#include "inverse/answer_spread.hpp"
#include "inverse/calibration.hpp"
#include "inverse/map_models.hpp"
#include "inverse/refined_model.hpp"

namespace calomel {

/// The covariance of the likelihood at an answer in the parts in which a calibration meets them.
struct AnswerErrors {
  Likelihood records;         ///< what all predictions share: noise, nuisances, mesh
  Eigen::MatrixXd run;        ///< what differs from run to run, the repeatability floor, (values, values)
  Eigen::MatrixXd surrogate;  ///< (model - surrogate); zero without a surrogate
  MeshError mesh;             ///< whose known scatter is drawn over the parameters, and is no part of `records`; may be empty
};

/// What a drawn error of the mesh's shift adds to predictions; nothing where there is none.
using DrawnShift = std::optional<MeshError::Draw>;

/// A model with a drawn error of its shift. Both outlive the object.
class DrawnModel final : public ForwardModel {
 public:
  DrawnModel(const ForwardModel& model, const DrawnShift& drawn) : model_(model), drawn_(drawn) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const override;

 private:
  const ForwardModel& model_;
  const DrawnShift& drawn_;
};

/// These at a point, with the mesh's error and the surrogate's variance as a calibration has them by then (no function: there is no surrogate).
using ErrorsAt = std::function<AnswerErrors(std::span<const double> theta, const MeshError& mesh, const RefinedModel::Variance& surrogate_variance)>;

/// `models` as MAP would have them at theta, see likelihood_at. Errors: those of Likelihood.
[[nodiscard]] AnswerErrors answer_errors(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options,
                                         const LikelihoodOptions& options, double distance, const MapModels& models, std::span<const double> theta);

/// Records as they might have been were the answer true, and predictions as other pairs of meshes would have shifted them. Within the band of the likelihood the residual of the mean records is replaced by a draw; what lies
/// above that band, of whose errors only the size is known, keeps it and takes a random sign for each observation (wild bootstrap). Draw k depends on (seed, k)
/// alone.
class DrawnErrors {
 public:
  /// `prediction`: (values of the model) at theta, the mesh's shift included. Problem and errors outlive the object.
  DrawnErrors(const Problem& problem, const AnswerErrors& errors, std::span<const double> theta, std::span<const double> prediction, std::uint64_t seed);

  struct Records {
    Problem of_runs;         ///< what runs of the true model are held against
    Problem of_surrogate;    ///< the same less what the surrogate misses: what its predictions are held against
    Eigen::VectorXd moved, moved_surrogate;  ///< on the likelihood's grid, what was added to its data in either
  };
  [[nodiscard]] Records records(std::size_t draw) const;
  /// Errors of n runs of draw k, each its own, (values of the model, n); `batch` tells apart the batches of one draw.
  [[nodiscard]] Eigen::MatrixXf runs(std::size_t draw, std::size_t batch, std::size_t n) const;
  /// What the mesh's shift is off by in draw k.
  [[nodiscard]] DrawnShift shift(std::size_t draw) const;

 private:
  /// `flipped`: observations whose residual above the band changes its sign.
  [[nodiscard]] Problem with_records_moved(const Eigen::VectorXd& coarse, const std::vector<bool>& flipped) const;
  const Problem& problem_;
  const AnswerErrors& errors_;
  std::uint64_t seed_;
  Eigen::VectorXd residual_;
  std::vector<std::vector<double>> above_;  ///< (observation, record time) residual above the band
  Eigen::MatrixXd records_root_, run_root_, surrogate_root_;
};

/// Seeks the answer to each of `draws` drawn records on `threads` threads, `answer(errors, draw)`, empty where there is none, and fills `spread` with what comes
/// of them. An error of the likelihood is told there, and there are no answers. `pairs`: answers to left-out pairs of meshes, by which the spread is widened; see widen. `theta`, `prediction`: as DrawnErrors takes them.
void draw_answers(AnswerSpread& spread, const Problem& problem, const std::function<AnswerErrors()>& errors, int draws, const std::vector<double>& theta,
                  std::span<const double> prediction, std::uint64_t seed, int threads, const CalibrationProgress& progress,
                  const std::function<std::vector<double>(const DrawnErrors& errors, std::size_t draw)>& answer,
                  const std::function<std::vector<FoundPair>(const DrawnErrors& errors)>& pairs = {});

/// The problem with the records that a history of the model's values would have given, their bands as wide as they were.
Problem with_records(const Problem& problem, const Eigen::VectorXd& history);

}  // namespace calomel
