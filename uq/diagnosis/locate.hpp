#pragma once
/// Where a fit and the records part: which gauges, when, at which frequencies.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// A part of the residual against its covariance, NaN where nothing was recorded: q = (B r)^T (B S B^T)^-1 (B r) for its k rows B, chi-squared with k degrees
/// of freedom where nothing is missing.
struct ResidualPart {
  double score = 0;  ///< q / k
  double q_value =
      1;  ///< by Benjamini and Yekutieli (2001, Ann. Stat. 29, 1165) over all parts: false discoveries among those as small, however the parts depend
};

struct LocatedMismatch {
  struct Sensor : ResidualPart {
    std::string name;
  };
  struct Window : ResidualPart {
    double begin = 0, end = 0;
  };  ///< [s]
  struct Band : ResidualPart {
    double low = 0, high = 0;
  };  ///< [Hz]
  std::vector<Sensor> sensors;
  std::vector<Window> windows;
  std::vector<Band> bands;
  Eigen::MatrixXd map;           ///< (observations, windows): score of each gauge in each window
  Eigen::MatrixXd map_q_values;  ///< of those
  Eigen::MatrixXd band_map;      ///< (observations, bands): score of each gauge in each band
  Eigen::MatrixXd band_map_q_values;
  std::string first_sensor;           ///< where the residual is first seen (q below 0.05); empty: nowhere
  double first_time = 0;              ///< [s]
  std::size_t first_observation = 0;  ///< of the problem's, where there is such a gauge
};

/// residual, covariance: (size), (size, size) on the grid.
[[nodiscard]] LocatedMismatch locate(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance);

/// q-values by Benjamini and Yekutieli of p-values, in their order; NaN of one that is NaN, which is not counted.
[[nodiscard]] std::vector<double> false_discovery(const std::vector<double>& p_values);

}  // namespace calomel
