#include "apps/pipeline/report_stage.hpp"

#include <cmath>

#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/report/data/surface.hpp"
#include "apps/report/report.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {

/// Below a nanometre is rounding.
double rounded(double x) { return std::abs(x) < 1e-9 ? 0.0 : x; }

ReportSensor report_sensor(const SensorOptions& declared, const LocatedGauge& gauge) {
  Vec3 placed = gauge.placed;
  for (auto& x : placed) x = rounded(x);
  return {declared.name, declared.position, placed, gauge.direction, rounded(gauge.distance), declared.gauge_length};
}

/// What a model on a mesh has beside its numbers: surfaces, gauges, the load.
void add_target(ReportInput& input, StudyInputs& inputs) {
  const auto& model = inputs.model();
  const auto& forward = inputs.study().forward;
  const auto description = model.describe();
  input.outer = report_surface(model.mesh(), model.mesh().outer);
  input.wetted = report_surface(model.mesh(), model.mesh().wetted);
  for (std::size_t i = 0; i < forward.sensors.size(); ++i) input.sensors.push_back(report_sensor(forward.sensors[i], model.gauges()[i]));
  input.load_policy = policy_text(forward.load);
  if (description.deposited_energy > 0) input.deposited_energy = description.deposited_energy;
  if (description.slice_thickness > 0) input.slice_thickness = description.slice_thickness;
  input.warnings = description.warnings;
  if (!description.notes.empty()) input.warnings.push_back(unbuilt_mechanisms_sentence(description.notes.size()));
}

ReportInput report_input(StudyInputs& inputs) {
  const auto& study = inputs.study();
  ReportInput input;
  input.case_name = study.name();
  input.case_file = inputs.command().case_file.string();
  input.options = study.echo();
  input.parameters = study.parameters();
  input.unit = study.unit();
  input.time_end = study.time_end();
  input.seed = inputs.command().seed;
  if (study.on_mesh()) add_target(input, inputs);
  return input;
}

}  // namespace

ExitStatus report_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  expect_something_to_report(command.out, command.case_file.string());  // before the model is made
  const auto input = report_input(inputs);
  write_report(command.out, input);
  inputs.notes().say(report_line(inputs.artefact("report.html")));
  if (command.csv) inputs.notes().say(report_tables_line(write_tables_csv(command.out, input).size(), inputs.artefact("report_csv")));
  return ExitStatus::done;
}

}  // namespace calomel
