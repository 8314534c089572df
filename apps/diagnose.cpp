#include <fmt/format.h>

#include "apps/inputs/study_case.hpp"
#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/diagnose_stage.hpp"
#include "apps/pipeline/power_stage.hpp"
#include "apps/verbs.hpp"
#include "inverse/posterior/emulator_meshes.hpp"

namespace calomel {

namespace {

/// What a diagnosis sets that the user has not.
void set_defaults(CommandLine& command) {
  // Handbook priors and a discrepancy: the diagnosis examines whether the model is right, not which numbers imitate the records.
  command.overrides.emplace_back("map.product=\"physical\"");
  const StudyCase study = StudyCase::read(command.case_file, command.overrides);
  const auto sizes = diagnosis_element_sizes(*study.simulator, study.emulator);
  if (sizes.size() == 2) command.overrides.push_back(fmt::format("emulator.element_sizes=[{},{}]", number_text(sizes[0]), number_text(sizes[1])));
}

}  // namespace

ExitStatus run_diagnose(const CommandLine& command) {
  CommandLine physical = command;
  set_defaults(physical);
  return call_stage(physical, [](StageCall& call) { return call.inputs.command().power ? power_stage(call) : diagnose_stage(call); });
}

}  // namespace calomel
