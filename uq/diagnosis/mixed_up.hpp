#pragma once
/// Gauges that look wired the wrong way round, taken for one another or told in another unit, and a clock that is off: slips that no physics explains and that
/// spoil a fit, but can be seen at once.
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "inverse/data/problem.hpp"
#include "uq/diagnosis/first_order.hpp"

namespace calomel {

/// A record that is not like the simulation of its gauge, but like that with the other sign or like another gauge's, by their correlation sum(record
/// simulation) / |record| |simulation|; or like it, but more than five times as large or as small.
struct MixedUp {
  std::string gauge;  ///< Problem::label
  std::string other;  ///< the gauge whose simulation the record is like, its record being like this gauge's simulation; empty: the record is like its own, with
                      ///< the other sign (own below 0) or in another size
  double own = 0;     ///< correlation with the gauge's own simulation
  double like = 0;    ///< with what it is like: |own|, or the lesser of the two of the pair
  double factor = 1;  ///< |record| / |simulation|, over the middle one of that of all gauges
};

/// Each pair once. records, simulation: (size) on the grid.
[[nodiscard]] std::vector<MixedUp> mixed_up(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation);

/// By that of a fit's runs, or of its mode, which most gauges are like (the greatest median of |own|): a gauge of the other sign may have pulled the mode away
/// from all.
[[nodiscard]] std::vector<MixedUp> mixed_up(const Problem& problem, const PosteriorFit& fit);

/// Whether gauges are mixed up by a run that most gauges are like, by 0.9: more runs would not change it.
[[nodiscard]] bool surely_mixed_up(const Problem& problem, const PosteriorFit& fit);

/// All records together, by the clock of the simulation.
struct LateRecords {
  double late = 0, sd = 0;      ///< [s]; early where it is negative
  double log_bayes_factor = 0;  ///< over the base model, to first order
};

/// What a delay of all records by 1 s does, -d history / dt on the grid of the fit; its prior has a hundredth of the record's length as standard deviation.
/// history: (values of the model).
[[nodiscard]] AddedDirections lateness(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& history);

/// Of the mode of a fit, where their log Bayes factor is one that a name would need.
[[nodiscard]] std::optional<LateRecords> late_records(const Problem& problem, const PosteriorFit& fit);

}  // namespace calomel
