#include "apps/pipeline/spe_stage.hpp"

#include "apps/interrupt.hpp"
#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/campaign/campaign.hpp"
#include "forward/surrogate/feasibility.hpp"

namespace calomel {

namespace {

/// Runs on the case's own mesh at the columns of thetas, (n_parameters, n).
std::vector<RunRecord> own_runs(StudyInputs& inputs, const Eigen::MatrixXd& thetas, const CalibrationProgress& progress) {
  const auto& model = inputs.model();
  const auto& parameters = model.shape().parameters;
  std::vector<RunPoint> points;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) {
    RunPoint p{{"geometry.element_size", inputs.study().forward.geometry.resolved().element_size.value_or(0)}};
    for (std::size_t k = 0; k < parameters.size(); ++k) p[parameters[k].key] = thetas(Eigen::Index(k), i);
    points.push_back(std::move(p));
  }
  const auto evaluate = [&](const RunPoint& p) {
    std::vector<double> theta;
    for (const auto& parameter : parameters) theta.push_back(p.at(parameter.key));
    return evaluate_run(model, theta, false);
  };
  const auto told = [&](std::size_t done, std::size_t all) { progress("runs of the true model", done, all); };
  std::vector<RunRecord> records;
  for (auto& r : inputs.runs().run(points, evaluate, inputs.command().threads, {}, told, &stop_requested())) records.push_back(std::move(r.record));
  return records;
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
  auto summary = run_spe(inputs.problem(), archive, inputs.model(), options, command.seed, command.threads, progress, make_runs, correction);
  write_spe(summary, inputs.problem(), provenance, command.out);
  inputs.notes().say(spe_lines(summary));
  return summary;
}

}  // namespace calomel
