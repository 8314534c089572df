#pragma once
/// What a fit to some gauges predicts of the others.
#include <Eigen/Core>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// Values of the grid that are held out together, ascending.
struct Fold {
  std::vector<Eigen::Index> rows;
  double records = 0;  ///< how many, parts counted as such
};

/// Gauges of one face of the target are held out together, where they sit on three faces or more; else each alone. A single record is held out in four parts of its time.
/// positions: (sensors, 3).
[[nodiscard]] std::vector<Fold> folds_by_face(const Problem& problem, const Decimation& grid, const Eigen::MatrixXd& positions);

/// A fit without some of its values.
struct PartFit {
  double log_evidence = 0, nested_log_evidence = 0;  ///< the latter with the parameters that the fit holds nested
  Eigen::VectorXd prediction, nested_prediction;     ///< of all values, (size): by the modes of the rest
};

/// The mode and the evidence by the values of all but the fold, on the same emulator, from the same places.
[[nodiscard]] PartFit fit_without(const PosteriorFit& fit, const std::vector<std::pair<Eigen::Index, double>>& held, const Fold& fold);

/// Mean over the fold's observations of |prediction - record| / |record| on the grid; of a part of a record, over its share of the whole record's mean square.
[[nodiscard]] double misfit_of(const Fold& fold, const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data);

}  // namespace calomel
