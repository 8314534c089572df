#pragma once
/// What an answer is worth: is the fit adequate, which rival optima belong to it, what to warn of.
#include "inverse/map.hpp"
#include "inverse/map_search.hpp"

namespace calomel {

/// Fills values, chi2, effective_data, effective_chi2, their p-values, adequate, adequacy, chi2_critical and, with `widen`, widening from the residual at the answer.
void judge_fit(MapSummary& out, const Likelihood& likelihood, const Eigen::VectorXd& residual, std::size_t parameters, bool widen);

/// Puts a screening into `out`: where it stands out the fit is not adequate, whatever its chi-squared.
void take_screening(MapSummary& out, Screening screening);

/// Largest slope of the log posterior at o.x by the surrogate's own gradient, in units of the posterior sd; NaN without a gradient.
double exact_slope(const ForwardModel& surrogate, const Likelihood& likelihood, const SearchSpace& space, const Optimum& o);

/// Spread (n, n) about x of the candidates that ran, each weighed by exp(-(drop of its log posterior) / temperature): optima that the model's roughness
/// cannot tell apart belong to the answer. The temperature is how far surrogate and model disagree on their log posteriors, which becomes out.roughness,
/// and at least 1.
Eigen::MatrixXd spread_of_rivals(MapSummary& out, const SearchSpace& space, const Eigen::VectorXd& x, double log_posterior);

/// How far the optimum lay from the answer x in the rounds of added runs, mean outer product over the rounds after the first (n, n); 0 where there were fewer
/// than three. An honest posterior mean moves with more runs of the same kind by less than its deviation; one that has moved by more will do so again.
Eigen::MatrixXd spread_of_rounds(const MapRefinement& refinement, const SearchSpace& space, const Eigen::VectorXd& x);

/// Adds to out.warnings what an inadequate fit, near bounds, `limited` intervals and drifting records ask for.
void warn(MapSummary& out, const SearchSpace& space, const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance, bool limited);

}  // namespace calomel
