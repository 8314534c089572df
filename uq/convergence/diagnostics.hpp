#pragma once
/// How well chains have converged and how much their draws are worth: Vehtari, Gelman, Simpson, Carpenter and Bürkner 2021, Rank-normalization,
/// folding, and localization: an improved R-hat for assessing convergence of MCMC, Bayesian Analysis 16, 667. Equations are theirs.
///
/// All take the draws of one quantity, (chain, draw) row-major, chains of equal length. NaN means that there is no answer: fewer than four
/// draws a chain, a draw that is not finite, or draws that are all equal.
#include <span>

namespace calomel {

struct ChainDraws {
  std::span<const double> values;  ///< (chain, draw)
  std::size_t chains = 1;
  std::size_t walkers = 1;  ///< chains that move together, one after another
  [[nodiscard]] std::size_t draws() const { return chains > 0 ? values.size() / chains : 0; }
};

[[nodiscard]] double mean_of(std::span<const double> x);

/// Rank-normalised split R-hat [1]: the larger of that of the ranks' normal scores z = Phi^-1((r - 3/8) / (S + 1/4)) (equation 14) and that of
/// the folded draws |x - median(x)| (section 4.2). R-hat = sqrt(((N - 1)/N W + B/N) / W) over halves of chains (equations 1 to 4); infinite where chains do
/// not move and stand apart.
double split_r_hat(ChainDraws x);

/// Effective sample size of the mean: S / tau, tau from autocorrelations combined over halves of chains (equation 10), summed in pairs while these are
/// positive and made monotone (Geyer 1992, section 3.3). Above the number of draws where they alternate; at most S log10 S. Walkers that move together are not
/// independent of one another from one draw to the next, which their own autocorrelations do not tell: given is the smaller of that size and var(x) over the
/// variance of the mean that follows from the autocorrelations of the walkers' mean (Goodman and Weare 2010, section 3).
double ess_mean(ChainDraws x);
/// The same of the normal scores of the ranks: how well the bulk is known.
double ess_bulk(ChainDraws x);
/// Of the indicator x <= x_p, x_p the quantile of all draws.
double ess_quantile(ChainDraws x, double p);
/// Of the indicator x <= bound.
double ess_indicator(ChainDraws x, double bound);
/// The smaller of those at 5 and 95 %: how well the tails are known.
double ess_tail(ChainDraws x);

/// Monte Carlo standard error of the mean, sd / sqrt(ess_mean) [unit of x].
double mcse_mean(ChainDraws x);
/// Of the standard deviation, by the delta method from the mean of (x - mean)^2: sqrt((m4 - m2^2) / ess) / (2 sqrt(m2)), ess that of (x - mean)^2 [unit of x].
double mcse_sd(ChainDraws x);
/// Of a quantile: half the distance of the order statistics at the 15.9 and 84.1 % points of Beta(n p + 1, n (1 - p) + 1), n = ess_quantile
/// (section 4.4) [unit of x].
double mcse_quantile(ChainDraws x, double p);

/// Sums of a chain's energies E_n, one after another, for
///   E-BFMI = sum (E_n - E_(n-1))^2 / sum (E_n - mean E)^2,
/// the share of the energy's spread that fresh momenta reach in a transition (Betancourt 2016, arXiv:1604.00695): about 1 where they do, below 0.3 where
/// tails are so heavy that the chain explores them by diffusion.
class EnergyChanges {
 public:
  void add(double energy);
  /// NaN of fewer than four energies, or of energies that are all equal.
  [[nodiscard]] double e_bfmi() const;

 private:
  double n_ = 0, mean_ = 0, squares_ = 0, changes_ = 0, last_ = 0;
};

/// Quantile of finite values by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996).
double quantile(std::span<const double> values, double p);

}  // namespace calomel
