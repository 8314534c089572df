#pragma once
/// Physics that may have been left out: named blocks of parameters whose `off` values give the base model exactly.
#include <string>
#include <vector>

#include "base/case_file.hpp"
#include "base/registry.hpp"

namespace calomel {

/// One key of a mechanism: its off value and the range of its default prior.
struct MechanismKey {
  std::string name;
  std::string unit;
  double off;               ///< infinite where the law says "none"
  double low, high;         ///< default prior range
  bool log_uniform = false;
};

/// What the registry knows of a mechanism before (and after) it is built.
struct MechanismEntry {
  std::string law;                 ///< one line
  std::vector<MechanismKey> keys;
  bool built = false;              ///< whether this version can run it
};

/// All thirteen names of physics.md section 3.
const Registry<MechanismEntry>& mechanisms();

/// Reads `[mechanism.*]`: unknown names and keys are errors, enabling one that is not built is an error.
/// Returns a note for every listed mechanism that is not built ("not built yet, not offered").
std::vector<std::string> read_mechanisms(CaseFile& file);

}  // namespace calomel
