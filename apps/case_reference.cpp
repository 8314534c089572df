#include "apps/case_reference.hpp"

#include <fmt/format.h>

#include "apps/inputs/study_case.hpp"
#include "base/reference.hpp"
#include "forward/simulation/case_tables.hpp"
#include "forward/simulation/model_options.hpp"
#include "forward/simulation/simulator_kinds.hpp"
#include "forward/surrogate/trained_map.hpp"
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

template <class Entry>
std::string catalogue(const std::string& heading, const Registry<Entry>& registry) {
  std::string s = "\n### " + heading + "\n\n| name | meaning |\n|---|---|\n";
  for (const auto& row : registry.rows()) s += fmt::format("| `{}` | {} |\n", row.name, row.summary);
  return s;
}

constexpr const char* report_table = "\n## `[report]`\n\nThe table is allowed and has no key in this version.\n";

}  // namespace

std::string case_reference() {
  std::string s = head;
  s += reference_table<CaseName>("[case]", "case", "The whole table may be left out.");
  s += reference_table<ModelOptions>("[model]", "model", "The kind of the true model. The tables of each kind are at the end of this page.");
  s += catalogue("Kinds of model (`model.kind`)", simulator_kinds());
  s += reference_table<RecordingOptions>("[recordings]", "recordings", "What was measured; see [how-to/import_recordings.md](how-to/import_recordings.md).");
  s += reference_table<Parameter>(
      "[parameter.NAME]", "parameter.NAME",
      "The numbers to infer, in declared order. NAME means `material.mercury.NAME` unless `key` names another number of the case, such as\n"
      "`material.steel.poisson`, `load.profile.center.1` or `sensor.B.gain`. ENC uses the bounds alone, MAP the "
      "priors, too.");
  s += reference_table<CampaignOptions>("[campaign]", "campaign", "The design of experiments, see [theory/campaign.md](theory/campaign.md).");
  s += reference_table<FloorOptions>(
      "[floor]", "floor",
      "The repeatability floor of `calomel check --floor` and of every campaign, and the other numerical errors, see [theory/forward.md](theory/forward.md).");
  s += reference_table<SurrogateOptions>("[surrogate]", "surrogate", "See [theory/surrogates.md](theory/surrogates.md).");
  s += reference_table<EncOptions>("[enc]", "enc", "Evolutionary neural calibration, see [theory/enc.md](theory/enc.md).");
  s += reference_table<SpeOptions>("[spe]", "spe", "Sparse polynomial expansion calibration, see [theory/spe.md](theory/spe.md).");
  s += reference_table<MapOptions>("[map]", "map", "Maximum a posteriori, the mode of the posterior, see [theory/map.md](theory/map.md).");
  s += reference_table<EmulatorOptions>("[emulator]", "emulator",
                                        "Runs that the emulator of the posterior is trained on, see [theory/emulator.md](theory/emulator.md).");
  s += reference_table<PosteriorOptions>("[posterior]", "posterior",
                                         "What `calomel sample` does with the emulator, see [theory/posterior.md](theory/posterior.md).");
  s += reference_table<ErrorOptions>("[errors]", "errors", "Known errors of records and model, see [theory/posterior.md](theory/posterior.md).");
  s += reference_table<DiagnosisOptions>("[diagnosis]", "diagnosis",
                                         "The search for omitted physics of `calomel diagnose`, see [theory/diagnosis.md](theory/diagnosis.md).");
  s += reference_table<SensitivityOptions>("[sensitivity]", "sensitivity",
                                           "Which parameters the records depend on, see [theory/sensitivity.md](theory/sensitivity.md).");
  s += reference_table<PowerOptions>("[power]", "power",
                                     "The experiment that `calomel diagnose --power` plans, see [how-to/plan_an_experiment.md](how-to/plan_an_experiment.md).");
  s += reference_table<SamplerOptions>("[sampler]", "sampler", "Markov chains of `calomel sample`, see [theory/sampling.md](theory/sampling.md).");
  s += reference_table<StudyOptions>("[study]", "study", "What `calomel study` does.");
  s += "\n## Catalogues\n\nThe same lists as `calomel list` prints.\n";
  s += catalogue("Designs (`campaign.design`)", designs());
  s += catalogue("Surrogates (`surrogate.kind`, `surrogate.compare`)", surrogate_kinds());
  s += catalogue("Objectives (`enc.objective`, `spe.objective`)", objectives());
  s += catalogue("Optimisers (`enc.optimizers`)", optimizers());
  s += catalogue("Samplers (`sampler.kind`)", samplers());
  s += report_table;
  for (const auto& kind : simulator_kinds().rows()) {
    s += kind.entry.reference();
    for (const auto& c : kind.entry.catalogues()) {
      s += "\n### " + c.title + "\n\n| name | meaning |\n|---|---|\n";
      for (const auto& [name, summary] : c.entries) s += fmt::format("| `{}` | {} |\n", name, summary);
    }
  }
  return s;
}

}  // namespace calomel
