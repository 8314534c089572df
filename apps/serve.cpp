#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/serve_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_serve(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return serve_stage(call); });
}

}  // namespace calomel
