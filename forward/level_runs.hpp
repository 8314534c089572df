#pragma once
/// The case's model on several meshes at one viscosity for all, its runs kept in the run store.
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "forward/built_in_model.hpp"
#include "forward/mechanism_directions.hpp"
#include "forward/parameter_group.hpp"
#include "forward/runs/run_store.hpp"

namespace calomel {

/// Dotted keys of the regularising viscosity, of the steel's Young modulus and of the mercury that stays on walls.
inline constexpr const char* viscosity_key = "material.mercury.regularising_viscosity";
inline constexpr const char* young_key = "material.steel.young";
inline constexpr const char* film_key = "material.mercury.wall_film";

class LevelRuns {
 public:
  /// `parameters`: what a theta holds, by key; where the viscosity is none of them it is `viscosity` [Pa s] in every run. element_sizes: finest last [m]; 0 for
  /// the mesh that the case itself has. All outlive the object. Errors: InputError for a mesh that cannot be made, naming `emulator.element_sizes`, e.g. for
  /// one from a file.
  LevelRuns(const ForwardCase& forward_case, EnsembleOptions ensemble, std::vector<Parameter> parameters, std::vector<double> element_sizes, double viscosity,
            RunStore& store);

  /// Meshes; level 0 is the finest.
  [[nodiscard]] int levels() const { return int(models_.size()); }
  [[nodiscard]] double element_size(int level) const { return sizes_[std::size_t(level)]; }
  [[nodiscard]] const BuiltInModel& model(int level) const { return *models_[std::size_t(level)]; }
  /// Records of the columns of thetas (n_parameters, n), each on its level's mesh.
  std::vector<RunRecord> run(const Eigen::MatrixXd& thetas, const std::vector<int>& level, int threads, const RunStore::Progress& progress = {},
                             const std::atomic<bool>* stop = nullptr);
  /// The same with further numbers of the case below the parameters, thetas (n_parameters + added, n). A number at its nominal value is left alone, so that a
  /// run with all of them there is the base model's.
  std::vector<RunRecord> run(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added, int threads,
                             const RunStore::Progress& progress = {}, const std::atomic<bool>* stop = nullptr);
  /// Changes of the ensemble mean at theta by one sd of each gauge's place along its direction, (values, gauges), by a central difference of half an element or
  /// the sd, whichever is more; to one side where the gauge cannot be moved to the other. Columns of 0 where no run came through. Two runs of the next to
  /// finest mesh, or two a gauge and one where one of them cannot be moved.
  Eigen::MatrixXd gauge_places(std::span<const double> theta, double sd, int threads, const RunStore::Progress& progress = {},
                               const std::atomic<bool>* stop = nullptr);
  /// What each built mechanism that the case does not enable would do at theta, by finite differences over a quarter of its keys' ranges on the next to finest
  /// mesh: one run, or two where a key may be moved either way, a key. Mechanisms above four times the base model's cost, keys that change nothing, and those
  /// whose runs fail are left out.
  std::vector<MechanismDirections> mechanisms(std::span<const double> theta, int threads, const RunStore::Progress& progress = {},
                                              const std::atomic<bool>* stop = nullptr);

 private:
  [[nodiscard]] RunPoint point(std::span<const double> theta, int level) const;
  [[nodiscard]] RunRecord evaluate(const RunPoint& point) const;
  const ForwardCase& case_;
  EnsembleOptions ensemble_;
  std::vector<Parameter> parameters_;
  std::vector<double> sizes_;  ///< by level
  double viscosity_;
  RunStore& store_;
  std::vector<std::unique_ptr<BuiltInModel>> models_;
};

}  // namespace calomel
