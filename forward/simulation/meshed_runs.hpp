#pragma once
/// Runs at points of a posterior's parameters, on each mesh of an emulator.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "forward/parameter_group.hpp"
#include "forward/simulation/runs.hpp"

namespace calomel {

class MeshedRuns {
 public:
  /// `parameters`: the numbers that a theta holds, in its order. `meshes`: a request by level, 0 the finest, of which each run takes the mesh and, where no
  /// parameter sets them, the numbers. `runs` outlives the object.
  MeshedRuns(Runs& runs, std::vector<Parameter> parameters, std::vector<RunRequest> meshes)
      : runs_(&runs), parameters_(std::move(parameters)), meshes_(std::move(meshes)) {}

  [[nodiscard]] Runs& runs() const { return *runs_; }
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }
  [[nodiscard]] int levels() const { return int(meshes_.size()); }
  [[nodiscard]] const RunRequest& mesh(int level) const { return meshes_[std::size_t(level)]; }
  /// The request of a run at theta, (n_parameters).
  [[nodiscard]] RunRequest request(std::span<const double> theta, int level) const;
  /// Records of the columns of thetas (n_parameters + added, n), each on its level's mesh. `added` are further numbers of the case below the parameters; a
  /// number at its nominal value is left out of the request, so that a run with all of them there is the base model's.
  [[nodiscard]] std::vector<RunRecord> get(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added = {},
                                           const Runs::Progress& progress = {}) const;

 private:
  Runs* runs_;
  std::vector<Parameter> parameters_;
  std::vector<RunRequest> meshes_;
};

/// The meshes of an emulator as requests, finest first. element_sizes: finest last [m], {0} for the case's own mesh alone; empty: the model has no mesh. Every
/// mesh has `numbers` set.
std::vector<RunRequest> meshes_of(const std::vector<double>& element_sizes, const std::map<std::string, double>& numbers);

/// Changes of the mean at theta by one standard deviation of each gauge's place along its direction, (values, gauges). The derivative is a central difference
/// of half an element or `sd`, whichever is more, on the next to finest mesh of element size `element_size` [m]; it is one-sided where a gauge cannot be moved
/// to the other side, and a column is 0 where no run succeeds. Two runs, or two a gauge and one where one of them cannot be moved.
Eigen::MatrixXd gauge_place_effects(const MeshedRuns& runs, std::span<const double> theta, double sd, double element_size, const Runs::Progress& progress = {});

/// The effect at theta of each number that the simulator lists for score tests, by finite differences on the next to finest mesh. Numbers that change nothing
/// and those whose runs fail are left out.
std::vector<MechanismDirections> mechanism_directions(const MeshedRuns& runs, std::span<const double> theta, const Runs::Progress& progress = {});

}  // namespace calomel
