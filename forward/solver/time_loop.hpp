#pragma once
/// The loop over steps: threads, observations, fields, energy balance, checkpoints.
#include "forward/solver/run.hpp"

namespace calomel {

/// Runs to the end of `setup`, `steps_per_output` steps to an output interval. Errors: NumericsError, InputError for a checkpoint of
/// another run, Interrupted; what the callbacks throw.
template <class R>
SolveSummary run_to_end(Run<R>& run, const RunSetup& setup, const Layout& layout, std::span<const ObservationRow> rows, const SolveOptions& options,
                        int steps_per_output);

extern template SolveSummary run_to_end<float>(Run<float>&, const RunSetup&, const Layout&, std::span<const ObservationRow>, const SolveOptions&, int);
extern template SolveSummary run_to_end<double>(Run<double>&, const RunSetup&, const Layout&, std::span<const ObservationRow>, const SolveOptions&, int);

}  // namespace calomel
