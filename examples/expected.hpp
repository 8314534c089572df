#pragma once
/// The numbers that an example is expected to print, in a file of lines `name,value,tolerance` (absolute, `#` comments).
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "base/artefact.hpp"

namespace calomel::examples {

/// Prints each expected number beside the one found; false when one is absent or farther off than its tolerance.
inline bool as_expected(const std::map<std::string, double>& found, const std::string& file) {
  std::istringstream lines(read_text(file));
  bool all = true;
  int checked = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::string name, value, tolerance;
    std::getline(cells, name, ','), std::getline(cells, value, ','), std::getline(cells, tolerance, ',');
    const auto it = found.find(name);
    const double wanted = std::stod(value), most = std::stod(tolerance);
    const bool good = it != found.end() && std::abs(it->second - wanted) <= most;
    fmt::print("{:<34} {:>12} expected {:.6g} +- {:.2g}: {}\n", name, it == found.end() ? "absent" : fmt::format("{:.6g}", it->second), wanted, most,
               good ? "as expected" : "NOT AS EXPECTED");
    all = all && good;
    ++checked;
  }
  return all && checked > 0;
}

}  // namespace calomel::examples
