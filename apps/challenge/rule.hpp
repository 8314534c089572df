#pragma once
/// The rule by which a suite is judged, recorded before its first case is: numbers that are chosen after the answers are known prove nothing.
#include <filesystem>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel::challenge {

Json gates_json(const Gates& gates);

struct Rule {
  Json gates;                          ///< Gates' numbers
  Json diagnosis;                      ///< `[diagnosis]`, resolved
  std::vector<std::string> overrides;  ///< --set, in alphabetical order
  std::string version;                 ///< of the program

  [[nodiscard]] Json json() const;
  /// Over all of these.
  [[nodiscard]] std::string hash() const;
};

/// Writes `directory`/rule.json where there is none. Where there is one of another rule, results/ and rule.json are set aside (NAME.old-N) and the new one is
/// written, if `new_rule`. `program` is the hash of the program's file; each that has worked on the suite is noted. True when `program` is another than those
/// before. Errors: InputError naming what differs from the recorded rule; where there are results of no recorded rule.
bool record_rule(const std::filesystem::path& directory, const Rule& rule, const std::string& program, bool new_rule);

}  // namespace calomel::challenge
