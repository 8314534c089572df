#include "apps/report/sections/provenance.hpp"

#include <optional>
#include <string>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "base/artefact.hpp"

namespace calomel {

namespace {

/// Calls f(stage, summary) for each stage that wrote an artefact, in the order of the flow.
template <class F>
void for_each_stage(const Study& study, const F& f) {
  if (study.simulate) f("simulate", *study.simulate);
  if (study.campaign) f("campaign", *study.campaign);
  if (study.train) f("train", *study.train);
  for (const auto& c : study.calibrations) f(c.method, c.summary);
  if (study.sample) f("sample", *study.sample);
  if (study.diagnosis) f("diagnosis", study.diagnosis->summary);
  if (study.sensitivity) f("sensitivity", study.sensitivity->summary);
}

/// "NAME HASH, NAME HASH"
std::string input_hashes(const Json& provenance) {
  const Json& list = part_at(provenance, "inputs");
  if (!list.is_object()) return "";
  std::string text;
  for (const auto& [name, hash] : list.items()) text += (text.empty() ? "" : ", ") + name + " " + (hash.is_string() ? hash.get<std::string>() : hash.dump());
  return text;
}

}  // namespace

Table provenance_table(const Study& study) {
  Table t{.id = "provenance", .caption = "Artefacts of this report."};
  t.columns = {{"stage", "Stage", 4, true},
               {"version", "Version", 4, true},
               {"seed", "Seed", 12},
               {"identity", "Identity", 4, true},
               {"inputs", "Hashes of the inputs", 4, true}};
  for_each_stage(study, [&](const std::string& stage, const Json& summary) {
    const Json& p = part_at(summary, "provenance");
    t.rows.push_back({stage, text_at(p, "version"), number_at(p, "seed"), text_at(p, "identity"), input_hashes(p)});
  });
  return t;
}

Html provenance_section(const Study& study, const ReportInput& input) {
  Html options = folded_text("Resolved options of the case", input.options.dump(2));
  for_each_stage(study, [&](const std::string& stage, const Json& summary) {
    const Json& p = part_at(summary, "provenance");
    if (p.is_object() && p.contains("options")) options += folded_text("Options of " + stage, p["options"].dump(2));
  });
  const Table t = provenance_table(study);
  return paragraph("Written by calomel ", version, "; seed ", std::to_string(input.seed), ". Equal options, seed and inputs give equal artefacts.") +
         (t.empty() ? missing("No stage has written an artefact yet.", fragment("Run them all with ", command(input, "study"), ".")) : t.html()) + options;
}

}  // namespace calomel
