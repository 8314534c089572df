#include "apps/pipeline/report_stage.hpp"

#include <cmath>

#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/report/report.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {

/// Unit of the number at a dotted path of the case; empty for a pure number.
std::string unit_of(const ForwardCase& forward, const std::string& key) {
  std::string unit;
  const auto look = [&](const std::string& path, const auto& options) {
    if (!key.starts_with(path + '.')) return;
    NumberVisitor v(key.substr(path.size() + 1));
    auto copy = options;
    copy.visit(v);
    if (v.number || v.optional) unit = v.info.unit;
  };
  ForwardCase::visit_tables(forward, look);
  for (const auto& s : forward.sensors) look("sensor." + s.name, s);
  return unit;
}

/// Below a nanometre is rounding.
double rounded(double x) { return std::abs(x) < 1e-9 ? 0.0 : x; }

ReportSensor report_sensor(const SensorOptions& declared, const LocatedGauge& gauge) {
  Vec3 placed = gauge.placed;
  for (auto& x : placed) x = rounded(x);
  return {declared.name, declared.position, placed, gauge.direction, rounded(gauge.distance), declared.gauge_length};
}

ReportInput report_input(StudyInputs& inputs) {
  const auto& model = inputs.model();
  const auto& forward = inputs.study().forward;
  const auto description = model.describe();
  ReportInput input;
  input.case_name = forward.name;
  input.case_file = inputs.command().case_file.string();
  input.options = inputs.study().echo();
  input.parameters = forward.parameters;
  for (const auto& p : forward.parameters) input.units[p.name] = unit_of(forward, p.key);
  input.unit = model.shape().unit;
  input.outer = report_surface(model.mesh(), model.mesh().outer);
  input.wetted = report_surface(model.mesh(), model.mesh().wetted);
  for (std::size_t i = 0; i < forward.sensors.size(); ++i) input.sensors.push_back(report_sensor(forward.sensors[i], model.gauges()[i]));
  input.load_policy = policy_text(forward.load);
  if (description.deposited_energy > 0) input.deposited_energy = description.deposited_energy;
  if (description.slice_thickness > 0) input.slice_thickness = description.slice_thickness;
  input.seed = inputs.command().seed;
  input.warnings = description.warnings;
  if (!description.notes.empty()) input.warnings.push_back(unbuilt_mechanisms_sentence(description.notes.size()));
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
