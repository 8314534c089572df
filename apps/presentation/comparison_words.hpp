#pragma once
/// The sentence and the tables about calibrations of one case side by side.
#include <string>

#include "inverse/comparison/comparison.hpp"

namespace calomel {

/// Which answers lie within the posterior, and by how much the others miss it.
[[nodiscard]] std::string comparison_sentence(const Comparison& comparison);
/// The tables in plain text, numbers aligned, and the sentence below them.
[[nodiscard]] std::string comparison_text(const Comparison& comparison);

}  // namespace calomel
