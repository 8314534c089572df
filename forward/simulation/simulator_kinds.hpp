#pragma once
/// The kinds of model that a case may have, `[model] kind`.
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/case_file.hpp"
#include "base/registry.hpp"
#include "forward/simulation/simulator.hpp"

namespace calomel {

/// Names that a kind of model knows beside the rest of the program, such as the mechanisms of a bar.
struct Catalogue {
  std::string title;                                         ///< for `calomel list`
  std::vector<std::pair<std::string, std::string>> entries;  ///< name and summary
};
template <class Entry>
Catalogue catalogue_of(std::string title, const Registry<Entry>& registry) {
  Catalogue out{.title = std::move(title), .entries = {}};
  for (const auto& row : registry.rows()) out.entries.emplace_back(row.name, row.summary);
  return out;
}

/// How a kind of model comes out of a case.
struct SimulatorKind {
  /// Reads every table of the model. Errors: InputError with the place.
  std::unique_ptr<Simulator> (*make)(CaseFile& file, const SimulatorSettings& settings);
  std::vector<std::string> tables;  ///< tables of the case file that this kind reads beside [case], [model], [parameter] and [mechanism]
  std::string (*reference)();       ///< these tables for the reference of the case file, in Markdown
  std::vector<Catalogue> (*catalogues)() = [] { return std::vector<Catalogue>(); };
};

const Registry<SimulatorKind>& simulator_kinds();

/// The simulator of a case; `built_in` if the case does not name a kind. Errors: InputError for an unknown kind, for a table that belongs to another kind, and
/// for whatever is wrong in the tables of its own.
std::unique_ptr<Simulator> make_simulator(CaseFile& file, const SimulatorSettings& settings);

}  // namespace calomel
