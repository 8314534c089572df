#pragma once
/// Improvement of a mode on a rough model, with wide secants and a small budget of runs.
#include <functional>

#include "inverse/posterior_mode.hpp"

namespace calomel {

struct Polished {
  PosteriorPoint point;              ///< the best that was run
  Eigen::VectorXd x;
  std::optional<Linearisation> at;   ///< the last secants, about `x` or the point before it; empty where none could be run
  Eigen::MatrixXd covariance;        ///< from them, or the one given
  std::vector<PosteriorPoint> tried; ///< every step that was run
  int steps = 0, runs = 0;
};

/// Gauss-Newton with central secants of the given half widths (n) in x, at most `runs` runs: a step goes at most 1.5 of these widths in any parameter and
/// counts only when the model's own posterior improves, else half of it is tried. Ends when the step is below a fifth of a standard deviation,
/// nothing improves, or the budget is spent. The widths stay: narrower ones would show the roughness, whose slopes would make them narrower still.
Polished polish(const PosteriorMode& mode, const SearchSpace& space, const PosteriorPoint& start, const Eigen::MatrixXd& covariance,
                const Eigen::VectorXd& half_widths, int runs, const std::function<void(int done)>& progress);

}  // namespace calomel
