#pragma once
/// Whether the records contradict a fit: chi-squared of its residual against what the errors explain.
#include <cstddef>

#include "inverse/posterior/fit_residual.hpp"

namespace calomel {

struct GoodnessOfFit {
  std::size_t values = 0;      ///< values that are compared, after decimation
  std::size_t parameters = 0;  ///< parameters that were fitted to them
  double chi2 = 0;             ///< whitened; its expectation is `values` less the parameters
  double effective_data = 0;   ///< p^2 / |R|_F^2, R the correlation matrix of the p errors (Satterthwaite 1946): p for independent ones, 1 for identical ones
  double effective_chi2 = 0;   ///< effective_data times the mean of r_i^2 / Sigma_ii: unlike chi2 blind to how well correlations are known
  double p_value = 0,
         effective_p_value = 0;  ///< share of replicated data that would fit worse, by chi-squared or, where the scale was estimated from few squares, by F
  double chi2_critical = 0;      ///< above which chi2 alone would have spoken
  bool adequate = false;         ///< neither speaks
  bool errors_too_wide = false;  ///< adequate, and chi2 lies so far below its expectation that the errors are wider than the residuals
};

[[nodiscard]] GoodnessOfFit goodness_of_fit(const FitResidual& left);

}  // namespace calomel
