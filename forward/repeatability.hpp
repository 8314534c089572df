#pragma once
/// The repeatability floor: how far the ensemble mean moves when things change that the physics does not fix - the places
/// of the mesh nodes, the regularising viscosity, the set of pulse energies. No misfit below it may be called physics.
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "forward/built_in_model.hpp"

namespace calomel {

struct FloorOptions {
  int members = 8;            ///< jitters; at least 3
  double mesh_jitter = 0.15;  ///< nodes move by up to this share of the shortest edge there
  double window = 50e-6;      ///< [s]
};

/// One jitter and what it changed.
struct FloorMember {
  double viscosity_factor = 1;  ///< 1/2, 1, 2 in turn
  double energy_shift = 0.5;    ///< the energies are the quantiles (i + shift) / m
  bool ok = true;
  std::string message;
};

/// Scatter of the ensemble mean over the members.
struct RepeatabilityFloor {
  std::vector<FloorMember> members;
  std::vector<std::string> conditions, sensors;
  std::vector<double> window_begin, window_end;  ///< [s]
  std::vector<double> sd;                        ///< (condition, sensor, window): root mean square over the window of the sd over the members [-]
  std::vector<double> signal;                    ///< the same shape: root mean square of the members' mean [-]
  std::vector<double> relative;                  ///< (condition, sensor): whole record, sd over signal, both root mean squares [-]
  /// Largest over the sensors of `relative`, and their mean.
  double worst = 0, mean = 0;
};

/// Runs the case's ensemble mean on jittered meshes, `threads` side by side. Deterministic in `seed`.
/// Errors: NumericsError when fewer than three members finish; Interrupted.
[[nodiscard]] RepeatabilityFloor measure_floor(const ForwardCase& forward_case, const EnsembleOptions& ensemble, const FloorOptions& options,
                                               std::uint64_t seed, int threads, const std::function<void(std::size_t done, std::size_t total)>& progress = {},
                                               const std::atomic<bool>* stop = nullptr);

/// The floor as JSON, for floor.json.
Json floor_json(const RepeatabilityFloor& floor);

/// Variance of the ensemble mean at every value of a model of this shape, (values), from floor.json: constant over each window.
/// Errors: InputError when its gauges or conditions are not the model's.
Eigen::VectorXd floor_variance(const Json& floor, const ModelShape& shape);

}  // namespace calomel
