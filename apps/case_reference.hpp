#pragma once
/// The reference page of the case file, made from the Options and the catalogues themselves.
#include <string>

namespace calomel {

/// docs/case_reference.md: every table with its keys, units, defaults, ranges and meaning; the mechanisms; the catalogues.
std::string case_reference();

}  // namespace calomel
