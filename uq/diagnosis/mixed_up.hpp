#pragma once
/// Gauges that look wired the wrong way round, or taken for one another: slips that no physics explains and that spoil a fit, but can be seen at once.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// A record that is not like the simulation of its gauge, but like that with the other sign or like another gauge's, by their correlation sum(record simulation) / |record| |simulation|.
struct MixedUp {
  std::string gauge;   ///< Problem::label
  std::string other;   ///< the gauge whose simulation the record is like, its record being like this gauge's simulation; empty: of the other sign
  double own = 0;      ///< correlation with the gauge's own simulation
  double like = 0;     ///< with what it is like: -own, or the lesser of the two of the pair
};

/// Each pair once. records, simulation: (size) on the grid; of a base fit, which the other gauges hold near the truth.
[[nodiscard]] std::vector<MixedUp> mixed_up(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation);

/// "Gauge T2 reads the simulation of it with the other sign (correlation -0.98): is it wired the wrong way round?"
[[nodiscard]] std::string plain_mixed_up(const MixedUp& m);

}  // namespace calomel
