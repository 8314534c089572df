#include "apps/pipeline/train_stage.hpp"

#include "apps/inputs/provenances.hpp"
#include "apps/pipeline/campaign_stage.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/training.hpp"

namespace calomel {

ExitStatus train_stage(StageCall& call, Requested requested) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto upstream = campaign_stage(call, Requested::upstream);
  const auto provenance = train_provenance(inputs);
  if (!call.finished.due(provenance, {"train.json", "surrogate.nc"}, requested)) {
    inputs.notes().say(reused_line("train"));
    call.trained = true;
    return upstream;
  }
  if (requested == Requested::upstream) inputs.notes().say(made_first_line("trained surrogate", command.out, "training"));
  const auto training = inputs.study().file.locating(
      [&] { return run_training(read_archive(inputs.artefact("campaign.nc")), inputs.study().surrogate, command.seed, command.threads); });
  training.surrogates.at(0)->save(inputs.artefact("surrogate.nc"));
  write_train_json(inputs.artefact("train.json"), training.summary, provenance);
  inputs.notes().say(train_lines(training.summary));
  call.trained = true;
  return upstream;
}

void need_basin(StageCall& call) {
  auto& inputs = call.inputs;
  if (call.trained || !basin_on_surrogate(inputs.study())) return;
  if (inputs.command().fresh || !std::filesystem::exists(inputs.artefact("surrogate.nc")))  // what is wrong with the meshes is reported before the campaign
    (void)inputs.study().file.locating([&] { return inputs.simulator().mesh_scale(meshed_runs(inputs.runs(), inputs.study().posterior_settings()).mesh(0)); });
  (void)train_stage(call, Requested::upstream);
}

}  // namespace calomel
