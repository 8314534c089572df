#include "apps/pipeline/spe_stage.hpp"

#include "apps/interrupt.hpp"
#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/feasibility.hpp"

namespace calomel {

namespace {

/// Runs on the case's own mesh at the columns of thetas, (n_parameters, n).
std::vector<RunRecord> own_runs(StudyInputs& inputs, const Eigen::MatrixXd& thetas, const CalibrationProgress& progress) {
  const auto& model = inputs.any_model();
  const auto& parameters = model.shape().parameters;
  std::vector<RunPoint> points;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) points.push_back(point_at(parameters, {thetas.col(i).data(), parameters.size()}));
  const auto evaluate = [&](const RunPoint& p) { return evaluate_run(model, theta_at(parameters, p), false); };
  const auto told = [&](std::size_t done, std::size_t all) { progress("runs of the true model", done, all); };
  return inputs.runs().run(points, evaluate, inputs.command().threads, {}, told, &stop_requested());
}

}  // namespace

SpeSummary spe_stage(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& options = inputs.study().spe;
  const Archive archive = read_archive(inputs.artefact("campaign.nc"));
  inputs.notes().say(failure_lines(archive, Feasibility(archive)));
  const MeshCorrection* correction = call.correction.get("spe", options.mesh_correction, progress);
  const auto make_runs = [&](const Eigen::MatrixXd& thetas) { return own_runs(inputs, thetas, progress); };
  auto summary = run_spe(inputs.problem(), archive, inputs.any_model(), options, command.seed, command.threads, progress, make_runs, correction);
  write_spe(summary, inputs.problem(), provenance, command.out);
  inputs.notes().say(spe_lines(summary));
  return summary;
}

}  // namespace calomel
