#include "apps/presentation/posterior_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/presentation/convergence_words.hpp"
#include "apps/presentation/fit_words.hpp"
#include "inverse/posterior/compared_errors.hpp"

namespace calomel {

std::string round_line(const PosteriorRound& r, const std::vector<Parameter>& parameters) {
  std::string at;
  for (std::size_t k = 0; k < parameters.size(); ++k) at += fmt::format("{}{} {:.5g} ± {:.2g}", k ? ", " : "", parameters[k].name, r.theta[k], r.theta_sd[k]);
  return fmt::format("emulator: {} coarse and {} fine runs{}: {}; emulator's variance {:.2g}", r.coarse, r.fine,
                     r.failed ? fmt::format(" ({} failed)", r.failed) : "", at, r.variance);
}

std::vector<std::string> draws_lines(const Convergence& convergence) {
  std::vector<std::string> lines;
  for (const auto& p : convergence.parameters)
    lines.push_back(
        fmt::format("sample: {} {:.5g} ± {:.2g} (90 %: {:.5g} to {:.5g}; R-hat {:.3f}, ESS {:.0f})", p.name, p.mean, p.sd, p.q05, p.q95, p.r_hat, p.ess_bulk));
  return lines;
}

std::string emulator_sentence(const PosteriorFit& fit) { return "the emulator " + settling_text(fit.settling()); }

std::vector<std::string> setup_sentences(const SetupFindings& findings) {
  std::vector<std::string> out;
  for (const auto& name : findings.uniform_priors)
    out.push_back(fmt::format("{} has a uniform prior: it can imitate an omitted effect; give it a prior from independent knowledge", name));
  if (findings.jitter_standard_errors > 0)
    out.push_back(
        fmt::format("the model does not repeat itself: two runs at nearly one point differ by {:.2g} standard errors of the records; it is fitted by an "
                    "emulator that takes this for noise. If it chooses its steps itself or stops an iteration early, fix the steps or tighten the tolerance",
                    findings.jitter_standard_errors));
  return out;
}

std::string front_sentence(double elements_per_front, double finest_size) {
  return fmt::format(
      "the emulator's finest mesh, {:.3g} mm, has only {:.1f} elements through the front of the pulse: on such meshes the parameters were off by 1.4 to 1.8 "
      "times the deviations reported here; with "
      "elements of {:.3g} mm (emulator.element_sizes) they were not",
      1e3 * finest_size, elements_per_front, 0.5e3 * finest_size * elements_per_front);
}

std::string absorption_sentence(const std::string& parameter, double prior_sds) {
  return fmt::format("{} is {:.2g} prior standard deviations {} its prior mean: it compensates for an omitted effect", parameter, std::abs(prior_sds),
                     prior_sds > 0 ? "above" : "below");
}

std::string modes_sentence(const LogDensity& density, const std::vector<LaplaceMode>& modes) {
  const auto names = density.quantities();
  std::string places;
  for (const auto& m : modes) {
    const auto values = density.constrained({m.x.data(), std::size_t(m.x.size())});
    places += places.empty() ? "" : "; ";
    for (std::size_t k = 0; k < values.size(); ++k) places += fmt::format("{}{} = {:.4g}", k ? ", " : "", names[k], values[k]);
    places += fmt::format(" (share about {:.2g})", m.weight);
  }
  return fmt::format("the density has {} modes: {}. Chains begin in all of them", modes.size(), places);
}

std::string inflation_sentence(const NoiseInflation& inflation, const std::vector<std::string>& names) {
  const auto most = std::size_t(std::max_element(inflation.sd_ratio.begin(), inflation.sd_ratio.end()) - inflation.sd_ratio.begin());
  return fmt::format(
      "averaged over {} draws of the emulator's noise ({:.1f} effective): standard deviations are {:.2f} to {:.2f} times those with its estimate alone, the "
      "largest ratio for {}",
      inflation.weights.size(), inflation.effective_draws, *std::min_element(inflation.sd_ratio.begin(), inflation.sd_ratio.end()), inflation.sd_ratio[most],
      names[most]);
}

std::string form_sentence(const std::string& form) {
  if (form == no_mesh_errors) return "the same errors without those of the mesh and without numerical noise";
  expect(form == independent_errors, "a form of errors has a name that is known");
  return "independent normal errors of the band's deviation at every sample, without nuisances: the published form";
}

std::string estimate_only_reason(const SamplerOptions& sampler) {
  if (sampler.entry().first_stage.empty()) return "their estimate alone (posterior.hyperparameter_draws)";
  std::string name = sampler.kind;
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + " walks on the posterior with their estimate";
}

std::string refinement_sentence(const RefinedFit& fit) {
  int runs = 0;
  for (const auto& r : fit.refinements) runs += r.runs;
  if (fit.refinements.empty()) return fmt::format("the emulator was not refined: {}", refinement_end(fit.ended));
  return fmt::format("the emulator was refined {} by {} further runs: {}",
                     fit.refinements.size() == 1 ? "once" : fmt::format("{} times", fit.refinements.size()), runs, refinement_end(fit.ended));
}

std::string verdict_sentence(const Convergence& convergence, const PosteriorFit& fit, const TrueModelCheck& check) {
  if (!convergence.converged) return convergence_sentence(convergence);
  if (!fit.settled) return emulator_sentence(fit);
  return check.holds ? convergence_sentence(convergence) : check_sentence(check);
}

}  // namespace calomel
