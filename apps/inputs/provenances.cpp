#include "apps/inputs/provenances.hpp"

#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"
#include "inverse/posterior/emulator_meshes.hpp"

namespace calomel {

namespace {

Json pulses_of(const CampaignOptions& campaign) { return {{"pulses", campaign.pulses}, {"pulse_energy_sd", campaign.pulse_energy_sd}}; }

/// A stage that runs the case's model, which its options are those of.
Provenance of_model(const StudyInputs& inputs, const std::string& stage) {
  SimulatorIdentity model = inputs.study().simulator->identity();
  return {.stage = stage, .options = std::move(model.options), .seed = inputs.command().seed, .inputs = std::move(model.inputs)};
}

Json posterior_options(const StudyCase& study) {
  Json options{{"product", study.map.product}, {"sampler", identity_options(study.sampler)}};
  if (!study.capabilities().log_density) {
    options["emulator"] = echo(study.emulator);
    options["errors"] = echo(study.errors);
  }
  if (study.recordings) options["recordings"] = echo(*study.recordings);
  for (const auto& p : study.parameters()) options["parameter"][p.name] = echo(p);
  return options;
}

/// The artefact that the first box of the emulator is found on, where there is one.
void add_basin(Provenance& provenance, const StudyInputs& inputs) {
  if (basin_on_surrogate(inputs.study())) provenance.inputs["surrogate.nc"] = hash_file(inputs.artefact("surrogate.nc"));
}

Provenance map_provenance(const StudyInputs& inputs) {
  Provenance p = posterior_provenance(inputs);
  p.stage = "map";
  p.options["map"] = echo(inputs.study().map);
  p.options.erase("sampler");
  p.options.erase("posterior");
  if (inputs.study().map.compare_with.empty()) return p;
  const auto nested = nested_directory(inputs) / "map.json";
  if (std::filesystem::exists(nested)) p.inputs["map.compare_with"] = hash_file(nested);
  return p;
}

}  // namespace

Provenance simulate_provenance(const StudyInputs& inputs) {
  Provenance p = of_model(inputs, "simulate");
  p.options.merge_patch(inputs.study().simulator->identity().simulate);
  return p;
}

Provenance floor_provenance(const StudyInputs& inputs) {
  Provenance p = of_model(inputs, "floor");
  p.options["campaign"] = pulses_of(inputs.study().campaign);
  p.options["floor"] = echo(inputs.study().floor);
  return p;
}

Provenance campaign_provenance(const StudyInputs& inputs) {
  Provenance p = of_model(inputs, "campaign");
  p.options["campaign"] = identity_options(inputs.study().campaign);
  return p;
}

Provenance train_provenance(const StudyInputs& inputs) {
  return {.stage = "train",
          .options = {{"surrogate", echo(inputs.study().surrogate)}},
          .seed = inputs.command().seed,
          .inputs = {{"campaign.nc", hash_file(inputs.artefact("campaign.nc"))}}};
}

Provenance runs_provenance(const StudyCase& study) { return runs_provenance(study, *study.simulator); }

Provenance runs_provenance(const StudyCase& study, const Simulator& simulator) {
  SimulatorIdentity model = simulator.identity();
  model.options.erase("parameter");  // requests name what they set
  model.options["campaign"] = pulses_of(study.campaign);
  return {.stage = "runs", .options = std::move(model.options), .seed = 0, .inputs = std::move(model.inputs)};
}

namespace {

/// Of what works on the posterior of the parameters.
Provenance on_posterior(const StudyInputs& inputs, std::string stage) {
  const auto& study = inputs.study();
  return {.stage = std::move(stage),
          .options = posterior_options(study),
          .seed = inputs.command().seed,
          .inputs = {{"model", runs_provenance(study).identity()}, {"recordings", hash_file(study.recordings_file())}}};
}

/// Of a log density, which holds its own data.
Provenance of_density(const StudyInputs& inputs, std::string stage) {
  const auto& study = inputs.study();
  return {
      .stage = std::move(stage), .options = posterior_options(study), .seed = inputs.command().seed, .inputs = {{"model", runs_provenance(study).identity()}}};
}

}  // namespace

Provenance posterior_provenance(const StudyInputs& inputs) {
  const bool density = inputs.study().capabilities().log_density;
  Provenance p = density ? of_density(inputs, "posterior") : on_posterior(inputs, "posterior");
  if (!density) p.options["posterior"] = echo(inputs.study().posterior);
  if (inputs.study().capabilities().cheap_runs) p.options["on_emulator"] = inputs.study().file.has("surrogate");  // two densities of two boxes
  add_basin(p, inputs);
  return p;
}

Provenance sensitivity_provenance(const StudyInputs& inputs, bool by_surrogate) {
  const auto& study = inputs.study();
  Provenance p{.stage = "sensitivity", .options = {{"sensitivity", identity_options(study.sensitivity)}}, .seed = inputs.command().seed, .inputs = {}};
  for (const auto& q : study.parameters()) p.options["parameter"][q.name] = echo(q);
  if (by_surrogate) {
    p.inputs["surrogate.nc"] = hash_file(inputs.artefact("surrogate.nc"));
    p.inputs["campaign.nc"] = hash_file(inputs.artefact("campaign.nc"));
  } else {
    p.inputs["model"] = runs_provenance(study).identity();
  }
  return p;
}

Provenance diagnosis_provenance(const StudyInputs& inputs) {
  Provenance p = on_posterior(inputs, "diagnosis");
  p.options.erase("sampler");
  const Json offered = inputs.study().simulator->identity().offered;
  for (const auto& [key, value] : offered.items()) p.options[key] = value;
  p.options["diagnosis"] = echo(inputs.study().diagnosis);
  return p;
}

Provenance power_provenance(const StudyInputs& inputs) {
  const auto& study = inputs.study();
  Provenance p{.stage = "power", .options = posterior_options(study), .seed = inputs.command().seed, .inputs = {{"model", runs_provenance(study).identity()}}};
  p.options.erase("sampler");
  p.options["power"] = echo(study.power);
  return p;
}

Provenance calibration_provenance(const StudyInputs& inputs, const std::string& method) {
  if (method == "map") return map_provenance(inputs);
  const auto& study = inputs.study();
  const bool spe = method == "spe";
  const std::string learnt_from = spe ? "campaign.nc" : "surrogate.nc";  // SPE learns from the campaign itself
  Provenance p{.stage = method,
               .options = {{method, spe ? echo(study.spe) : echo(study.enc)}, {"recordings", echo(*study.recordings)}},
               .seed = inputs.command().seed,
               .inputs = {{learnt_from, hash_file(inputs.artefact(learnt_from))}, {"recordings", hash_file(study.recordings_file())}}};
  if (takes_emulator(study, method)) {
    const Json posterior = posterior_options(study);
    for (const char* key : {"product", "emulator", "errors", "parameter"})  // the emulator's box and the runs that it is trained on
      if (posterior.contains(key)) p.options[key] = posterior[key];
    add_basin(p, inputs);
  }
  return p;
}

Provenance comparison_provenance(const StudyInputs& inputs) {
  return {.stage = "comparison", .seed = inputs.command().seed, .inputs = {{"recordings", hash_file(inputs.study().recordings_file())}}};
}

bool basin_on_surrogate(const StudyCase& study) { return calomel::basin_on_surrogate(*study.simulator, study.emulator, study.physical()); }

bool takes_emulator(const StudyCase& study, const std::string& method) {
  if (method == "map") return true;
  return (method == "spe" ? study.spe.mesh_correction : study.enc.mesh_correction) &&
         emulator_meshes(*study.simulator, study.emulator) == EmulatorMeshes::several;
}

std::filesystem::path nested_directory(const StudyInputs& inputs) { return inputs.command().case_file.parent_path() / inputs.study().map.compare_with; }

}  // namespace calomel
