#pragma once
/// Dissipated energy and time at cutoff at many points, each of one run with an energy balance that the run store keeps.
#include <Eigen/Core>
#include <atomic>

#include "forward/built_in_model.hpp"
#include "forward/runs/run_store.hpp"

namespace calomel {

/// Totals of a run: their names and units in the order of the rows below.
struct RunTotal {
  const char *name, *unit;
};
inline constexpr RunTotal run_totals[] = {{"dissipated_energy", "J"}, {"time_at_cutoff", "s"}};
inline constexpr std::size_t run_total_count = std::size(run_totals);

/// What marks such a run among the points of the store: it is single, at energy 1, and keeps no histories.
inline constexpr const char* totals_key = "solver.energy_balance";

/// BuiltInModel::totals at the columns of thetas (n_parameters, n): (conditions x run_total_count, n), a condition's totals one after another, NaN columns
/// where a run failed. Runs that the store holds are not made again. Errors: as RunStore::make.
[[nodiscard]] Eigen::MatrixXd totals_at(const BuiltInModel& model, const Eigen::MatrixXd& thetas, RunStore& store, int threads,
                                        const RunStore::Progress& progress = {}, const std::atomic<bool>* stop = nullptr);

}  // namespace calomel
