#pragma once
/// What the posterior takes from a case, by its options alone: parameters, the emulator's meshes and its first box, gauges, the mesh's error.
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "apps/inputs/study_case.hpp"

namespace calomel {

/// Parameters of the posterior: those of the case, with handbook priors for the physical product; after them the regularising viscosity and the steel's Young
/// modulus where they have a prior and are none of them.
std::vector<Parameter> posterior_parameters(const StudyCase& study);

/// Element sizes of the emulator's meshes, finest last [m]: those that are set, else the case's own and its half; {0} for a mesh from a file, which has no
/// other.
std::vector<double> element_sizes(const StudyCase& study);
/// Those of a diagnosis, where the case gives none: the same, but twice the case's element size and that itself where it resolves the front of the pulse. Names
/// need no finer mesh, and what a finer one asks of the records' own errors few records keep.
std::vector<double> diagnosis_element_sizes(const StudyCase& study);

/// What other meshes than the case's own the emulator has.
enum class EmulatorMeshes {
  several,
  from_file,  ///< none: the mesh comes from a file
  one_size    ///< none: emulator.element_sizes has one
};
EmulatorMeshes emulator_meshes(const StudyCase& study);

/// Level of the case's own mesh among the emulator's, 0 the finest; nothing where it is none of them or comes from a file.
std::optional<int> own_level(const StudyCase& study);

/// Where the gauges sit, (sensors, 3) [m].
Eigen::MatrixXd gauge_positions(const StudyCase& study);

/// Error of the mesh over the local amplitude [-]: errors.mesh, or its default by the size of the elements. Of an emulator with one mesh that of this mesh,
/// `size_from_file` [m] of one from a file; of several that of the case's own, on which the surrogate stands that the basin is sought on.
double mesh_error(const StudyCase& study, double size_from_file);

/// Elements of the emulator's finest mesh through the front of the pulse (sound speed times pulse length); nothing where the load has no such front or the mesh
/// comes from a file. Below front_resolved the posterior's deviations were found too small, by 1.4 to 1.8 (docs/proof/coverage.md).
std::optional<double> elements_per_front(const StudyCase& study);
inline constexpr double front_resolved = 1.5;

/// Whether the basin is sought on the campaign's surrogate (surrogate.nc); else it is at the nominal values. By emulator.start and the priors.
bool basin_on_surrogate(const StudyCase& study);

/// Half width of the emulator's first box in a parameter of posterior_parameters, of its logarithm where the lower bound is positive. `nuisance`: it is none of
/// the case's own.
double first_half_width(const Parameter& parameter, bool nuisance);
/// That of a line's parameter, by its prior.
double first_half_width_of_a_line(const Parameter& parameter);

}  // namespace calomel
