#include "uq/convergence/diagnostics.hpp"

#include <gsl/gsl_fft_halfcomplex.h>
#include <gsl/gsl_fft_real.h>

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/errors.hpp"
#include "base/not_finite.hpp"

namespace calomel {

namespace {

/// Halves of chains, (2 chains, draws / 2). The middle draw of an odd number is left out.
struct Halves {
  std::vector<double> values;
  std::size_t chains = 0;
  std::size_t draws = 0;
  [[nodiscard]] std::span<const double> chain(std::size_t c) const { return {values.data() + c * draws, draws}; }
};

Halves halves(std::span<const double> x, std::size_t chains) {
  const std::size_t n = x.size() / chains;
  const std::size_t half = n / 2;
  Halves h{.chains = 2 * chains, .draws = half};
  for (std::size_t c = 0; c < chains; ++c)
    for (const std::size_t first : {c * n, c * n + n - half})
      h.values.insert(h.values.end(), x.begin() + std::ptrdiff_t(first), x.begin() + std::ptrdiff_t(first + half));
  return h;
}

/// Whether diagnostics are defined for these draws.
bool defined_for(ChainDraws x) {
  expect(x.chains > 0 && x.values.size() % x.chains == 0, "chains are of equal length");
  if (x.draws() < 4) return false;
  bool varies = false;
  for (const double v : x.values) {
    if (!std::isfinite(v)) return false;
    varies = varies || v != x.values[0];
  }
  return varies;
}

double variance(std::span<const double> x) {
  const double m = mean_of(x);
  double s = 0;
  for (const double v : x) s += (v - m) * (v - m);
  return s / double(x.size() - 1);
}

/// The normal scores of the ranks. Ties share their mean rank.
std::vector<double> normal_scores(std::span<const double> x) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  const boost::math::normal_distribution<double> normal;
  std::vector<double> z(x.size());
  for (std::size_t first = 0, last; first < order.size(); first = last) {
    for (last = first + 1; last < order.size() && x[order[last]] == x[order[first]];) ++last;
    const double rank = 0.5 * double(first + 1 + last);  // ranks count from 1
    const double score = boost::math::quantile(normal, (rank - 0.375) / (double(x.size()) + 0.25));
    for (std::size_t i = first; i < last; ++i) z[order[i]] = score;
  }
  return z;
}

double r_hat_of(const Halves& h) {
  std::vector<double> means;
  std::vector<double> variances;
  for (std::size_t c = 0; c < h.chains; ++c) {
    means.push_back(mean_of(h.chain(c)));
    variances.push_back(variance(h.chain(c)));
  }
  const double n = double(h.draws);
  const double between = variance(means);  // B / N
  const double within = mean_of(variances);
  return std::sqrt(between / within + (n - 1) / n);
}

/// The biased autocovariances of one chain at lags 0 to n - 1, by the Fourier transform of the chain padded with as many zeros.
std::vector<double> autocovariance(std::span<const double> x) {
  std::size_t size = 1;
  while (size < 2 * x.size()) size *= 2;
  std::vector<double> f(size, 0.0);
  const double m = mean_of(x);
  for (std::size_t i = 0; i < x.size(); ++i) f[i] = x[i] - m;
  gsl_fft_real_radix2_transform(f.data(), 1, size);
  f[0] *= f[0];
  f[size / 2] *= f[size / 2];
  for (std::size_t k = 1; k < size / 2; ++k) {
    f[k] = f[k] * f[k] + f[size - k] * f[size - k];
    f[size - k] = 0;
  }
  gsl_fft_halfcomplex_radix2_inverse(f.data(), 1, size);
  f.resize(x.size());
  for (double& v : f) v /= double(x.size());
  return f;
}

double ess_of(const Halves& h) {
  const std::size_t n = h.draws;
  if (n < 3) return nan;
  std::vector<double> covariance(n, 0.0);  // mean over chains of the autocovariance at each lag
  std::vector<double> means;
  for (std::size_t c = 0; c < h.chains; ++c) {
    const auto a = autocovariance(h.chain(c));
    for (std::size_t t = 0; t < n; ++t) covariance[t] += a[t] / double(h.chains);
    means.push_back(mean_of(h.chain(c)));
  }
  const double within = covariance[0] * double(n) / double(n - 1);
  const double all = covariance[0] + (h.chains > 1 ? variance(means) : 0.0);
  if (!(all > 0)) return nan;
  const auto rho = [&](std::size_t t) { return t == 0 ? 1.0 : 1 - (within - covariance[t]) / all; };

  // Sums of neighbours rho(2k) + rho(2k + 1) are positive for a reversible chain. The sum ends where noise makes them negative.
  std::vector<double> r(n, 0.0);
  std::size_t t = 0;
  double even = 1;
  double odd = rho(1);
  r[0] = even;
  r[1] = odd;
  while (t + 5 < n && even + odd > 0) {
    t += 2;
    even = rho(t);
    odd = rho(t + 1);
    if (even + odd >= 0) {
      r[t] = even;
      r[t + 1] = odd;
    }
  }
  const std::size_t last = t;
  if (even > 0) r[last] = even;
  for (std::size_t k = 2; k + 2 <= last; k += 2)
    if (r[k] + r[k + 1] > r[k - 2] + r[k - 1]) r[k] = r[k + 1] = 0.5 * (r[k - 2] + r[k - 1]);

  const double total = double(h.chains * n);
  const double tau = -1 + 2 * std::accumulate(r.begin(), r.begin() + std::ptrdiff_t(last), 0.0) + r[last];
  return total / std::max(tau, 1 / std::log10(total));
}

/// Means over the walkers that move together: (group of walkers, draw).
std::vector<double> group_means(ChainDraws x) {
  const std::size_t n = x.draws();
  std::vector<double> means(x.chains / x.walkers * n, 0.0);
  for (std::size_t c = 0; c < x.chains; ++c)
    for (std::size_t i = 0; i < n; ++i) means[c / x.walkers * n + i] += x.values[c * n + i] / double(x.walkers);
  return means;
}

/// The effective sample size of values, (chain, draw), with the layout of x.
double ess_of(std::span<const double> values, ChainDraws x) {
  const double own = ess_of(halves(values, x.chains));
  if (x.walkers == 1) return own;
  expect(x.chains % x.walkers == 0, "groups have equally many walkers");
  const auto means = group_means({values, x.chains, x.walkers});
  const double of_means = variance(means);
  if (!(of_means > 0)) return own;
  const double together = ess_of(halves(means, x.chains / x.walkers)) * variance(values) / of_means;
  return std::isnan(together) ? own : std::min(own, together);
}

}  // namespace

