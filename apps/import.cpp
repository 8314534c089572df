#include <iostream>

#include "apps/notes.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/verbs.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

ExitStatus run_import(const CommandLine& command) {
  RecordingOptions options;
  options.unit = command.unit;
  const auto summary = import_recordings(command.files, options, command.out);
  const Notes notes(std::cerr, command.quiet);
  notes.warn(summary.recordings.warnings);
  notes.say(import_line(summary));
  return ExitStatus::done;
}

}  // namespace calomel
