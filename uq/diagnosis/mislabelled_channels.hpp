#pragma once
/// Mixed-up channels: gauges that look inverted, swapped or recorded in another unit. No physics explains such a record and it spoils a fit, but it can be seen
/// at once.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "inverse/data/problem.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// A record that is like the simulation of its gauge with the other sign, or like the simulation of another gauge, by their correlation sum(record simulation)
/// / |record| |simulation|; or that is like its own, but more than five times as large or as small.
struct MislabelledChannel {
  std::string gauge;  ///< Problem::label
  std::string other;  ///< the gauge with which it is swapped; empty: the record is inverted (own below 0) or of another size
  double own = 0;     ///< correlation with the gauge's own simulation
  double like = 0;    ///< correlation with the simulation that it is like: |own|, or the lesser of the two of a swapped pair
  double factor = 1;  ///< |record| / |simulation|, over the median of all gauges

  bool operator==(const MislabelledChannel&) const = default;
};

/// Finds mixed-up channels, each swapped pair once. records, simulation: (size) on the grid.
[[nodiscard]] std::vector<MislabelledChannel> mislabelled_channels(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& records,
                                                                   const Eigen::VectorXd& simulation);

/// The same by that run of a fit, or its mode, which most gauges are like (greatest median of |own|): an inverted gauge may have moved the mode away from all.
[[nodiscard]] std::vector<MislabelledChannel> mislabelled_channels(const Problem& problem, const PosteriorFit& fit);

/// Whether channels are mixed up by a run that most gauges are like, with a correlation of 0.9 or more, so that more runs would not change it.
[[nodiscard]] bool surely_mislabelled(const Problem& problem, const PosteriorFit& fit);

}  // namespace calomel
