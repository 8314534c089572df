#include <fmt/format.h>

#include <iostream>

#include "apps/progress.hpp"
#include "apps/stages.hpp"
#include "apps/verbs.hpp"

namespace calomel {

/// Reads every table, builds the mesh, places the sensors and holds the recordings against them; prints the resolved case
/// as JSON to stdout, what was found and the cost to stderr. Runs nothing and writes nothing.
ExitStatus Stages::check() {
  const auto& shape = model().shape();
  const auto d = model().describe();
  const bool compared = study_.recordings.has_value();
  if (compared) (void)problem();
  std::cout << study_.echo().dump(2) << '\n';

  for (const auto& w : d.warnings) say("warning: " + w);
  for (const auto& n : d.notes) say("note: " + n);
  say(fmt::format("model: {} elements, {} nodes, {} steps of {:.3g} s, {} sensors at {} times, about {:.0f} MB", d.elements, d.nodes, d.steps, d.time_step,
                  shape.sensors.size(), shape.times.size(), d.estimated_bytes / 1e6));
  if (compared) say(fmt::format("recordings: {} records, compared at {} times", problem().observations.size(), problem().time.size()));
  const double conditions = double(shape.conditions.size());
  const double runs = double(study_.campaign.runs) * study_.campaign.pulses * conditions;
  say(fmt::format("cost: one run about {}; the campaign of {} ensemble means over {} parameters about {} on {} threads", duration_text(d.estimated_seconds),
                  study_.campaign.runs, shape.parameters.size(), duration_text(runs * d.estimated_seconds / command_.threads), command_.threads));
  return ExitStatus::done;
}

ExitStatus run_check(const CommandLine& command) { return Stages(command).check(); }

}  // namespace calomel
