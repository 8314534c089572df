#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <optional>
#include <set>
#include <span>

#include "apps/challenge/child.hpp"
#include "apps/challenge/make.hpp"
#include "apps/challenge/rule.hpp"
#include "apps/challenge/run.hpp"
#include "apps/challenge/score.hpp"
#include "apps/inputs/study_case.hpp"
#include "apps/notes.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/verbs.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {

using namespace challenge;

constexpr const char* stage = "challenge";
constexpr std::size_t told_by_name = 10;

/// The first of them, and how many more there are.
std::string few_of(const std::vector<std::string>& names) {
  if (names.size() <= told_by_name) return join(names);
  return join(std::span(names).first(told_by_name)) + fmt::format(" and {} more", names.size() - told_by_name);
}

/// The named suite with what the user gave in place of its own.
SuiteOptions suite_of(const ChallengeWords& words) {
  SuiteOptions options = suites().get(words.suite, "--suite");
  const auto take = [](const std::optional<int>& given, int& value) { value = given.value_or(value); };
  take(words.none, options.none);
  take(words.single, options.single);
  take(words.outside, options.outside);
  take(words.sensor, options.sensor);
  take(words.pair, options.pair);
  if (!words.effects.empty()) options.effects = words.effects;
  options.grid = words.grid.value_or(options.grid);
  return options;
}

ExitStatus make(const CommandLine& command, const Notes& notes) {
  const auto& words = command.challenge;
  const SuiteOptions options = suite_of(words);
  options.validate();
  Generate generate;
  if (!words.specs) generate = generate_by(find_generator(words.generator, own_program()), command.threads);
  ProgressDisplay display(stage, "cases", progress_style(command.quiet), std::cerr);
  const auto summary = make_suite(options, command.seed, words.directory, generate,
                                  [&](std::size_t done, std::size_t total, std::size_t failed) { display.update(done, total, failed_note(failed)); });
  notes.say(stage_line(stage, words.specs
                                  ? fmt::format("{} SPEC files in {}", summary.cases, (words.directory / "truth").string())
                                  : fmt::format("{} cases in {}, {} made now", summary.cases - summary.failed.size(), words.directory.string(), summary.made)));
  if (summary.failed.empty()) return ExitStatus::done;
  notes.warn(
      fmt::format("{} could not be made: {}; truth/NAME.log gives the reason; the same command tries again", summary.failed.size(), few_of(summary.failed)));
  return ExitStatus::not_to_be_trusted;
}

/// `[diagnosis]` of the first case that can be read. Errors: InputError of the first case when none can: what is wrong with --set, for one.
Json diagnosis_options(const std::filesystem::path& directory, const std::vector<std::string>& names, const std::vector<std::string>& overrides) {
  std::optional<InputError> first;
  for (const auto& name : names) try {
      return echo(StudyCase::read(directory / "cases" / name / "case.toml", overrides).diagnosis);
    } catch (const InputError& e) {
      if (!first) first = e;
    }
  throw *first;
}

ExitStatus run(const CommandLine& command, const Notes& notes) {
  const auto& words = command.challenge;
  const auto names = cases_in(words.directory);
  const SuiteLock lock(words.directory, "run");
  Rule rule{
      .gates = gates_json({}), .diagnosis = diagnosis_options(words.directory, names, command.overrides), .overrides = command.overrides, .version = version};
  std::sort(rule.overrides.begin(), rule.overrides.end());
  if (record_rule(words.directory, rule, hash_file("/proc/self/exe"), words.new_rule))
    notes.warn("another build of the program has worked on this suite: the rule's numbers are the same, what they are applied to may not be");
  std::vector<std::string> options{"--threads", std::to_string(command.threads)};
  for (const auto& o : command.overrides) options.insert(options.end(), {"--set", o});
  const auto summary = run_suite(words.directory, diagnose_by("/proc/self/exe", options), words.discard_runs,
                                 [&](const std::string& text) { notes.say(stage_line(stage, text)); });
  notes.say(
      stage_line(stage, fmt::format("{} of {} cases have a diagnosis, {} made now", summary.cases - summary.failed.size(), summary.cases, summary.diagnosed)));
  if (summary.failed.empty()) return ExitStatus::done;
  notes.warn(fmt::format("{} could not be diagnosed: {}; results/NAME/diagnose.log gives the reason; the same command tries again", summary.failed.size(),
                         few_of(summary.failed)));
  return ExitStatus::not_to_be_trusted;
}

ExitStatus score(const CommandLine& command, const Notes& notes) {
  const auto& words = command.challenge;
  std::vector<std::string> waiting;
  auto cases = read_judged(words.directory, waiting);
  const std::size_t own = cases.size();
  Json about = Json::object();
  for (const char* what : {"suite", "rule"})
    if (const auto file = words.directory / (std::string(what) + ".json"); std::filesystem::exists(file)) about[what] = read_json(file);
  const std::string rule = about.contains("rule") ? about["rule"].value("hash", "") : "";
  std::set<std::string> counted;
  const auto count = [&](const JudgedCase& c) { return counted.insert(c.name + Json(c.truth.parameters).dump()).second; };
  for (const auto& c : cases) count(c);
  for (const auto& file : words.with) {
    std::string other;
    for (auto& c : read_scored(file, other)) {
      if (!count(c))
        throw InputError({.problem = "this case is counted already",
                          .value = c.name,
                          .suggestion = "give the score of another suite, and each once",
                          .file = file.string()});
      cases.push_back(std::move(c));
    }
    if (other != rule)
      throw InputError({.problem = "its cases were judged by another rule than those of " + words.directory.string(),
                        .value = other,
                        .range = rule,
                        .suggestion = "count only what one rule has judged",
                        .file = file.string()});
    about["with"].push_back(file.string());
  }
  const challenge::Score result = score_of(cases);  // there is a Score of a simulation, too
  Json json = score_json(result, cases);
  json["waiting"] = waiting;
  json.update(about);
  const auto path = words.json.empty() ? words.directory / "score.json" : words.json;
  write_json(path, json);
  Notes(std::cout, false).say(score_lines(result));
  std::cout.flush();
  if (!waiting.empty()) notes.warn(fmt::format("{} of {} cases have no diagnosis yet and are not counted", waiting.size(), waiting.size() + own));
  if (!json.contains("rule")) notes.warn("there is no rule.json: nothing shows that one rule has judged all cases");
  notes.say(stage_line(stage, "all numbers in " + path.string()));
  return ExitStatus::done;
}

}  // namespace

ExitStatus run_challenge(const CommandLine& command) {
  const Notes notes(std::cerr, command.quiet);
  const std::string& action = command.challenge.action;
  return action == "make" ? make(command, notes) : action == "run" ? run(command, notes) : score(command, notes);
}

}  // namespace calomel
