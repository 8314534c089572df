#include "uq/diagnosis/reported_moments.hpp"

#include <algorithm>
#include <cmath>

#include "uq/diagnosis/verdict.hpp"

namespace calomel {

Moments tempered_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed) {
  return sampled_moments(posterior.to_the_power(1 / Gates{}.temperature), mode, seed);
}

double tempered_sd(double sd, double prior_sd) {
  const double of_prior = 1 / (prior_sd * prior_sd);
  return 1 / std::sqrt(of_prior + (1 / (sd * sd) - of_prior) / Gates{}.temperature);
}

Moments reported_moments(const PosteriorFit& fit, std::uint64_t seed) {
  const LocalMode& m = fit.modes[0];
  Moments moments = tempered_moments(*fit.posterior, m, seed);
  std::size_t first = std::min<std::size_t>(1, fit.rounds.size() - 1);  // the first fit may be far off
  for (std::size_t r = 0; r + 1 < fit.rounds.size(); ++r)
    if (fit.rounds[r].shrank_box) first = r + 1;  // and so may be the emulator of a wider box
  const auto n = double(fit.rounds.size() - first);
  const auto& free = fit.posterior->free();
  for (std::size_t i = 0; i < free.size() && n > 1; ++i) {
    double sum = 0, squares = 0;
    for (std::size_t r = first; r < fit.rounds.size(); ++r) {
      const double t = fit.rounds[r].theta[std::size_t(free[i])] - m.at.theta[std::size_t(free[i])];
      sum += t;
      squares += t * t;
    }
    double& sd = moments.sd[Eigen::Index(i)];
    sd = std::sqrt(sd * sd + (squares - sum * sum / n) / (n - 1));
  }
  return moments;
}

}  // namespace calomel
