#include "apps/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
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

void add_threads(CLI::App& verb, CommandLine& command, const std::string& doc) {
  verb.add_option("--threads", command.threads, doc)->check(CLI::Range(1, 4096))->type_name("N");
}

CLI::Option* add_seed(CLI::App& verb, CommandLine& command, const std::string& doc) {
  return verb.add_option("--seed", command.seed, doc)->type_name("S")->check([](const std::string& text) {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
    return error == std::errc() && end == text.data() + text.size() ? std::string() : "a seed is a whole number from 0 to 2^64 - 1, not " + text;
  });
}

void add_overrides(CLI::App& verb, CommandLine& command, const std::string& doc) {
  verb.add_option("--set", command.overrides, doc)->type_name("TABLE.KEY=VALUE")->allow_extra_args(false);
}

void add_quiet(CLI::App& verb, CommandLine& command) { verb.add_flag("--quiet", command.quiet, "no progress and no notes"); }

/// Words of their own after the verb: make, run, score.
void add_challenge(CLI::App& verb, CommandLine& command) {
  auto& words = command.challenge;
  verb.require_subcommand(1);
  auto& make =
      *verb.add_subcommand("make", "make cases with physics that is concealed in them, and their truth in another folder; resumes an interrupted call");
  add_seed(make, command, "seed of the suite: the same seed gives the same cases")->required();
  make.add_option("--out", words.directory, "directory of the suite")->required()->type_name("DIR");
  make.add_option("--suite", words.suite, "how many cases of which kind (default: small): small, quick, full")->type_name("NAME");
  const auto count = [&](const char* name, std::optional<int>& value, const char* doc) {
    make.add_option(name, value, doc)->check(CLI::Range(0, 100000))->take_last()->type_name("N");
  };
  count("--none", words.none, "cases with nothing concealed, in place of the suite's number");
  count("--single", words.single, "of each effect that the library has a mechanism for");
  count("--outside", words.outside, "of each effect that it has none for");
  count("--sensor", words.sensor, "with a fault of one gauge");
  count("--pair", words.pair, "with two effects");
  make.add_option("--effects", words.effects, "singles and outside keep to these")->delimiter(',')->allow_extra_args(false)->type_name("A,B");
  make.add_option("--grid", words.grid, "spacing of the generator's grid [m] (default: 0.25e-3)")->type_name("H");
  make.add_option("--generator", words.generator, "the program reference_generator (default: looked for beside this one, in its build tree and in libexec)")
      ->type_name("PATH");
  make.add_flag("--specs", words.specs, "only draw the cases: their SPEC files in truth/, no records");
  add_threads(make, command, "threads of the generator (default: all)");
  auto& run = *verb.add_subcommand("run", "diagnose every case that has no diagnosis yet, as calomel diagnose does; resumes an interrupted call");
  auto& score = *verb.add_subcommand("score", "hold the diagnoses against the truth: confusion, gates with exact bounds, Brier score, coverage");
  for (auto* one : {&run, &score}) one->add_option("DIR", words.directory, "directory of the suite")->required()->type_name("");
  add_threads(run, command, "threads of a diagnosis (default: all)");
  add_overrides(run, command, "override a value of every case; may be repeated");
  run.add_flag("--discard-runs", words.discard_runs, "delete the journal of a case's runs once its diagnosis is finished");
  run.add_flag("--new-rule", words.new_rule, "where the rule of decision has changed, set the old results aside (results.old-N) and start again");
  score.add_option("--with", words.with, "scores of other suites that one rule has judged, whose cases are counted too; may be repeated")
      ->check(CLI::ExistingFile)
      ->allow_extra_args(false)
      ->type_name("FILE");
  score.add_option("--json", words.json, "where all numbers go (default: DIR/score.json)")->type_name("FILE");
  for (auto* one : {&make, &run, &score}) add_quiet(*one, command);
}

