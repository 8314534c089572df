#include "apps/pipeline/sample_emulator.hpp"

#include "apps/pipeline/sample_artefacts.hpp"
#include "apps/pipeline/sample_parts.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "base/json.hpp"
#include "forward/emulator/infill.hpp"
#include "inverse/posterior/compared_errors.hpp"
#include "uq/posterior_moments.hpp"

namespace calomel {

namespace {

constexpr int starts_of_a_search = 8;
constexpr double inner = 0.8;  ///< of the box that these lie in

}  // namespace

SampledEmulator::SampledEmulator(const PosteriorInputs& in, const PosteriorFit& fit, int draws, std::uint64_t seed, int threads)
    : fit_(fit), plain_(*fit.posterior), drawn_(draws > 1 ? draw_noise(in, fit, draws, seed, threads) : std::vector<DrawnNoise>()), asked_(draws > 1) {
  if (!drawn_.empty()) averaged_.emplace(drawn_);
}

Json SampledEmulator::hyperparameters(const SamplerResult& result, const std::string& why_none) const {
  if (!averaged_) return hyperparameters_json(asked_ ? "the runs carry no noise about the emulator" : why_none);
  return hyperparameters_json(drawn_, noise_inflation(*averaged_, *fit_.posterior, result.coordinates, result.quantities), result.quantities.names);
}

Json sample_compared(const std::string& form, const PosteriorInputs& in, const PosteriorFit& fit, const std::vector<std::string>& own,
                     const SamplerOptions& options, const SamplerRun& run) {
  const LogPosterior posterior = compared_posterior(form, in, fit, own.size());
  const EmulatorBox& box = posterior.box();
  std::vector<Eigen::VectorXd> starts{posterior.q(fit.modes[0].at.theta, 0)};
  const Eigen::MatrixXd design = inner * first_design(box.size(), starts_of_a_search, in.seed);
  for (Eigen::Index i = 0; i < design.cols(); ++i) starts.push_back(posterior.q(box.theta(design.col(i)), 0));
  const auto modes = find_modes(posterior, starts);
  if (modes.empty()) throw NumericsError("no mode of the posterior was found under other errors (posterior.compare)");
  const SamplerOptions chains = one_density_options(options);
  const SamplerResult result = run_sampler(PosteriorDensity(posterior), start_at_mode(posterior, modes[0]), chains, run);
  return compared_json(form_sentence(form), assessed(result, chains.thin), regions(result.quantities, own));
}

}  // namespace calomel
