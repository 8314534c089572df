#pragma once
/// The repeatability floor: how far the mean moves when what the physics does not fix changes, namely the places of the mesh nodes, the regularising viscosity
/// and the set of pulse energies. No misfit below the floor may be called physics.
#include <cstdint>

#include "forward/campaign/repeatability_floor.hpp"
#include "forward/simulation/runs.hpp"

namespace calomel {

/// The cost of measure_floor in means of the case's own mesh, roughly. refinement_exponent: RunCost's; `finer`: whether the finer mesh is among the runs;
/// single_run_cost: of one pulse, over a mean.
double floor_cost(const FloorOptions& options, int refinement_exponent, bool finer, double single_run_cost);

/// Whether a mesh with elements of half the size remains within options.finer_elements.
bool finer_is_small_enough(const FloorOptions& options, const RunCost& cost);

/// Runs the case's mean on jittered meshes and, on the case's own mesh, the comparisons that `options` request: single runs whose parameters are moved by up to
/// single_run_shift (of a case without parameters: the numbers that the simulator names), as their relative standard deviation; and the means with elements of
/// half the size and in the other precision, as |other - own| / |own| in the L2 norm over the record. Deterministic in `seed`.
/// Errors: NumericsError when fewer than three members finish; those of Runs.
[[nodiscard]] RepeatabilityFloor measure_floor(Runs& runs, const FloorOptions& options, std::uint64_t seed, const Runs::Progress& progress = {});

}  // namespace calomel