void add_shared(CLI::App& verb, CommandLine& command, Takes takes) {
  if (takes == Takes::suite) return add_challenge(verb, command);
  if (takes == Takes::nothing) return;
  auto* out = verb.add_option("--out", command.out, "directory of the artefacts (default: CASE.out/ beside the case)")->type_name("DIR");
  if (takes == Takes::files) {
    verb.add_option("FILE", command.files, "recordings in CSV or text")->required()->type_name("");
    out->required()->description("directory of recordings.nc");
    return;
  }
  verb.add_option("CASE", command.case_file, "case file (TOML)")->required()->type_name("");
  add_overrides(verb, command, "override a value of the case; may be repeated");
  add_threads(verb, command, "threads at most (default: all); a run that would not gain by them takes fewer");
  add_seed(verb, command, "seed of all random streams (default: 1)");
  verb.add_flag("--fresh", command.fresh, "set finished artefacts of other settings aside (NAME.old-N) and start again");
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
      verb.add_flag("--power", command.power, "before measuring: what records of these gauges could show, see [power]; needs no recordings");
      return;
    case Extra::write_mesh:
      verb.add_option("--write-mesh", command.write_mesh, "write the mesh with its sets, Abaqus input (.inp) or Exodus II (.exo)")->type_name("FILE");
      return;
    case Extra::serve:
      verb.add_option("--port", command.port, "port (default: 4242; 0: any that is free)")->type_name("PORT")->check(CLI::Range(0, 65535));
      verb.add_option("--host", command.host, "address to listen at (default: 127.0.0.1, this machine alone)")->type_name("HOST");
      return;
    case Extra::unit:
      verb.add_option("--unit", command.unit, "unit of the values (default: strain)")->type_name("strain|microstrain");
      return;
  }
}

/// A suggestion, where there is one, and what to do in any case.
std::string suggestion_and(const std::string& suggestion, const std::string& otherwise) {
  return suggestion.empty() ? otherwise : suggestion + ' ' + otherwise;
}

/// `did you mean "--floor"?` of the first word that looks like an option and is none; empty where there is none such, or none near.
std::string near_option(const CLI::App& verb, std::span<const std::string> words) {
  std::vector<std::string> known;
  for (const auto* o : verb.get_options())
    for (const auto& name : o->get_lnames()) known.push_back("--" + name);
  for (const auto& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || std::find(known.begin(), known.end(), name) != known.end()) continue;
    return name_suggestion(name, known);
  }
  return "";
}

}  // namespace

std::vector<Extra> extras_of(const std::string& verb) {
  if (verb == "check") return {Extra::resolved, Extra::floor, Extra::write_mesh};
  if (verb == "calibrate") return {Extra::method};
  if (verb == "simulate") return {Extra::fields, Extra::mean};
  if (verb == "report") return {Extra::csv};
  if (verb == "diagnose") return {Extra::power};
  if (verb == "import") return {Extra::unit};
  if (verb == "serve") return {Extra::serve};
  return {};
}

bool parse(std::span<const std::string> words, std::span<const Verb> verbs, CommandLine& command, std::ostream& out) {
  const auto known = names_of(verbs);
  command.threads = default_threads();
  if (!words.empty() && !words[0].starts_with('-') && std::find(known.begin(), known.end(), words[0]) == known.end())
    throw InputError({.problem = "no verb of this name",
                      .value = '"' + words[0] + '"',
                      .range = join(known),
                      .suggestion = suggestion_and(name_suggestion(words[0], known), "(calomel --help)")});

  CLI::App app("Inverse problems where a violent pulse meets a structure: simulate it, learn it, calibrate it.", "calomel");
  app.set_version_flag("--version", std::string("calomel ") + version);
  app.require_subcommand(1);
  app.footer(
      "calomel VERB --help lists the options of a verb.\nExit status: 0 done, 2 wrong input, 3 failed numerics, 4 finished but not to be trusted, 130 "
      "interrupted.");
  for (const auto& v : verbs) {
    auto* verb = app.add_subcommand(v.name, v.summary);
    add_shared(*verb, command, v.takes);
    for (const auto extra : extras_of(v.name)) add_extra(*verb, command, extra);
    if (v.takes != Takes::suite) add_quiet(*verb, command);
  }

  // The innermost of the words that name a verb.
  const auto innermost = [&] {
    CLI::App* at = &app;
    while (!at->get_subcommands().empty()) at = at->get_subcommands()[0];
    return at;
  };
  const auto called = [&](CLI::App* at) {
    std::string text;
    for (; at != &app; at = at->get_parent()) text = ' ' + at->get_name() + text;
    return "calomel" + text;
  };
  std::vector<std::string> reversed(words.rbegin(), words.rend());  // as CLI11 wants them
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    out << (innermost() == &app ? app.help() : innermost()->help(called(innermost()->get_parent()), CLI::AppFormatMode::Normal));
    return false;
  } catch (const CLI::CallForVersion&) {
    out << "calomel " << version << '\n';
    return false;
  } catch (const CLI::ParseError& e) {
    throw InputError({.problem = e.what(), .suggestion = suggestion_and(near_option(*innermost(), words), "see " + called(innermost()) + " --help")});
  }
  command.verb = app.get_subcommands()[0]->get_name();
  if (innermost()->get_name() != command.verb) command.challenge.action = innermost()->get_name();
  if (command.out.empty() && !command.case_file.empty()) command.out = std::filesystem::path(command.case_file).replace_extension(".out");
  if (command.verb == "calibrate" && command.methods.empty()) command.methods = {"enc"};
  return true;
}

}  // namespace calomel
