#include "apps/pipeline/spe_stage.hpp"

#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/feasibility.hpp"

namespace calomel {

SpeSummary spe_stage(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& options = inputs.study().spe;
  const Archive archive = read_archive(inputs.artefact("campaign.nc"));
  inputs.notes().say(failure_lines(archive, Feasibility(archive)));
  const MeshCorrection* correction = call.correction.get("spe", options.mesh_correction, progress);
  const SimulatedModel model(inputs.runs());
  auto summary = run_spe(inputs.problem(), archive, model, options, command.seed, command.threads, progress, correction);
  summary.message = calibration_message(summary);
  for (const auto& warnings : {surrogate_warnings(summary), calibration_warnings(summary, inputs.problem().shape)})
    summary.warnings.insert(summary.warnings.end(), warnings.begin(), warnings.end());
  const CalibrationWords words = calibration_words(summary, inputs.problem().shape);
  write_spe(summary, inputs.problem(), words, provenance, command.out);
  inputs.notes().say(spe_lines(words));
  return summary;
}

}  // namespace calomel
