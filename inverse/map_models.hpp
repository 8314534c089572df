#pragma once
/// What a calibration knows of its models' errors, and the likelihood with them as they are at a point.
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "forward/campaign/added_runs.hpp"
#include "inverse/likelihood/likelihood.hpp"
#include "inverse/recordings.hpp"
#include "inverse/posterior/score_test.hpp"

namespace calomel {

/// What a calibration knows of its models beside their predictions.
struct MapModels {
  const ForwardModel& true_model;
  const ForwardModel* surrogate = nullptr;  ///< null: the search is on the true model
  /// Variance of (model - surrogate) at a point, (values); needed with a surrogate.
  std::function<Eigen::VectorXd(std::span<const double>)> surrogate_variance;
  Eigen::VectorXd floor_variance;  ///< measured; empty: the energy scatter of the ensemble stands for it
  MeshError mesh;                  ///< from pairs of runs that are there already
  double mesh_relative = 0;        ///< without pairs: error of the mesh over the local amplitude that is taken for granted
  /// Runs points (n_parameters, n) of the true model, those on the finer mesh too where `with_fine` says so; empty: none can be added.
  std::function<std::vector<AddedRun>(const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine)> add_runs;
  std::shared_ptr<const class RefinedModel> refined;  ///< set while runs are added
  /// Changes of the true model's values by one sd of each unknown at a point, (values, unknowns); empty: none are taken into account.
  std::function<Eigen::MatrixXd(std::span<const double> theta)> unknown_directions;
  Eigen::MatrixXd unknowns;   ///< these at the best explanation, set by the search
  /// What mechanisms that the model does not have would do to its values at a point; empty: none is looked for.
  std::function<std::vector<MechanismDirections>(std::span<const double> theta)> left_out;
  bool has_finer = false;     ///< whether there is a finer mesh
  Eigen::MatrixXd positions;  ///< (sensors, 3) [m] of the gauges, or empty
};

/// The likelihood with the models' errors as they are at theta: the surrogate's error only `with_surrogate`; of the mesh what pairs of runs tell, or else
/// what is taken for granted, shared by gauges over `distance` [m]. A model without slope by energy, scatter or values at theta lacks these terms.
/// Errors: those of Likelihood.
[[nodiscard]] Likelihood likelihood_at(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options,
                                       const LikelihoodOptions& options, double distance, const MapModels& models, std::span<const double> theta,
                                       bool with_surrogate);

}  // namespace calomel
