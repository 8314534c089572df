#include "inverse/posterior/drawn_noise.hpp"

#include <boost/random/gamma_distribution.hpp>
#include <optional>

#include "base/parallel.hpp"
#include "base/random.hpp"

namespace calomel {

namespace {

constexpr std::uint64_t stream = 0xb007;

/// The same hypotheses with another numerical noise of the records.
std::vector<WeightedErrors> with_noise(const std::vector<WeightedErrors>& hypotheses, const Eigen::MatrixXd& noise) {
  std::vector<WeightedErrors> out = hypotheses;
  for (auto& h : out) h.errors = h.errors.without(record_noise_term).with_record_noise(noise);
  return out;
}

}  // namespace

Eigen::VectorXd bootstrap_weights(const Eigen::VectorXd& left, std::uint64_t seed, std::uint64_t draw) {
  RandomStream random(seed ^ stream, draw);
  Eigen::VectorXd a(left.size());
  for (Eigen::Index i = 0; i < left.size(); ++i) a[i] = boost::random::gamma_distribution<double>(left[i])(random);
  expect(a.sum() > 0, "some run has a weight");
  return left.sum() / a.sum() * a;
}

std::vector<DrawnNoise> draw_noise(const PosteriorInputs& in, const PosteriorFit& fit, int draws, std::uint64_t seed, int threads) {
  const MultilevelRegression& estimate = fit.posterior->emulator();
  const Decimation& grid = fit.errors->grid();
  const Eigen::MatrixXd outputs = grid.apply(fit.histories());
  const Eigen::VectorXd left = (1 - estimate.leverage().array()).matrix();
  const Eigen::VectorXd squares = left.cwiseAbs2().cwiseProduct(estimate.left_out(outputs).colwise().squaredNorm().transpose());  // of the runs' own residuals
  if (!(squares.sum() > 0) || !(fit.noise.trace() > 0)) return {};
  std::vector<std::optional<DrawnNoise>> made(std::size_t(std::max(0, draws)));
  parallel_for(made.size(), threads, [&](std::size_t b) {
    const Eigen::VectorXd a = bootstrap_weights(left, seed, b);
    std::vector<double> ratio = estimate.level_noise(a.cwiseQuotient(left).cwiseProduct(squares), a);
    const double finest = ratio[0];
    for (double& r : ratio) r /= finest;
    const MultilevelRegression emulator = estimate.with_noise_ratio(ratio);
    const Eigen::VectorXd factor = a.cwiseQuotient((1 - emulator.leverage().array()).matrix()).cwiseSqrt();
    const Eigen::MatrixXd noise = numerical_noise(grid, emulator.residuals(outputs) * factor.asDiagonal(), left.sum(), in.errors.amplitude_time);
    LogPosterior posterior(fit.posterior->box(), emulator, emulator.fit(outputs), with_noise(fit.hypotheses, noise), noise, fit.posterior->priors(),
                           fit.posterior->beyond_prior());
    made[b].emplace(DrawnNoise{.posterior = std::move(posterior), .noise_ratio = std::move(ratio), .scale = noise.trace() / fit.noise.trace()});
  });
  std::vector<DrawnNoise> out;
  for (auto& m : made) out.push_back(std::move(*m));
  return out;
}

}  // namespace calomel
