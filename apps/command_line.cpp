#include "apps/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ostream>

#include "base/artefact.hpp"
#include "base/parallel.hpp"

namespace calomel {

namespace {

std::vector<std::string> names_of(std::span<const Verb> verbs) {
  std::vector<std::string> names;
  for (const auto& v : verbs) names.push_back(v.name);
  return names;
}

void add_shared(CLI::App& verb, CommandLine& command, Takes takes) {
  if (takes == Takes::nothing) return;
  auto* out = verb.add_option("--out", command.out, "directory of the artefacts (default: CASE.out/ beside the case)")->type_name("DIR");
  if (takes == Takes::files) {
    verb.add_option("FILE", command.files, "recordings in CSV or text")->required()->type_name("");
    out->required()->description("directory of recordings.nc");
    return;
  }
  verb.add_option("CASE", command.case_file, "case file (TOML)")->required()->type_name("");
  verb.add_option("--set", command.overrides, "override a value of the case; may be repeated")->type_name("TABLE.KEY=VALUE")->allow_extra_args(false);
  verb.add_option("--threads", command.threads, "threads at most (default: all); a run that would not gain by them takes fewer")->check(CLI::Range(1, 4096))->type_name("N");
  verb.add_option("--seed", command.seed, "seed of all random streams (default: 1)")->type_name("S")->check([](const std::string& text) {
    return text.starts_with('-') ? "a seed is not negative: " + text : std::string();
  });
  verb.add_flag("--fresh", command.fresh, "set finished artefacts of other settings aside (NAME.old-N) and begin anew");
}

void add_extra(CLI::App& verb, CommandLine& command, Extra extra) {
  switch (extra) {
    case Extra::method:
      verb.add_option("--method", command.methods, "how to calibrate (default: enc); may be repeated; all = enc, spe, map")
          ->type_name("enc|spe|map|all")
          ->allow_extra_args(false)
          ->check(CLI::IsMember({"enc", "spe", "map", "all"}));
      return;
    case Extra::fields:
      verb.add_flag("--fields", command.fields, "write displacements and pressures over time to fields.exo");
      return;
    case Extra::mean:
      verb.add_flag("--mean", command.mean, "the mean over the pulse energies in place of one run at energy 1");
      return;
    case Extra::csv:
      verb.add_flag("--csv", command.csv, "write every table and trace as CSV, too");
      return;
    case Extra::floor:
      verb.add_flag("--floor", command.floor, "measure the repeatability floor, see [floor], and write floor.json");
      return;
    case Extra::resolved:
      verb.add_flag("--resolved", command.resolved, "print the case with every default filled in, as JSON");
      return;
    case Extra::power:
      verb.add_flag("--power", command.power, "before measuring: what records of these gauges could tell, see [power]; needs no recordings");
      return;
    case Extra::write_mesh:
      verb.add_option("--write-mesh", command.write_mesh, "write the mesh with its sets, Abaqus input (.inp) or Exodus II (.exo)")->type_name("FILE");
      return;
    case Extra::unit:
      verb.add_option("--unit", command.unit, "unit of the values (default: strain)")->type_name("strain|microstrain");
      return;
  }
}

}  // namespace

std::vector<Extra> extras_of(const std::string& verb) {
  if (verb == "check") return {Extra::resolved, Extra::floor, Extra::write_mesh};
  if (verb == "calibrate") return {Extra::method};
  if (verb == "simulate") return {Extra::fields, Extra::mean};
  if (verb == "report") return {Extra::csv};
  if (verb == "diagnose") return {Extra::power};
  if (verb == "import") return {Extra::unit};
  return {};
}

bool parse(std::span<const std::string> words, std::span<const Verb> verbs, CommandLine& command, std::ostream& out) {
  const auto known = names_of(verbs);
  command.threads = default_threads();
  if (!words.empty() && !words[0].starts_with('-') && std::find(known.begin(), known.end(), words[0]) == known.end())
    throw InputError({.problem = "no verb of this name",
                      .value = '"' + words[0] + '"',
                      .range = join(known),
                      .suggestion = "did you mean \"" + nearest_name(words[0], known) + "\"? (calomel --help)"});

  CLI::App app("Inverse problems where a violent pulse meets a structure: simulate it, learn it, calibrate it.", "calomel");
  app.set_version_flag("--version", std::string("calomel ") + version);
  app.require_subcommand(1);
  app.footer(
      "calomel VERB --help tells the options of a verb.\nExit status: 0 done, 2 wrong input, 3 failed numerics, 4 finished but not to be trusted, 130 "
      "interrupted.");
  for (const auto& v : verbs) {
    auto* verb = app.add_subcommand(v.name, v.summary);
    add_shared(*verb, command, v.takes);
    for (const auto extra : extras_of(v.name)) add_extra(*verb, command, extra);
    verb->add_flag("--quiet", command.quiet, "no progress and no notes");
  }

  std::vector<std::string> reversed(words.rbegin(), words.rend());  // as CLI11 wants them
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    const auto chosen = app.get_subcommands();
    out << (chosen.empty() ? app.help() : chosen[0]->help("", CLI::AppFormatMode::Normal));
    return false;
  } catch (const CLI::CallForVersion&) {
    out << "calomel " << version << '\n';
    return false;
  } catch (const CLI::ParseError& e) {
    const auto chosen = app.get_subcommands();
    throw InputError({.problem = e.what(), .suggestion = "see calomel " + (chosen.empty() ? "" : chosen[0]->get_name() + " ") + "--help"});
  }
  command.verb = app.get_subcommands()[0]->get_name();
  if (command.out.empty() && !command.case_file.empty()) command.out = std::filesystem::path(command.case_file).replace_extension(".out");
  if (command.verb == "calibrate" && command.methods.empty()) command.methods = {"enc"};
  return true;
}

}  // namespace calomel
