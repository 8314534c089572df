#pragma once
/// Improvement of a mode on a rough model, with wide secants and a small budget of runs.
#include <functional>

#include "inverse/posterior_mode.hpp"

namespace calomel {

struct PolishOptions {
  int runs = 40;
  double secant = 1;  ///< half width of the secants in posterior standard deviations
};

struct Polished {
  PosteriorPoint point;              ///< the best that was run
  Eigen::VectorXd x;
  std::optional<Linearisation> at;   ///< the last secants, about `x` or the point before it; empty where none could be run
  Eigen::MatrixXd covariance;        ///< from them, or the one given
  int steps = 0, runs = 0;
};

/// Gauss-Newton with central secants along the principal directions of the posterior, `secant` standard deviations to each
/// side, one step at a time; a step goes at most 1.5 of these units and counts only when the model's own posterior improves, else half of it is tried. Ends
/// when the step is below a fifth of a standard deviation, nothing improves, or the budget is spent.
Polished polish(const PosteriorMode& mode, const SearchSpace& space, const PosteriorPoint& start, const Eigen::MatrixXd& covariance, const PolishOptions& options,
                const std::function<void(int done)>& progress);

/// Columns: principal directions of a covariance, each as long as its standard deviation times `secant`, shortened to a quarter of the box.
Eigen::MatrixXd principal_steps(const Eigen::MatrixXd& covariance, const SearchSpace& space, double secant);

}  // namespace calomel
