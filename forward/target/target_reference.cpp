// The tables of a target for the reference of the case file.
#include <fmt/format.h>

#include <algorithm>

#include "base/reference.hpp"
#include "forward/mechanism/mechanism_reference.hpp"
#include "forward/target/target_simulator.hpp"

namespace calomel {

namespace {

std::string mechanism_page() {
  std::string s =
      "\n## `[mechanism.NAME]`\n\nPhysics that the base model omits. A listed mechanism is offered to the diagnosis; `enabled = true` makes it part of "
      "the base model.\nEvery mechanism has an *off* value of each key at which the base model is meant to come back exactly; where another number of the case "
      "stands there, it is "
      "that one (its default in brackets). The range is that of a diagnosis' prior: a normal one is "
      "about off, and its range two standard deviations either way; it may be left up to twice that far, as far as the law goes.\n";
  const auto& rows = mechanisms().rows();
  const auto built = std::count_if(rows.begin(), rows.end(), [](const auto& r) { return r.entry.built(); });
  if (std::size_t(built) < rows.size())
    s += fmt::format(
        "\nBuilt in this version: {} of {}. A case may list one that is not built: `calomel check` then says \"not built yet, not offered\". Enabling it is "
        "an error (exit status 2).\n",
        built, rows.size());
  s += "\nEvery mechanism takes `enabled` (default `false`). To fit one of its numbers, write `[parameter.NAME]` with `key = \"mechanism.MECHANISM.KEY\"`.\n";
  for (const auto& row : rows) {
    s += fmt::format("\n### `{}`\n\n`{}`{}{}", row.name, row.entry.law, row.entry.built() ? "" : " (not built yet)",
                     row.entry.per_sensor ? "; `[mechanism." + row.name + ".SENSOR]` for one gauge" : "");
    s += mechanism_rows(row.entry.keys);
  }
  return s;
}

}  // namespace

std::string target_reference() {
  std::string s = "\n# Cases of a target\n\nWithout `[model]`, or with `kind = \"built_in\"`, the model is the explicit finite-element solver.\n";
  s += reference_table<GeometryOptions>(
      "[geometry]", "geometry",
      "The target: a box, a jet-flow target, a round bar, or a mesh file ([how-to/your_own_target.md](how-to/your_own_target.md)). "
      "Required. `x` runs along the beam from the outer front face, `z` up from the "
      "outer bottom face, `y` is 0 in the middle.\nA key that does not belong to the kind is refused. "
      "Default \"none\" of a dimension means: required for the box and (length, radius) the bar, else as the text says.");
  s += reference_table<SteelOptions>("[material.steel]", "material.steel", "Linear elastic steel; the defaults are 316L.");
  s += reference_table<MercuryOptions>("[material.mercury]", "material.mercury", "The liquid, see [theory/forward.md](theory/forward.md).");
  s += reference_table<LoadOptions>("[load]", "load", "What sets the target in motion. Required; a pulse needs either `peak_pressure` or `energy`.");
  s += reference_table<TimeOptions>("[time]", "time", "Samples are taken at every multiple of `output_interval` from 0 to `end`.");
  s += reference_table<SolverOptions>("[solver]", "solver", "The explicit solver.");
  s += reference_table<SensorOptions>(
      "[[sensor]]", "sensor",
      "One table a strain gauge, in declared order; at least one. Or `sensors = \"FILE.csv\"` at the top of the case with the columns "
      "name,x,y,z,dx,dy,dz,gauge_length.");
  s += reference_table<ConditionOptions>(
      "[[condition]]", "condition",
      "Operating points, e.g. beam powers; each has exactly one of `peak_pressure` and `energy`. Without any there is one condition, as "
      "the load says.");
  s += reference_table<FieldOptions>("[fields]", "fields", "Pictures over time, `calomel simulate --fields`.");
  return s + mechanism_page();
}

std::vector<Catalogue> target_catalogues() {
  return {catalogue_of("Laws of the liquid (`material.mercury.law`)", liquid_laws()), catalogue_of("Loads (`load.kind`)", loads()),
          catalogue_of("Mechanisms (`[mechanism.NAME]`)", mechanisms())};
}

}  // namespace calomel
