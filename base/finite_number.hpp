#pragma once

#include <cmath>
#include <exception>
#include <optional>
#include <string>

namespace calomel {

/// The finite number that a word is, whole, blanks before it apart; nothing for any other word.
[[nodiscard]] inline std::optional<double> finite_number(const std::string& word) {
  try {
    std::size_t read = 0;
    const double x = std::stod(word, &read);
    if (read == word.size() && std::isfinite(x)) return x;
  } catch (const std::exception&) {
  }
  return std::nullopt;
}

}  // namespace calomel
