#pragma once
/// Location of the mismatch between a fit and the records: gauges, times and frequencies.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "inverse/data/problem.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// A part of the residual compared with its covariance: q = (B r)^T (B S B^T)^-1 (B r) for its k rows B, which is chi-squared with k degrees of freedom where
/// nothing is missing. NaN where nothing was recorded.
struct ResidualPart {
  double score = 0;  ///< q / k
  /// By Benjamini and Yekutieli (2001, Ann. Stat. 29, 1165) over all parts: the share of false discoveries among values as small, however the parts depend.
  double q_value = 1;
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
  std::string first_sensor;           ///< gauge at which the residual is first significant (q below 0.05); empty: none
  double first_time = 0;              ///< [s]
  std::size_t first_observation = 0;  ///< index of that gauge's observation
};

/// Tests every gauge, window and band. residual, covariance: (size), (size, size) on the grid.
[[nodiscard]] LocatedMismatch locate(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance);

/// The same of a fit at its mode, with the covariance of the records, the emulator and the parameters.
[[nodiscard]] LocatedMismatch locate_mismatch(const Problem& problem, const PosteriorFit& fit);

/// q-values by Benjamini and Yekutieli of p-values, in their order; NaN of one that is NaN, which is not counted.
[[nodiscard]] std::vector<double> false_discovery(const std::vector<double>& p_values);

}  // namespace calomel
