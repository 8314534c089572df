#pragma once
/// The most informative points for the next runs of the true model.
#include <cstdint>

#include "forward/emulator/multilevel.hpp"

namespace calomel {

/// Points for `coarse` runs of level 1 (of level 0 where there is one level) and `fine` of level 0, one after another: each where the emulator's variance of
/// the finest level is greatest among `draws` (n_parameters, n) of the box's coordinates, as the runs before it leave it. None lies within a tenth of a box
/// of a run of its own level, whose numerical noise it would share. With one level `fine` are added to `coarse`.
struct InfillPoints {
  Eigen::MatrixXd u;       ///< (n_parameters, runs)
  std::vector<int> level;  ///< (runs)
};
InfillPoints infill(const MultilevelRegression& emulator, const Eigen::MatrixXd& draws, int coarse, int fine);

/// Points of a first design over the box: (n_parameters, n) of a Sobol sequence scrambled by `seed`; the first is the middle.
Eigen::MatrixXd first_design(Eigen::Index parameters, int n, std::uint64_t seed);

}  // namespace calomel
