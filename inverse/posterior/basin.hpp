#pragma once
/// The mode of the posterior by a surrogate over the parameters' whole bounds: the middle of the emulator's first box.
#include <functional>
#include <vector>

#include "inverse/posterior/error_model.hpp"

namespace calomel {

/// A run of the finest mesh at a point of the surrogate's parameters, (values of the model); empty where it fails.
using FineRun = std::function<std::vector<double>(const std::vector<double>& theta)>;

/// The basin of greatest posterior density, (n_parameters). The search is on the surrogate: the best of a Sobol' design, and about the best distinct ones
/// smaller and smaller designs. With `fine`, what the finest mesh shows beyond the surrogate at the basin is added to the surrogate and the search is done
/// again, until the basin no longer moves (additive space mapping; Bandler et al. 2004, IEEE Trans. Microwave Theory Tech. 52, 337): on a coarse mesh it may
/// lie 15 % off in density and sound speed. Errors of the records are those of ErrorModel without model directions; of the surrogate and its mesh `relative`
/// over the local amplitude. The parameters are those of `surrogate`, with their priors. The result depends on the seed alone. Errors: NumericsError where the
/// surrogate gives no prediction anywhere.
std::vector<double> find_basin(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const ErrorOptions& options,
                               const ForwardModel& surrogate, double relative, const FineRun& fine, std::uint64_t seed, int threads);

}  // namespace calomel
