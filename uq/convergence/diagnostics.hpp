#pragma once
/// Diagnostics of convergence and effective sample sizes: Vehtari, Gelman, Simpson, Carpenter and Bürkner 2021, Rank-normalization, folding, and localization:
/// an improved R-hat for assessing convergence of MCMC, Bayesian Analysis 16, 667. Equation and section numbers are those of this paper.
///
/// All functions take the draws of one quantity, (chain, draw) row-major, in chains of equal length. They return NaN for fewer than four draws a chain, for a
/// draw that is not finite, and for draws that are all equal.
#include <span>

namespace calomel {

/// The draws of one quantity.
struct ChainDraws {
  std::span<const double> values;  ///< (chain, draw)
  std::size_t chains = 1;
  std::size_t walkers = 1;  ///< number of consecutive chains that move together
  [[nodiscard]] std::size_t draws() const { return chains > 0 ? values.size() / chains : 0; }
};

/// The arithmetic mean.
[[nodiscard]] double mean_of(std::span<const double> x);

/// Rank-normalised split R-hat [-]: the larger of two values, that of the ranks' normal scores z = Phi^-1((r - 3/8) / (S + 1/4)) (equation 14) and that of the
/// folded draws |x - median(x)| (section 4.2). R-hat = sqrt(((N - 1)/N W + B/N) / W) over halves of chains (equations 1 to 4). It is infinite where chains do
/// not move and differ.
double split_r_hat(ChainDraws x);

/// Effective sample size of the mean, S / tau. tau comes from autocorrelations combined over halves of chains (equation 10), summed in pairs while these are
/// positive and made monotone (Geyer 1992, section 3.3). It exceeds the number of draws where autocorrelations alternate, and is at most S log10 S. Walkers
/// that move together depend on one another, which their own autocorrelations do not show. For them it is the smaller of that size and of var(x) over the
/// variance of the mean by the autocorrelations of the walkers' mean (Goodman and Weare 2010, section 3).
double ess_mean(ChainDraws x);
/// Effective sample size of the bulk: that of the normal scores of the ranks.
double ess_bulk(ChainDraws x);
/// Effective sample size of the indicator x <= x_p, with x_p the quantile of all draws.
double ess_quantile(ChainDraws x, double p);
/// Effective sample size of the indicator x <= bound.
double ess_indicator(ChainDraws x, double bound);
/// Effective sample size of the tails: the smaller of ess_quantile at 5 and 95 %.
double ess_tail(ChainDraws x);

/// Monte Carlo standard error of the mean, sd / sqrt(ess_mean) [unit of x].
double mcse_mean(ChainDraws x);
/// Monte Carlo standard error of the standard deviation, by the delta method: sqrt((m4 - m2^2) / ess) / (2 sqrt(m2)), with ess that of (x - mean)^2 [unit of
/// x].
double mcse_sd(ChainDraws x);
/// Monte Carlo standard error of a quantile: half the distance of the order statistics at the 15.9 and 84.1 % points of Beta(n p + 1, n (1 - p) + 1), with n =
/// ess_quantile (section 4.4) [unit of x].
double mcse_quantile(ChainDraws x, double p);

/// Running sums of a chain's energies E_n for
///   E-BFMI = sum (E_n - E_(n-1))^2 / sum (E_n - mean E)^2,
/// the share of the energy's variance that new momenta reach in a transition (Betancourt 2016, arXiv:1604.00695). It is about 1 where they reach all of it, and
/// below 0.3 where tails are so heavy that the chain explores them by diffusion.
class EnergyChanges {
 public:
  void add(double energy);
  /// E-BFMI [-]; NaN for fewer than four energies, or energies that are all equal.
  [[nodiscard]] double e_bfmi() const;

 private:
  double n_ = 0;
  double mean_ = 0;
  double squares_ = 0;
  double changes_ = 0;
  double last_ = 0;
};

/// The quantile of finite values, by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996).
double quantile(std::span<const double> values, double p);

}  // namespace calomel
