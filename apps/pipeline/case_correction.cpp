#include "apps/pipeline/case_correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inverse/posterior/emulator_meshes.hpp"
#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/run_lines.hpp"

namespace calomel {

namespace {

constexpr double same_viscosity = 1e-6;  ///< relative difference of two viscosities that are one

}  // namespace

void expect_own_mesh_among_emulators(const StudyCase& study, const std::string& method) {
  if (own_level(*study.simulator, study.emulator)) return;
  throw study.file.located(
      InputError({.problem = fmt::format("the case's element size, {} m, is none of the emulator's, so it cannot be corrected for the mesh",
                                         *study.simulator->hints().element_size),
                  .key = "emulator.element_sizes",
                  .suggestion = fmt::format("add the case's element size or set {}.mesh_correction = false", method)}));
}

const MeshCorrection* FittedCorrection::get(const std::string& method, bool wanted, const CalibrationProgress& progress) {
  if (!wanted) return nullptr;
  const auto& study = inputs_.study();
  const auto& notes = inputs_.notes();
  if (const auto meshes = emulator_meshes(inputs_.simulator(), study.emulator); meshes != EmulatorMeshes::several) {
    notes.say(not_corrected_line(method, meshes));
    return nullptr;
  }
  if (correction_) return &*correction_;
  expect_own_mesh_among_emulators(study, method);
  const CasePosterior& made = posterior_.get(progress);
  const PosteriorFit& fit = made.fit;
  std::vector<std::string> reservations;
  if (!fit.settled) reservations.push_back("the correction for the mesh is based on an " + emulator_sentence(fit));
  // The emulator's runs are at its own viscosity, those of the case at what the mesh decides.
  const auto& parameters = made.inputs->parameters;
  const std::string viscosity_key = inputs_.simulator().hints().numerical_viscosity;
  const double own_viscosity = inputs_.simulator().mesh_scale({}).numerical_viscosity;
  std::vector<double> fine, working;
  for (std::size_t k = inputs_.simulator().shape().parameters.size(); k < parameters.size(); ++k) {
    const Parameter& p = parameters[k];
    fine.push_back(*p.nominal), working.push_back(p.key == viscosity_key ? own_viscosity : *p.nominal);
    if (p.key != viscosity_key) continue;
    std::vector<double> there = fit.modes[0].at.theta;
    there[k] = own_viscosity;
    if (!fit.posterior->box().contains(there))
      reservations.push_back(
          fmt::format("the case's own mesh has a regularising viscosity of {:.4g} Pa s, outside those of the emulator: what it does beyond them is not "
                      "corrected. Elements of another size, or a greater emulator.viscosity_sd ({:.3g}), reach it",
                      own_viscosity, study.emulator.viscosity_sd));
  }
  const bool sampled = std::any_of(parameters.begin(), parameters.end(), [&](const Parameter& p) { return p.key == viscosity_key; });
  if (!sampled && std::abs(own_viscosity / study.emulator.viscosity - 1) > same_viscosity)
    notes.warn(viscosity_left_sentence(method, own_viscosity, study.emulator.viscosity));
  correction_.emplace(fit.posterior->box(), fit.posterior->emulator(), fit.histories(), *own_level(inputs_.simulator(), study.emulator), fine, working);
  correction_->reservations = std::move(reservations);
  return &*correction_;
}

}  // namespace calomel
