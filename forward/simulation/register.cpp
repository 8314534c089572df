#include <fmt/format.h>

#include <algorithm>

#include "forward/external/external_simulator.hpp"
#include "forward/line/line_simulator.hpp"
#include "forward/simulation/simulator_kinds.hpp"
#include "forward/target/target_simulator.hpp"

namespace calomel {

const Registry<SimulatorKind>& simulator_kinds() {
  static const Registry<SimulatorKind> all = [] {
    Registry<SimulatorKind> r("kind of model");
    r.add("built_in", "the explicit finite-element solver on a mesh", target_kind());
    r.add("line", "waves along a bar or a pipe", line_kind());
    r.add("umbridge", "an external model behind HTTP, UM-Bridge 1.0", external_kind());
    return r;
  }();
  return all;
}

std::unique_ptr<Simulator> make_simulator(CaseFile& file, const SimulatorSettings& settings) {
  return file.locating([&] {
    const std::string name = file.text("model.kind").value_or("built_in");
    const SimulatorKind& kind = simulator_kinds().get(name, "model.kind");
    for (const auto& row : simulator_kinds().rows())
      for (const auto& table : row.entry.tables)
        if (file.has(table) && std::find(kind.tables.begin(), kind.tables.end(), table) == kind.tables.end())
          throw file.located(
              InputError({.problem = fmt::format("this table belongs to a model of kind \"{}\", and the model of this case is of kind \"{}\"", row.name, name),
                          .key = table,
                          .suggestion = fmt::format("remove the table, or set model.kind = \"{}\"", row.name)}));
    return kind.make(file, settings);
  });
}

}  // namespace calomel
