#include "apps/pipeline/enc_stage.hpp"

#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "forward/surrogate/surrogate.hpp"

namespace calomel {

EncSummary enc_stage(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& options = inputs.study().enc;
  const auto surrogate = load_surrogate(inputs.artefact("surrogate.nc"));
  const Archive archive = read_archive(inputs.artefact("campaign.nc"));
  const Feasibility feasibility(archive);
  inputs.notes().say(failure_lines(archive, feasibility));
  const MeshCorrection* correction = call.correction.get("enc", options.mesh_correction, progress);
  const SimulatedModel model(inputs.runs());
  auto summary = run_enc(inputs.problem(), GuardedModel(*surrogate, feasibility), model, options, command.seed, command.threads, progress, correction);
  summary.message = calibration_message(summary);
  const auto warnings = calibration_warnings(summary, inputs.problem().shape);
  summary.warnings.insert(summary.warnings.end(), warnings.begin(), warnings.end());
  const EncWords words = enc_words(summary, inputs.problem().shape);
  write_enc(summary, inputs.problem(), words, provenance, command.out);
  inputs.notes().say(enc_lines(words));
  return summary;
}

}  // namespace calomel
