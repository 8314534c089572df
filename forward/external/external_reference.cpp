// The tables of an external model for the reference of the case file.
#include "base/reference.hpp"
#include "forward/external/external_simulator.hpp"

namespace calomel {

std::string external_reference() {
  std::string s =
      "\n# Cases of an external model\n\nWith `[model] kind = \"umbridge\"` the model is behind HTTP, see [how-to/outside_model.md](how-to/outside_model.md). "
      "The case has `[case]`, `[model]`, "
      "`[output]`, `[recordings]`, `[parameter.NAME]` in the order of\nthe model's inputs (without `key`), and `[mechanism.NAME.parameter.P]`: the keys of a "
      "parameter and `off`, the value at which the mechanism does nothing. `[mechanism.NAME]` "
      "has `enabled`. `[model.config]` is passed to the model unchanged.\n`[campaign]`, `[surrogate]`, `[enc]`, `[spe]`, `[map]`, `[emulator]`, `[errors]`, "
      "`[posterior]`, `[sampler]`, `[sensitivity]`, `[diagnosis]` and `[study]` are those above; errors of a mesh and of a "
      "target's gauges are 0 by default, and `errors.band` is half of the samples' frequency.\n";
  s += reference_table<ServerOptions>("[model] outside", "model", "Where the model is.");
  s += reference_table<OutputOptions>("[output]", "output", "What the model's first output block is.");
  s += reference_table<OutputTime>("[output.time]", "output.time", "The times of every record.");
  return s;
}

}  // namespace calomel