double mean_of(std::span<const double> x) { return std::accumulate(x.begin(), x.end(), 0.0) / double(x.size()); }

double split_r_hat(ChainDraws x) {
  if (!defined_for(x)) return nan;
  const double middle = quantile(x.values, 0.5);
  std::vector<double> folded(x.values.begin(), x.values.end());
  for (double& v : folded) v = std::abs(v - middle);
  const double bulk = r_hat_of(halves(normal_scores(x.values), x.chains));
  if (!defined_for({folded, x.chains})) return bulk;  // there are two values, equally far from the middle
  return std::max(bulk, r_hat_of(halves(normal_scores(folded), x.chains)));
}

double ess_mean(ChainDraws x) { return defined_for(x) ? ess_of(x.values, x) : nan; }

double ess_bulk(ChainDraws x) { return defined_for(x) ? ess_of(normal_scores(x.values), x) : nan; }

double ess_indicator(ChainDraws x, double bound) {
  if (!defined_for(x)) return nan;
  std::vector<double> below(x.values.size());
  for (std::size_t i = 0; i < below.size(); ++i) below[i] = x.values[i] <= bound ? 1 : 0;
  return ess_mean({below, x.chains, x.walkers});
}

double ess_quantile(ChainDraws x, double p) { return defined_for(x) ? ess_indicator(x, quantile(x.values, p)) : nan; }

double ess_tail(ChainDraws x) {
  const double low = ess_quantile(x, 0.05);
  const double high = ess_quantile(x, 0.95);
  return std::isnan(low) || std::isnan(high) ? nan : std::min(low, high);
}

double mcse_mean(ChainDraws x) { return defined_for(x) ? std::sqrt(variance(x.values) / ess_mean(x)) : nan; }

double mcse_sd(ChainDraws x) {
  if (!defined_for(x)) return nan;
  const double m = mean_of(x.values);
  std::vector<double> square(x.values.begin(), x.values.end());
  for (double& v : square) v = (v - m) * (v - m);
  const double m2 = mean_of(square);
  double m4 = 0;
  for (const double v : square) m4 += v * v / double(square.size());
  const double ess = ess_mean({square, x.chains, x.walkers});
  return std::sqrt((m4 - m2 * m2) / ess / m2) / 2;
}

double mcse_quantile(ChainDraws x, double p) {
  const double ess = ess_quantile(x, p);
  if (std::isnan(ess)) return nan;
  const boost::math::beta_distribution<double> beta(ess * p + 1, ess * (1 - p) + 1);
  std::vector<double> sorted(x.values.begin(), x.values.end());
  std::sort(sorted.begin(), sorted.end());
  const double total = double(sorted.size());
  const boost::math::normal_distribution<double> normal;
  const auto at = [&](double rank) { return sorted[std::size_t(std::clamp(rank, 1.0, total)) - 1]; };
  const double low = at(std::floor(total * boost::math::quantile(beta, boost::math::cdf(normal, -1))));
  const double high = at(std::ceil(total * boost::math::quantile(beta, boost::math::cdf(normal, 1))));
  return 0.5 * (high - low);
}

void EnergyChanges::add(double energy) {
  if (n_ > 0) changes_ += (energy - last_) * (energy - last_);
  n_ += 1;
  last_ = energy;
  const double before = energy - mean_;
  mean_ += before / n_;
  squares_ += before * (energy - mean_);
}

double EnergyChanges::e_bfmi() const { return n_ >= 4 && squares_ > 0 ? changes_ / squares_ : nan; }

double quantile(std::span<const double> values, double p) {
  expect(!values.empty(), "a quantile needs at least one value");
  std::vector<double> sorted(values.begin(), values.end());
  const double place = p * double(sorted.size() - 1);
  const auto low = std::size_t(place);
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(low), sorted.end());
  const double a = sorted[low];
  if (low + 1 >= sorted.size() || place == double(low)) return a;
  const double b = *std::min_element(sorted.begin() + std::ptrdiff_t(low) + 1, sorted.end());
  return a + (place - double(low)) * (b - a);
}

}  // namespace calomel
