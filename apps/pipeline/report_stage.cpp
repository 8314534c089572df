#include "apps/pipeline/report_stage.hpp"

#include <cmath>

#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/report/data/surface.hpp"
#include "apps/report/report.hpp"
#include "base/json.hpp"
#include "forward/mesh/mesh.hpp"
#include "forward/sensor/gauge.hpp"

namespace calomel {

namespace {

/// Below a nanometre is rounding.
double rounded(double x) { return std::abs(x) < 1e-9 ? 0.0 : x; }

ReportSensor report_sensor(const LocatedGauge& gauge, const Vec3& declared, double gauge_length) {
  Vec3 placed = gauge.placed;
  for (auto& x : placed) x = rounded(x);
  return {gauge.name, declared, placed, gauge.direction, rounded(gauge.distance), gauge_length};
}

/// What a model on a mesh has beside its numbers: surfaces, gauges, the load.
void add_target(ReportInput& input, const TargetView& target, const Description& description) {
  input.outer = report_surface(*target.mesh, target.mesh->outer);
  input.wetted = report_surface(*target.mesh, target.mesh->wetted);
  for (std::size_t i = 0; i < target.gauges.size(); ++i) input.sensors.push_back(report_sensor(target.gauges[i], target.declared[i], target.gauge_lengths[i]));
  input.load_policy = target.load_policy;
  if (target.deposited_energy > 0) input.deposited_energy = target.deposited_energy;
  if (target.slice_thickness > 0) input.slice_thickness = target.slice_thickness;
  input.warnings = description.warnings;
  if (target.unbuilt_mechanisms > 0) input.warnings.push_back(unbuilt_mechanisms_sentence(target.unbuilt_mechanisms));
}

ReportInput report_input(StudyInputs& inputs) {
  const auto& study = inputs.study();
  const ModelShape& shape = inputs.simulator().shape();
  ReportInput input;
  input.case_name = inputs.simulator().name();
  input.case_file = inputs.command().case_file.string();
  input.options = study.echo();
  input.parameters = study.parameters();
  input.unit = shape.unit;
  input.time_end = shape.times.back();
  input.seed = inputs.command().seed;
  if (const auto target = inputs.study().file.locating([&] { return inputs.simulator().target(); })) add_target(input, *target, inputs.simulator().describe());
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
