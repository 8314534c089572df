#pragma once
/// Where the posterior stands by a surrogate over the parameters' whole bounds: the middle of the emulator's first box.
#include "inverse/posterior/error_model.hpp"

namespace calomel {

/// The basin of greatest posterior density on the surrogate, (n_parameters): the best of a Sobol' design, and about the best distinct ones smaller and smaller
/// designs. Errors of the records are those of ErrorModel without model directions; of the surrogate and its mesh `relative` over the local amplitude.
/// The parameters are those of `surrogate`, with their priors. The result depends on the seed alone.
/// Errors: NumericsError where the surrogate gives no prediction anywhere.
std::vector<double> find_basin(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const ErrorOptions& options,
                               const ForwardModel& surrogate, const Eigen::MatrixXd& positions, double relative, std::uint64_t seed, int threads);

}  // namespace calomel
