#pragma once
/// The meshes on which a posterior's emulator is trained, by the case's options and what its model can do.
#include <optional>
#include <vector>

#include "forward/simulation/simulator.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// Which other meshes than the case's own the emulator has.
enum class EmulatorMeshes {
  several,
  from_file,  ///< none, because the mesh comes from a file
  one_size    ///< none, because the options list one size or the model has no mesh
};
EmulatorMeshes emulator_meshes(const Simulator& simulator, const EmulatorOptions& options);

/// Element sizes of the emulator's meshes, finest last [m]: those of the options, else the case's own and its half; {0} for a mesh from a file, which has no
/// other; empty where the model has no mesh.
std::vector<double> element_sizes(const Simulator& simulator, const EmulatorOptions& options);
/// The same for a diagnosis. Where the options list none these are twice the case's element size and that size itself, if it resolves the front of the pulse.
/// Naming a mechanism needs no finer mesh, and few records are so accurate that a finer one would help.
std::vector<double> diagnosis_element_sizes(const Simulator& simulator, const EmulatorOptions& options);

/// Level of the case's own mesh among the emulator's, 0 the finest; nothing where it is none of them or comes from a file.
std::optional<int> own_level(const Simulator& simulator, const EmulatorOptions& options);

/// Error of the mesh over the local amplitude [-]: `given` (errors.mesh), or its default by the size of the elements. For an emulator with one mesh it is the
/// error of this mesh, `size_from_file` [m] for one from a file; for several meshes it is that of the case's own, on which the campaign's surrogate is trained.
double mesh_error(const Simulator& simulator, const EmulatorOptions& options, std::optional<double> given, double size_from_file);

/// Elements of the emulator's finest mesh through the front of the pulse (sound speed times pulse length); nothing where the load has no such front or the mesh
/// comes from a file. Below front_resolved the standard deviations of the posterior were too small by a factor of 1.4 to 1.8 (docs/proof/coverage.md).
std::optional<double> elements_per_front(const Simulator& simulator, const EmulatorOptions& options);
inline constexpr double front_resolved = 1.5;

/// Whether the first box is placed about the best point of the campaign's surrogate (surrogate.nc); else about the nominal values. It depends on emulator.start
/// and on the priors. `physical`: the product of the posterior.
bool basin_on_surrogate(const Simulator& simulator, const EmulatorOptions& options, bool physical);

}  // namespace calomel
