#include "apps/presentation/line_lines.hpp"

#include <fmt/format.h>

namespace calomel {

std::vector<std::string> line_plan_lines(const LineModel& model, const LineDescription& d, const Problem* problem) {
  const LineCase& c = model.line_case();
  const auto& shape = model.shape();
  std::vector<std::string> lines{fmt::format("case: {}, waves along a {}", c.name, c.kind)};
  const std::string grid = c.kind == "bar" ? fmt::format("{} frequencies, record of {} samples of {:.4g} s", d.cells, c.record.value.size(), d.time_step)
                                           : fmt::format("{} cells, {} steps of {:.4g} s", d.cells, d.steps, d.time_step);
  lines.push_back(fmt::format("model: {}, {} stations at {} times, readings in {}", grid, shape.sensors.size(), shape.times.size(), c.unit));
  if (c.kind == "pipe")
    lines.push_back(fmt::format(
        "pipe: Joukowsky's pressure rho a V {:.5g} kPa, period 4 L / a {:.5g} s, steady pressure at the valve {:.5g} kPa, "
        "Darcy's friction factor {:.4g}",
        1e-3 * c.pipe.density * c.pipe.wave_speed * c.pipe.velocity, 4 * c.pipe.length / c.pipe.wave_speed, 1e-3 * d.steady_pressure, d.friction_factor));
  lines.push_back("mechanisms: " + (d.active.empty() ? "none" : join(d.active)) + (d.offered.empty() ? "" : "; offered to a diagnosis: " + join(d.offered)));
  std::vector<std::string> names;
  for (const auto& p : c.parameters) names.push_back(fmt::format("{} {:.4g} to {:.4g}", p.name, p.min, p.max));
  if (!names.empty()) lines.push_back("parameters: " + join(names));
  if (problem) lines.push_back(fmt::format("recordings: {} records, compared at {} times", problem->observations.size(), problem->time.size()));
  return lines;
}

}  // namespace calomel
