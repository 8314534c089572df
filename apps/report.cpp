#include "apps/report/report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"
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

}  // namespace

ExitStatus Stages::report() {
  expect_something_to_report(command_.out, command_.case_file.string());  // before the model is made
  const auto& m = model();
  const auto& forward = study_.forward;
  const auto description = m.describe();
  ReportInput input;
  input.case_name = forward.name;
  input.case_file = command_.case_file.string();
  input.options = study_.echo();
  input.parameters = forward.parameters;
  for (const auto& p : forward.parameters) input.units[p.name] = unit_of(forward, p.key);
  input.unit = m.shape().unit;
  input.outer = report_surface(m.mesh(), m.mesh().outer);
  input.wetted = report_surface(m.mesh(), m.mesh().wetted);
  for (std::size_t i = 0; i < forward.sensors.size(); ++i) {
    const auto& asked = forward.sensors[i];
    const auto& gauge = m.gauges()[i];
    // Below a nanometre is rounding.
    const auto rounded = [](double x) { return std::abs(x) < 1e-9 ? 0.0 : x; };
    Vec3 placed = gauge.placed;
    for (auto& x : placed) x = rounded(x);
    input.sensors.push_back({asked.name, asked.position, placed, gauge.direction, rounded(gauge.distance), asked.gauge_length});
  }
  input.load_policy = policy_text(forward.load);
  if (description.deposited_energy > 0) input.deposited_energy = description.deposited_energy;
  if (description.slice_thickness > 0) input.slice_thickness = description.slice_thickness;
  input.seed = command_.seed;
  input.warnings = description.warnings;
  if (!description.notes.empty())
    input.warnings.push_back(fmt::format("{} of the listed mechanisms are not built yet in this version and take no part", description.notes.size()));
  write_report(command_.out, input);
  say("report: " + (command_.out / "report.html").string());
  if (command_.csv) say("report: " + std::to_string(write_tables_csv(command_.out, input).size()) + " tables in " + (command_.out / "report_csv").string());
  return ExitStatus::done;
}

ExitStatus run_report(const CommandLine& command) { return Stages(command).report(); }

}  // namespace calomel
