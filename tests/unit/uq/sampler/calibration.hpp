#pragma once
/// Simulation-based calibration of a sampler: Talts, Betancourt, Simpson, Vehtari and Gelman 2018, arXiv:1804.06788. Parameters are drawn from the prior, data
/// from them, and the rank of the true parameter among L draws from its posterior is uniform on 0, ..., L where the sampler is right, whatever the model.
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <string>
#include <vector>

#include "tests/unit/uq/sampler/conjugate.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel::testing {

inline constexpr std::size_t calibration_draws = 19;  ///< L

/// Settings by which the L draws of one chain, or of the first walker of one ensemble, are nearly independent.
inline SamplerOptions calibration_options(const std::string& kind) {
  SamplerOptions o = default_sampler_options(kind);
  o.chains = 1;
  o.draws = int(calibration_draws);
  o.warmup = kind == "dram" ? 1000 : 300;
  o.thin = kind == "dram" ? 30 : kind == "ensemble" ? 30 : kind == "smc" ? 10 : kind == "nuts" ? 4 : 3;
  return o;
}

/// ln of a density by 0.6: wider, a poor stand-in.
class Widened : public LogDensity {
 public:
  explicit Widened(const LogDensity& whole) : whole_(whole) {}
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return whole_.coordinates(); }
  [[nodiscard]] double log_density(std::span<const double> x) const override { return 0.6 * whole_.log_density(x); }

 private:
  const LogDensity& whole_;
};

/// Ranks of (mu, ln s), {0, ..., L}, of `replications` data sets of one value, so that the prior, and with it the Jacobian, counts. jacobian = false: the
/// control, a posterior that is wrong.
inline std::array<std::vector<std::size_t>, 2> calibration_ranks(const std::string& kind, std::size_t replications, std::uint64_t seed, bool jacobian = true) {
  std::array<std::vector<std::size_t>, 2> ranks;
  const SamplerOptions options = calibration_options(kind);
  for (std::size_t i = 0; i < replications; ++i) {
    RandomStream random(seed, i);
    const auto truth = ConjugateNormal::draw(1, random);
    const ConjugateNormal density(truth.data, jacobian);
    const SamplerStart start{.mean = Eigen::Vector2d(0.5, 0), .covariance = {}, .points = {}};
    const SamplerRun run{.seed = seed + 1 + i};
    const auto r = kind == "delayed_acceptance" ? run_sampler(Widened(density), density, start, options, run) : run_sampler(density, start, options, run);
    const double known[] = {truth.mu, truth.log_s};
    for (std::size_t k = 0; k < 2; ++k) {
      std::size_t rank = 0;
      for (std::size_t j = 0; j < calibration_draws; ++j) rank += r.coordinates.at(0, j, k) < known[k];
      ranks[k].push_back(rank);
    }
  }
  return ranks;
}

/// Probability of a histogram over `bins` equal bins of ranks that is as uneven, by chi-squared, where ranks are uniform. bins divides L + 1.
inline double uniformity(const std::vector<std::size_t>& ranks, std::size_t bins) {
  std::vector<double> counts(bins, 0.0);
  for (const auto r : ranks) counts[r * bins / (calibration_draws + 1)] += 1;
  const double expected = double(ranks.size()) / double(bins);
  double chi2 = 0;
  for (const double c : counts) chi2 += (c - expected) * (c - expected) / expected;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(double(bins - 1)), chi2));
}

}  // namespace calomel::testing
