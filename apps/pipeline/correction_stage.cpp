// The correction for the mesh that ENC and SPE take from the posterior's emulator.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/pipeline/posterior_stage.hpp"
#include "apps/pipeline/stages.hpp"

namespace calomel {

bool Stages::corrects_mesh(std::string* why) const {
  const auto tell = [&](const char* reason) {
    if (why) *why = reason;
    return false;
  };
  if (!study_.forward.geometry.resolved().element_size) return tell("the mesh comes from a file, of which the program makes no finer one");
  return element_sizes(study_).size() > 1 || tell("the emulator has one mesh only (emulator.element_sizes)");
}

const MeshCorrection* Stages::mesh_correction(const std::string& method, bool wanted, const CalibrationProgress& progress) {
  if (!wanted) return nullptr;
  std::string why;
  if (!corrects_mesh(&why)) {
    say(fmt::format("{}: predictions are not corrected for the mesh: {}", method, why));
    return nullptr;
  }
  if (correction_) return &*correction_;
  const double own = *study_.forward.geometry.resolved().element_size;
  const auto sizes = element_sizes(study_);
  const auto at = std::find_if(sizes.begin(), sizes.end(), [&](double size) { return std::abs(size / own - 1) < 1e-9; });
  if (at == sizes.end())
    throw InputError({.problem = fmt::format("the case's element size, {} m, is none of the emulator's, so it cannot be corrected for the mesh", own),
                      .key = "emulator.element_sizes",
                      .suggestion = fmt::format("add the case's element size or set {}.mesh_correction = false", method)});
  const CasePosterior& made = case_posterior(progress);
  const PosteriorFit& fit = made.fit;
  if (!fit.settled) say(fmt::format("warning: {}: the emulator {}", method, fit.message));
  // The emulator's runs are at its own viscosity, those of the case at what the mesh decides.
  const auto& parameters = made.inputs->parameters;
  const double own_viscosity = model().describe().viscosity;
  std::vector<double> fine, working;
  for (std::size_t k = model().shape().parameters.size(); k < parameters.size(); ++k) {
    const Parameter& p = parameters[k];
    fine.push_back(*p.nominal), working.push_back(p.key == viscosity_key ? own_viscosity : *p.nominal);
  }
  const bool told = std::any_of(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.key == viscosity_key; });
  if (!told && std::abs(own_viscosity / study_.emulator.viscosity - 1) > 1e-6)
    say(fmt::format("warning: {}: the case's mesh has a regularising viscosity of {:.4g} Pa s, the emulator one of {:.4g}, and emulator.viscosity_sd = 0: the difference is not taken off", method,
                    own_viscosity, study_.emulator.viscosity));
  correction_.emplace(fit.posterior->box(), fit.posterior->emulator(), fit.histories(), int(sizes.end() - at) - 1, fine, working);
  return &*correction_;
}

}  // namespace calomel
