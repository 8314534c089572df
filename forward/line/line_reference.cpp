// The tables of a line for the reference of the case file.
#include <fmt/format.h>

#include "base/reference.hpp"
#include "forward/line/line_simulator.hpp"
#include "forward/line/signal.hpp"
#include "forward/mechanism/mechanism_reference.hpp"

namespace calomel {

namespace {

std::string line_mechanism_page(const std::string& kind) {
  std::string s = fmt::format("\n### Mechanisms of a {}\n", kind);
  for (const auto& row : line_mechanisms(kind).rows()) {
    s += fmt::format("\n#### `{}` of a {}\n\n`{}`{}{}", row.name, kind, row.entry.law, row.entry.needs.empty() ? "" : "; needs `" + row.entry.needs + "`",
                     row.entry.per_station ? "; `[mechanism." + row.name + ".STATION]` for one station" : "");
    s += mechanism_rows(row.entry.keys);
  }
  return s;
}

}  // namespace

std::string line_reference() {
  std::string s =
      "\n# Cases of a line\n\nWith `[model] kind = \"line\"` the case is a bar or a pipe, see [theory/line.md](theory/line.md). It has `[case]`, `[model]`, "
      "`[line]`, `[time]`, "
      "`[[station]]`, a bar `[drive]`, and `[mechanism.NAME]`,\n`[parameter.NAME]` (NAME means `line.NAME`) and `[recordings]` as above; `sensor_unit` is "
      "the unit of the "
      "readings: that of a bar's record, `Pa` (default), `kPa`, `MPa` or `bar` for a pipe.\n`[emulator]`, `[errors]` and `[diagnosis]` are those above; errors "
      "of a mesh and of a target's gauges are 0 by default.\n";
  s += reference_table<BarOptions>("[line] of a bar", "line", "The wave that passes a first gauge, where it is measured, runs on to the stations.");
  s += reference_table<DriveOptions>("[drive]", "drive", "What is measured at the first gauge of a bar.");
  s += reference_table<PipeOptions>("[line] of a pipe", "line", "Reservoir, pipe and closing valve.");
  s += reference_table<StationOptions>("[[station]]", "station", "Where a history is read; at least one.");
  s += "\n## `[mechanism.NAME]` of a line\n\nAs above: a key's *off* value gives the base model exactly. All that the case does not enable are offered to a "
       "diagnosis.\n";
  return s + line_mechanism_page("bar") + line_mechanism_page("pipe");
}

std::vector<Catalogue> line_catalogues() {
  return {catalogue_of("Mechanisms of a bar (`[line] kind = \"bar\"`)", bar_mechanisms()),
          catalogue_of("Mechanisms of a pipe (`[line] kind = \"pipe\"`)", pipe_mechanisms())};
}

}  // namespace calomel
