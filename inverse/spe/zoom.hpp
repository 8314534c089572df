#pragma once
/// Smaller boxes about the best that is known.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "inverse/calibration.hpp"

namespace calomel {

/// The box of the next round. Each side spans the best six of `ranked` (best first) and the middle half of `optima` (n_parameters, n), a tenth added at
/// both ends, and is held between a half and three quarters of that of `now`; it contains the best run and lies within `bounds`, but may leave `now`.
Bounds shrunken(const Bounds& bounds, const Bounds& now, std::span<const Proposal> ranked, const Eigen::MatrixXd& optima);

/// `runs` Chebyshev points of the box, in natural units, (n_parameters, runs).
Eigen::MatrixXd points_in(const Bounds& box, const std::vector<Parameter>& parameters, std::size_t runs, std::uint64_t seed);

}  // namespace calomel
