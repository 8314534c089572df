#include "inverse/posterior/goodness_of_fit.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "base/not_finite.hpp"

namespace calomel {

namespace {

constexpr double least_p_value = 0.01;
constexpr double told_apart = 0.8;  ///< chi-squared over its expectation below which the covariance is called too wide

/// The share of replicated data that would fit worse: chi-squared, or F for the multivariate t.
double tail_probability(double chi2, double freedom, double of_scale) {
  if (!(freedom > 0)) return nan;
  if (std::isinf(of_scale)) return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), chi2));
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(freedom, of_scale), chi2 / freedom));
}

/// The chi-squared at which tail_probability() comes to least_p_value.
double critical(double freedom, double of_scale) {
  if (std::isinf(of_scale)) return boost::math::quantile(boost::math::complement(boost::math::chi_squared(freedom), least_p_value));
  return freedom * boost::math::quantile(boost::math::complement(boost::math::fisher_f(freedom, of_scale), least_p_value));
}

}  // namespace

GoodnessOfFit goodness_of_fit(const FitResidual& left) {
  GoodnessOfFit out;
  const Eigen::VectorXd variance = left.covariance.diagonal(), unit = variance.cwiseSqrt().cwiseInverse();
  const double p = double(left.residual.size()), parameters = double(left.parameters), of_scale = left.freedom;
  out.values = std::size_t(left.residual.size());
  out.parameters = left.parameters;
  out.chi2 = left.chi2;
  out.effective_data = p * p / (unit.asDiagonal() * left.covariance * unit.asDiagonal()).squaredNorm();
  out.effective_chi2 = out.effective_data * (left.residual.array().square() / variance.array()).mean();
  const double freedom = p - parameters, effective = std::max(1.0, out.effective_data - parameters);
  out.p_value = tail_probability(out.chi2, freedom, of_scale);
  out.effective_p_value = tail_probability(out.effective_chi2, effective, of_scale);
  out.adequate = out.p_value >= least_p_value && out.effective_p_value >= least_p_value;
  if (freedom > 0) out.chi2_critical = critical(freedom, of_scale);
  out.errors_too_wide = out.adequate && freedom > 0 && out.chi2 < told_apart * freedom;
  return out;
}

}  // namespace calomel
