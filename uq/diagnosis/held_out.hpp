#pragma once
/// What a fit to some gauges predicts of the others.
#include <Eigen/Core>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// Observations that are held out together.
using Fold = std::vector<std::size_t>;

/// Gauges of one face of the target are held out together, where they sit on three faces or more; else each alone. positions: (sensors, 3).
[[nodiscard]] std::vector<Fold> folds_by_face(const Problem& problem, const Eigen::MatrixXd& positions);

/// A fit without some of its values.
struct PartFit {
  double log_evidence = 0, nested_log_evidence = 0;  ///< the latter with the parameters that the fit holds nested
  Eigen::VectorXd prediction, nested_prediction;     ///< of all values, (size): by the modes of the rest
  Eigen::VectorXd history;                           ///< of the model, (values of the model), by the mode of the rest
};

/// The mode and the evidence by the values of all but the fold, on the same emulator, from the same places.
[[nodiscard]] PartFit fit_without(const PosteriorFit& fit, const std::vector<std::pair<Eigen::Index, double>>& held, const Fold& fold);

/// Mean over the fold's observations of |prediction - record| / |record| on the grid.
[[nodiscard]] double misfit_of(const Fold& fold, const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data);

/// Puts the fold's gauges of a history, (values of the model), in their places of another; one that is empty becomes NaN for all others first.
void keep_held_out(const Fold& fold, const Problem& problem, const Eigen::VectorXd& history, std::vector<double>& into);

}  // namespace calomel
