#include "inverse/posterior/prior.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numbers>

#include "base/not_finite.hpp"

namespace calomel {

namespace {

const boost::math::normal standard;

}  // namespace

Prior::Prior(const Parameter& p) : kind_(p.prior), low_(p.min), high_(p.max) {
  p.validate();
  const double half_log_2pi = 0.5 * std::log(2 * std::numbers::pi);
  if (kind_ == "uniform") {
    log_norm_ = -std::log(high_ - low_);
  } else if (kind_ == "normal" || kind_ == "truncated_normal") {
    a_ = *p.mean;
    b_ = *p.sd;
    log_norm_ = -half_log_2pi - std::log(b_);
    if (kind_ == "normal") {
      low_ = -infinity;
      high_ = infinity;
    } else {
      const double inside = boost::math::cdf(standard, (high_ - a_) / b_) - boost::math::cdf(standard, (low_ - a_) / b_);
      if (!(inside > 1e-12))
        throw InputError({.problem = "the truncated normal prior of " + p.name + " has no weight between its bounds", .key = "parameter." + p.name + ".mean"});
      log_norm_ -= std::log(inside);
    }
  } else if (kind_ == "lognormal") {
    a_ = *p.mu;
    b_ = *p.sigma;
    low_ = 0;
    high_ = infinity;
    log_norm_ = -half_log_2pi - std::log(b_);
  } else if (kind_ == "half_cauchy") {
    b_ = *p.scale;
    low_ = 0;
    high_ = infinity;
    log_norm_ = std::log(2 / (std::numbers::pi * b_));
  } else if (kind_ == "beta") {
    a_ = *p.alpha;
    b_ = *p.beta;
    log_norm_ = std::lgamma(a_ + b_) - std::lgamma(a_) - std::lgamma(b_) - std::log(high_ - low_);
  } else {
    throw InputError({.problem = "no prior of this name", .key = "parameter." + p.name + ".prior", .value = kind_});
  }
}

double Prior::log_density(double x) const {
  if (!(x >= low_ && x <= high_)) return -infinity;
  if (kind_ == "uniform") return log_norm_;
  if (kind_ == "lognormal") {
    if (x <= 0) return -infinity;
    const double z = (std::log(x) - a_) / b_;
    return log_norm_ - std::log(x) - 0.5 * z * z;
  }
  if (kind_ == "half_cauchy") return log_norm_ - std::log1p(x * x / (b_ * b_));
  if (kind_ == "beta") {
    const double u = (x - low_) / (high_ - low_);
    const auto power = [](double base, double exponent) { return exponent == 0 ? 0 : exponent * std::log(base); };
    return log_norm_ + power(u, a_ - 1) + power(1 - u, b_ - 1);
  }
  const double z = (x - a_) / b_;
  return log_norm_ - 0.5 * z * z;
}

double Prior::log_density_slope(double x) const {
  if (kind_ == "uniform") return 0;
  if (kind_ == "lognormal") return -(1 + (std::log(x) - a_) / (b_ * b_)) / x;
  if (kind_ == "half_cauchy") return -2 * x / (b_ * b_ + x * x);
  if (kind_ == "beta") return (a_ - 1) / (x - low_) - (b_ - 1) / (high_ - x);
  return -(x - a_) / (b_ * b_);
}

double Prior::quantile(double u) const {
  expect(u > 0 && u < 1, "a probability lies between 0 and 1");
  if (kind_ == "uniform") return low_ + u * (high_ - low_);
  if (kind_ == "lognormal") return std::exp(a_ + b_ * boost::math::quantile(standard, u));
  if (kind_ == "half_cauchy") return b_ * std::tan(0.5 * std::numbers::pi * u);
  if (kind_ == "beta") return low_ + (high_ - low_) * boost::math::quantile(boost::math::beta_distribution<>(a_, b_), u);
  if (kind_ == "truncated_normal") {
    const double begin = boost::math::cdf(standard, (low_ - a_) / b_), end = boost::math::cdf(standard, (high_ - a_) / b_);
    return std::clamp(a_ + b_ * boost::math::quantile(standard, begin + u * (end - begin)), low_, high_);
  }
  return a_ + b_ * boost::math::quantile(standard, u);
}

double Prior::probability_below(double x) const {
  const auto below = [](double at) { return boost::math::cdf(standard, at); };
  if (kind_ == "lognormal") return x > 0 ? below((std::log(x) - a_) / b_) : 0;
  if (kind_ == "half_cauchy") return x > 0 ? 2 / std::numbers::pi * std::atan(x / b_) : 0;
  if (kind_ == "normal") return below((x - a_) / b_);
  const double at = std::clamp(x, low_, high_);
  if (kind_ == "beta") return boost::math::cdf(boost::math::beta_distribution<>(a_, b_), (at - low_) / (high_ - low_));
  if (kind_ == "truncated_normal") {
    const double begin = below((low_ - a_) / b_), end = below((high_ - a_) / b_);
    return (below((at - a_) / b_) - begin) / (end - begin);
  }
  return (at - low_) / (high_ - low_);
}

double Prior::scale() const {
  if (kind_ == "uniform") return (high_ - low_) / std::sqrt(12.0);
  if (kind_ == "lognormal") return b_ * std::exp(a_);
  if (kind_ == "beta") return (high_ - low_) * std::sqrt(a_ * b_ / ((a_ + b_ + 1) * (a_ + b_) * (a_ + b_)));
  return b_;
}

std::vector<Prior> priors_of(std::span<const Parameter> parameters) {
  std::vector<Prior> all;
  for (const auto& p : parameters) all.emplace_back(p);
  return all;
}

double log_prior(std::span<const Prior> priors, std::span<const double> theta) {
  double sum = 0;
  for (std::size_t k = 0; k < priors.size(); ++k) sum += priors[k].log_density(theta[k]);
  return sum;
}

std::optional<double> prior_deviation(const Parameter& p, double value) {
  if (p.prior == "normal" || p.prior == "truncated_normal") return (value - *p.mean) / *p.sd;
  if (p.prior == "lognormal") return (std::log(value) - *p.mu) / *p.sigma;
  return {};
}

std::pair<double, double> expected_range(const Parameter& p) {
  if (p.prior != "truncated_normal") return {p.min, p.max};
  return {std::max(p.min, *p.mean - 2 * *p.sd), std::min(p.max, *p.mean + 2 * *p.sd)};
}

std::vector<Parameter> with_handbook_priors(std::vector<Parameter> parameters, const std::vector<HandbookPrior>& handbook) {
  for (auto& p : parameters) {
    const auto known = std::find_if(handbook.begin(), handbook.end(), [&](const HandbookPrior& h) { return p.key == h.key; });
    if (known != handbook.end()) {
      expect(p.nominal.has_value(), "a model's shape carries every nominal value");
      p.prior = known->prior;
      if (p.prior == "normal") {
        p.mean = *p.nominal;
        p.sd = known->sd * *p.nominal;
      } else {
        if (!(*p.nominal > 0))
          throw InputError({.problem = "the handbook prior is one of the logarithm, which a nominal value of 0 does not have",
                            .key = "parameter." + p.name + ".nominal",
                            .suggestion = "give the value that is expected, such as 1.5e5"});
        p.mu = std::log(*p.nominal);
        p.sigma = known->sd;
      }
    } else if (p.prior == "uniform") {
      throw InputError({.problem = "a uniform prior together with a free discrepancy does not identify a parameter: the discrepancy explains whatever it does",
                        .key = "parameter." + p.name + ".prior",
                        .value = "\"uniform\"",
                        .range = "normal, lognormal, truncated_normal, half_cauchy, beta",
                        .suggestion = "state its prior, such as prior = \"normal\" with mean and sd (calibrate and sample also take map.product = \"tuned\")"});
    }
  }
  return parameters;
}

}  // namespace calomel
