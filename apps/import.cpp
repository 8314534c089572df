#include <fmt/format.h>

#include <iostream>

#include "apps/verbs.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

ExitStatus run_import(const CommandLine& command) {
  RecordingOptions options;
  options.unit = command.unit;
  const auto summary = import_recordings(command.files, options, command.out);
  if (command.quiet) return ExitStatus::done;
  const auto& r = summary.recordings;
  for (const auto& w : r.warnings) std::cerr << "warning: " << w << '\n';
  std::cerr << fmt::format("import: {} sensors, {} pulses, {} samples in {}\n", r.sensors.size(), r.pulses.size(), r.time.size(), summary.path.string());
  return ExitStatus::done;
}

}  // namespace calomel
