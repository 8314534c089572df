#pragma once
/// Smaller boxes about the best run that is known.
#include <Eigen/Core>
#include <vector>

#include "inverse/calibration/calibration.hpp"

namespace calomel {

/// Whether the best run lies within a tenth of a side of the box's surface, where that is not the bounds' own: the search should go beyond it.
bool at_edge(const Bounds& bounds, const Bounds& now, const std::vector<double>& best);

/// The box of the next round, about the best run: half of each side of `now`, but where the best lies at the edge of `now`, and when not `smaller`, the side
/// remains as it is and only moves. The box lies within `bounds`, but may leave `now`.
Bounds next_box(const Bounds& bounds, const Bounds& now, const std::vector<double>& best, bool smaller);

/// `runs` Chebyshev points of the box, in natural units, (n_parameters, runs).
Eigen::MatrixXd points_in(const Bounds& box, const std::vector<Parameter>& parameters, std::size_t runs, std::uint64_t seed);

}  // namespace calomel
