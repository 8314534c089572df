#include "apps/presentation/external_lines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace calomel {

std::vector<std::string> external_plan_lines(const ExternalModel& model, const Problem* problem) {
  const ExternalCase& c = model.external_case();
  const auto& shape = model.shape();
  std::vector<std::string> lines{fmt::format("case: {}, a model outside of the program", c.name)};
  lines.push_back(fmt::format("model: \"{}\" at {}, input blocks {}, output blocks {}, gradients: {}", c.server.name, c.server.url, model.input_sizes(),
                              model.output_sizes(), model.has_gradient() ? "yes" : "no"));
  if (c.is_log_density())
    lines.push_back("output: a log density");
  else
    lines.push_back(fmt::format("output: {} sensors at {} times, {:.4g} to {:.4g} s, values in {}", shape.sensors.size(), shape.times.size(),
                                shape.times.front(), shape.times.back(), c.unit));
  std::vector<std::string> enabled, offered, names;
  for (const auto& m : c.mechanisms) (m.enabled ? enabled : offered).push_back(m.name);
  lines.push_back("mechanisms: " + (enabled.empty() ? "none" : join(enabled)) + (offered.empty() ? "" : "; offered to a diagnosis: " + join(offered)));
  for (const auto& p : c.parameters) names.push_back(fmt::format("{} {:.4g} to {:.4g}", p.name, p.min, p.max));
  lines.push_back("parameters: " + join(names));
  if (problem) lines.push_back(fmt::format("recordings: {} records, compared at {} times", problem->observations.size(), problem->time.size()));
  return lines;
}

std::string external_simulate_line(const ExternalModel& model, double wall) {
  return fmt::format("simulate: \"{}\" at {}, {} values in {:.3g} s", model.external_case().server.name, model.external_case().server.url,
                     model.shape().values(), wall);
}

}  // namespace calomel
