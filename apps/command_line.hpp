#pragma once
/// What the user typed: `calomel VERB CASE.toml [options]`.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"

namespace calomel {

/// The words after `calomel challenge`.
struct ChallengeWords {
  std::string action;               ///< make, run, score
  std::filesystem::path directory;  ///< of the suite; make: --out
  // make
  std::string suite = "small";
  std::optional<int> none, single, outside, sensor, pair;  ///< in place of the suite's own counts
  std::vector<std::string> effects;                        ///< in place of the suite's own; empty: those
  std::optional<double> grid;                              ///< [m]
  std::filesystem::path generator;                         ///< empty: looked for
  bool specs = false;                                      ///< SPEC files and no records
  // run
  bool discard_runs = false;
  bool new_rule = false;
  // score
  std::filesystem::path json;               ///< empty: score.json of the suite
  std::vector<std::filesystem::path> with;  ///< score.json of other suites, counted too
};

/// The words of one call, checked. Fields that a verb has no option for keep their defaults.
struct CommandLine {
  std::string verb;
  std::filesystem::path case_file;
  std::filesystem::path out;           ///< default: the case's path with ".out" in place of its extension
  std::vector<std::string> overrides;  ///< --set table.key=value, in order
  int threads = 1;                     ///< default: all that the machine shows
  std::uint64_t seed = 1;
  bool quiet = false;
  bool fresh = false;  ///< set old artefacts of the verb's stages aside

  std::vector<std::string> methods;          ///< calibrate: enc, spe, map, all
  std::vector<std::filesystem::path> files;  ///< import
  std::string unit = "strain";               ///< import
  bool fields = false;                       ///< simulate
  bool mean = false;                         ///< simulate
  bool csv = false;                          ///< report
  bool floor = false;                        ///< check
  bool resolved = false;                     ///< check
  bool power = false;                        ///< diagnose
  int port = 4242;                           ///< serve
  std::string host = "127.0.0.1";            ///< serve
  std::filesystem::path write_mesh;          ///< check; empty: none
  ChallengeWords challenge;                  ///< challenge
};

/// What a verb takes beside the options that all of them share.
enum class Takes { nothing, case_file, files, suite };

/// One verb of the program: one file of this folder.
struct Verb {
  std::string name;
  std::string summary;  ///< one line of --help
  Takes takes;
  ExitStatus (*run)(const CommandLine&);
};

/// Options of `verb` beyond the shared ones.
enum class Extra { method, fields, mean, csv, unit, floor, resolved, write_mesh, power, serve };
std::vector<Extra> extras_of(const std::string& verb);

/// Parses the words after the program's name. Returns false when they requested --help or --version, which is then printed
/// to `out`. Errors: InputError for whatever the parser refuses, and for an unknown verb, with the nearest known.
bool parse(std::span<const std::string> words, std::span<const Verb> verbs, CommandLine& command, std::ostream& out);

}  // namespace calomel
