#pragma once
/// The keys of a mechanism for the reference of the case file.
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

/// A table in Markdown with a row a key. Numbered keys that are alike, such as left_1 to left_64, share one row.
std::string mechanism_rows(const std::vector<MechanismKey>& keys);

}  // namespace calomel
