#include "apps/case_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/inputs/study_case.hpp"
#include "forward/line/line_mechanism.hpp"
#include "forward/line/signal.hpp"
#include "forward/mechanism/mechanism.hpp"
#include "forward/surrogate/emulator.hpp"
#include "inverse/objective/objective.hpp"
#include "inverse/optimizer/optimizer.hpp"

namespace calomel {

namespace {

constexpr const char* head = R"(# Reference of the case file

This page is generated: `case_reference > docs/case_reference.md` writes it from the same `Options` that the program reads
cases with, and a test compares the two. Edit the `visit` functions in the source, not this page.

A case is a TOML file. All numbers are in SI units. Relative paths start at the folder of the case file. An unknown key or
table is an error that names the nearest known one. Every key can be set from the command line, `--set table.key=value`.
`calomel check CASE.toml --resolved` prints the case with every default filled in, as JSON.
)";

/// Rows of one Options type under a heading.
template <class O>
std::string table(const std::string& heading, const std::string& prefix, const std::string& text, O options = {}) {
  ReferenceVisitor v(prefix + '.');
  options.visit(v);
  return fmt::format("\n## `{}`\n\n{}\n\n| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n{}", heading, text, v.markdown);
}

std::string off_text(const MechanismKey& key) {
  const std::string off = std::isfinite(key.off) ? number_text(key.off) : "none";
  return key.off_at.empty() ? off : "`" + key.off_at + "` (" + off + ")";
}

std::string prior_text(const MechanismKey& k) {
  if (!k.shows_below.empty()) return "uniform, as a share of `" + k.shows_below + '`';
  if (!std::isfinite(k.off)) return "uniform in the inverse";
  return k.log_uniform ? "half-Cauchy about the geometric middle" : "normal";
}

/// What stands behind a key's name in its row.
std::string cells(const MechanismKey& k) {
  if (!k.choices.empty()) return fmt::format(" |  | `\"{}\"` (any) |  |  | {} | {} |\n", k.choices.at(std::size_t(k.off)), join(k.choices), k.doc);
  return fmt::format(" | {} | {} | {} | {} | {} | {} |\n", k.unit, off_text(k) + (k.decides ? "" : " (any)"), number_text(k.low), number_text(k.high),
                     prior_text(k), k.doc);
}

/// A name without the number that it ends with: "left_" of left_1.
std::string stem(const std::string& name) { return name.substr(0, name.find_last_not_of("0123456789") + 1); }

/// A row a key; numbered keys that are alike, as left_1 to left_64, share one.
std::string mechanism_rows(const std::vector<MechanismKey>& keys) {
  std::string s = "\n\n| key | unit | off | low | high | prior | meaning |\n|---|---|---|---|---|---|---|\n";
  for (auto k = keys.begin(); k != keys.end();) {
    const auto end = std::find_if(k + 1, keys.end(), [&](const auto& other) { return stem(other.name) != stem(k->name) || cells(other) != cells(*k); });
    s += fmt::format("| `{}`{}", k->name, end - k > 1 ? fmt::format(" to `{}`", (end - 1)->name) : "") + cells(*k);
    k = end;
  }
  return s;
}

std::string mechanism_page() {
  std::string s =
      "\n## `[mechanism.NAME]`\n\nPhysics that the base model leaves out. A listed mechanism is offered to the diagnosis; `enabled = true` makes it part of "
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

std::string line_mechanism_page(const std::string& kind) {
  std::string s = fmt::format("\n### Mechanisms of a {}\n", kind);
  for (const auto& row : line_mechanisms(kind).rows()) {
    s += fmt::format("\n#### `{}` of a {}\n\n`{}`{}{}", row.name, kind, row.entry.law, row.entry.needs.empty() ? "" : "; needs `" + row.entry.needs + "`",
                     row.entry.per_station ? "; `[mechanism." + row.name + ".STATION]` for one station" : "");
    s += mechanism_rows(row.entry.keys);
  }
  return s;
}

std::string line_page() {
  std::string s =
      "\n# Cases of a line\n\nWith `[model] kind = \"line\"` the case is a bar or a pipe, see [theory/line.md](theory/line.md). It has `[case]`, `[model]`, "
      "`[line]`, `[time]`, "
      "`[[station]]`, a bar `[drive]`, and `[mechanism.NAME]`,\n`[parameter.NAME]` (NAME stands for `line.NAME`) and `[recordings]` as above; `sensor_unit` is "
      "the unit of the "
      "readings: that of a bar's record, `Pa` (default), `kPa`, `MPa` or `bar` for a pipe.\n`[emulator]`, `[errors]` and `[diagnosis]` are those above; errors "
      "of a mesh and of a target's gauges are 0 by default.\n";
  s += table<ModelOptions>("[model]", "model", "Which model computes the histories.");
  s += table<BarOptions>("[line] of a bar", "line", "The wave that passes a first gauge, where it is measured, runs on to the stations.");
  s += table<DriveOptions>("[drive]", "drive", "What is measured at the first gauge of a bar.");
  s += table<PipeOptions>("[line] of a pipe", "line", "Reservoir, pipe and closing valve.");
  s += table<StationOptions>("[[station]]", "station", "Where a history is read; at least one.");
  s += "\n## `[mechanism.NAME]` of a line\n\nAs above: a key's *off* value gives the base model exactly. All that the case does not enable are offered to a "
       "diagnosis.\n";
  return s + line_mechanism_page("bar") + line_mechanism_page("pipe");
}

std::string outside_page() {
  std::string s =
      "\n# Cases of a model outside\n\nWith `[model] kind = \"umbridge\"` the model is behind HTTP, see [how-to/outside_model.md](how-to/outside_model.md). "
      "The case has `[case]`, `[model]`, "
      "`[output]`, `[recordings]`, `[parameter.NAME]` in the order of\nthe model's inputs (without `key`), and `[mechanism.NAME.parameter.P]`: the keys of a "
      "parameter and `off`, the value at which the mechanism does nothing. `[mechanism.NAME]` "
      "has `enabled`. `[model.config]` is handed to the model as it stands.\n`[campaign]`, `[surrogate]`, `[enc]`, `[spe]`, `[map]`, `[emulator]`, `[errors]`, "
      "`[posterior]`, `[sampler]`, `[sensitivity]`, `[diagnosis]` and `[study]` are those above; errors of a mesh and of a "
      "target's gauges are 0 by default, and `errors.band` is half of the samples' frequency.\n";
  s += table<ServerOptions>("[model] outside", "model", "Where the model is.");
  s += table<OutputOptions>("[output]", "output", "What the model's first output block is.");
  s += table<OutputTime>("[output.time]", "output.time", "The times of every record.");
  return s;
}

template <class Entry>
std::string catalogue(const std::string& heading, const Registry<Entry>& registry) {
  std::string s = "\n### " + heading + "\n\n| name | what it is |\n|---|---|\n";
  for (const auto& row : registry.rows()) s += fmt::format("| `{}` | {} |\n", row.name, row.summary);
  return s;
}

constexpr const char* report_table = "\n## `[report]`\n\nThe table may stand there; it has no key in this version.\n";

}  // namespace

std::string case_reference() {
  std::string s = head;
  s += table<CaseName>("[case]", "case", "The whole table may be left out.");
  s += table<GeometryOptions>("[geometry]", "geometry",
                              "The target: a box, a jet-flow target, a round bar, or a mesh file ([how-to/your_own_target.md](how-to/your_own_target.md)). "
                              "Required. `x` runs along the beam from the outer front face, `z` up from the "
                              "outer bottom face, `y` is 0 in the middle.\nA key that does not belong to the kind is refused. "
                              "Default \"none\" of a dimension means: required for the box and (length, radius) the bar, else as the text says.");
  s += table<SteelOptions>("[material.steel]", "material.steel", "Linear elastic steel; the defaults are 316L.");
  s += table<MercuryOptions>("[material.mercury]", "material.mercury", "The liquid, see [theory/forward.md](theory/forward.md).");
  s += table<LoadOptions>("[load]", "load", "What sets the target in motion. Required; a pulse needs either `peak_pressure` or `energy`.");
  s += table<TimeOptions>("[time]", "time", "Samples stand at every multiple of `output_interval` from 0 to `end`.");
  s += table<SolverOptions>("[solver]", "solver", "The explicit solver.");
  s += table<SensorOptions>("[[sensor]]", "sensor",
                            "One table a strain gauge, in declared order; at least one. Or `sensors = \"FILE.csv\"` at the top of the case with the columns "
                            "name,x,y,z,dx,dy,dz,gauge_length.");
  s += table<ConditionOptions>(
      "[[condition]]", "condition",
      "Operating points, e.g. beam powers; each has exactly one of `peak_pressure` and `energy`. Without any there is one condition, as "
      "the load says.");
  s += table<RecordingOptions>("[recordings]", "recordings", "What was measured; see [how-to/import_recordings.md](how-to/import_recordings.md).");
  s += table<Parameter>(
      "[parameter.NAME]", "parameter.NAME",
      "The numbers to infer, in declared order. NAME stands for `material.mercury.NAME` unless `key` names another number of the case, such as\n"
      "`material.steel.poisson`, `load.profile.center.1` or `sensor.B.gain`. ENC uses the bounds alone, MAP the "
      "priors, too.");
  s += table<CampaignOptions>("[campaign]", "campaign", "The design of experiments, see [theory/campaign.md](theory/campaign.md).");
  s += table<FloorOptions>(
      "[floor]", "floor",
      "The repeatability floor of `calomel check --floor` and of every campaign, and what stands beside it, see [theory/forward.md](theory/forward.md).");
  s += table<SurrogateOptions>("[surrogate]", "surrogate", "See [theory/surrogates.md](theory/surrogates.md).");
  s += table<EncOptions>("[enc]", "enc", "Evolutionary neural calibration, see [theory/enc.md](theory/enc.md).");
  s += table<SpeOptions>("[spe]", "spe", "Sparse polynomial expansion calibration, see [theory/spe.md](theory/spe.md).");
  s += table<MapOptions>("[map]", "map", "Maximum a posteriori, the mode of the posterior, see [theory/map.md](theory/map.md).");
  s += table<EmulatorOptions>("[emulator]", "emulator", "Runs that the posterior is taught by, see [theory/emulator.md](theory/emulator.md).");
  s += table<PosteriorOptions>("[posterior]", "posterior", "What `calomel sample` does with the emulator, see [theory/posterior.md](theory/posterior.md).");
  s += table<ErrorOptions>("[errors]", "errors", "What is known of the errors of records and model, see [theory/posterior.md](theory/posterior.md).");
  s += table<DiagnosisOptions>("[diagnosis]", "diagnosis",
                               "The search for omitted physics of `calomel diagnose`, see [theory/diagnosis.md](theory/diagnosis.md).");
  s += table<SensitivityOptions>("[sensitivity]", "sensitivity", "Which parameters the records depend on, see [theory/sensitivity.md](theory/sensitivity.md).");
  s += table<PowerOptions>("[power]", "power",
                           "The experiment that `calomel diagnose --power` plans, see [how-to/plan_an_experiment.md](how-to/plan_an_experiment.md).");
  s += table<SamplerOptions>("[sampler]", "sampler", "Markov chains of `calomel sample`, see [theory/sampling.md](theory/sampling.md).");
  s += table<StudyOptions>("[study]", "study", "What `calomel study` does.");
  s += table<FieldOptions>("[fields]", "fields", "Pictures over time, `calomel simulate --fields`.");
  s += mechanism_page();
  s += "\n## Catalogues\n\nThe same lists as `calomel list` prints.\n";
  s += catalogue("Laws of the liquid (`material.mercury.law`)", liquid_laws());
  s += catalogue("Loads (`load.kind`)", loads());
  s += catalogue("Designs (`campaign.design`)", designs());
  s += catalogue("Surrogates (`surrogate.kind`, `surrogate.compare`)", surrogate_kinds());
  s += catalogue("Objectives (`enc.objective`, `spe.objective`)", objectives());
  s += catalogue("Optimisers (`enc.optimizers`)", optimizers());
  s += catalogue("Samplers (`sampler.kind`)", samplers());
  s += report_table;
  s += line_page();
  s += outside_page();
  return s;
}

}  // namespace calomel
