#include "apps/challenge/rule.hpp"

#include <algorithm>

#include "base/artefact.hpp"
#include "base/provenance.hpp"

namespace calomel::challenge {

namespace fs = std::filesystem;

Json gates_json(const Gates& gates) {
  // All members by name: with a further member this no longer compiles until it is listed here.
  const auto& [log_bayes_factor, lead, explained, null_chi2, adequate, remainder, misfit, held_out, farthest, handbook, temperature, prior_none, prior_unknown,
               prior_pairs, believed, revision] = gates;
  return {{"log_bayes_factor", log_bayes_factor},
          {"lead", lead},
          {"explained", explained},
          {"null_chi2", null_chi2},
          {"adequate", adequate},
          {"remainder", remainder},
          {"misfit", misfit},
          {"held_out", held_out},
          {"farthest", farthest},
          {"handbook", handbook},
          {"temperature", temperature},
          {"prior_none", prior_none},
          {"prior_unknown", prior_unknown},
          {"prior_pairs", prior_pairs},
          {"believed", believed},
          {"revision", revision}};
}

Json Rule::json() const { return {{"gates", gates}, {"diagnosis", diagnosis}, {"overrides", overrides}, {"version", version}}; }

std::string Rule::hash() const { return hash_text(json().dump()); }

bool record_rule(const fs::path& directory, const Rule& rule, const std::string& program, bool new_rule) {
  const fs::path path = directory / "rule.json";
  Json record{{"hash", rule.hash()}, {"rule", rule.json()}, {"programs", {program}}};
  if (!fs::exists(path)) {
    if (fs::exists(directory / "results") && !new_rule)
      throw InputError({.problem = "there are results, but no rule.json that names their rule",
                        .suggestion = "use --new-rule to set them aside and start again",
                        .file = directory.string()});
    set_aside(directory / "results");
    write_json(path, record);
    return false;
  }
  const Json before = read_json(path);
  if (before.value("hash", "") != rule.hash()) {
    if (!new_rule) {
      const auto keys = changed_keys(before.value("rule", Json::object()), rule.json());
      throw InputError({.problem = "the suite is judged by another rule; changed: " + (keys.empty() ? std::string("the hash") : join(keys)),
                        .suggestion = "restore the rule, or start again with --new-rule, which sets the old results aside; a rule that was changed after its "
                                      "results were seen needs a suite of another seed",
                        .file = path.string()});
    }
    set_aside(directory / "results");  // first: results of one rule are never beside the name of another
    set_aside(path);
    write_json(path, record);
    return false;
  }
  auto programs = before.value("programs", std::vector<std::string>{});
  if (std::find(programs.begin(), programs.end(), program) != programs.end()) return false;
  programs.push_back(program);
  record["programs"] = programs;
  write_json(path, record);
  return true;
}

}  // namespace calomel::challenge
