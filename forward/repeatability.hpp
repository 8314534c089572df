#pragma once
/// The repeatability floor: how far the ensemble mean moves when things change that the physics does not fix - the places
/// of the mesh nodes, the regularising viscosity, the set of pulse energies. No misfit below it may be called physics.
#include <atomic>
#include <cstdint>
#include <functional>

#include "forward/built_in_model.hpp"
#include "forward/campaign/repeatability_floor.hpp"
#include "forward/runs/run_store.hpp"

namespace calomel {

/// What a measurement of the floor may be told and asked on its way.
struct FloorWatch {
  RunStore* store = nullptr;  ///< keeps every run that is finished, of a provenance that names everything that decides them; null: none
  std::function<void(std::size_t done, std::size_t total)> progress;
  const std::atomic<bool>* stop = nullptr;
};

/// Number of the runs of measure_floor in ensemble means of the case's own mesh, roughly: what it costs. `plane_strain` is the mesh's; `finer`: whether
/// the finer mesh is among them; `pulses` of an ensemble mean.
double floor_cost(const FloorOptions& options, bool plane_strain, bool finer, double single_run_cost);

/// Whether elements of half the size stay within options.finer_elements.
bool finer_is_small_enough(const FloorOptions& options, const Mesh& mesh);

/// Runs the case's ensemble mean on jittered meshes, `threads` side by side, and beside them, on the case's own mesh, what `options` asks to be compared:
/// single runs whose parameters (of a case without any: density, sound speed and tensile cutoff of the liquid) are moved by up to single_run_shift,
/// relative sd of those over the root mean square of their mean; the ensemble mean with elements of half the size, and that in the other precision,
/// |other - own| / |own| in the L2 norm over the record. Values go through single precision. Deterministic in `seed`.
/// Errors: NumericsError when fewer than three members finish; Interrupted, after the runs in progress.
[[nodiscard]] RepeatabilityFloor measure_floor(const ForwardCase& forward_case, const EnsembleOptions& ensemble, const FloorOptions& options,
                                               std::uint64_t seed, int threads, const FloorWatch& watch = {});

}  // namespace calomel
