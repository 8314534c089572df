#include "tests/verification/table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "base/artefact.hpp"
#include "base/errors.hpp"

namespace calomel::testing {
namespace {

std::string number(double v) { return std::isnan(v) ? "" : fmt::format("{:.5g}", v); }

/// Deviation for people: relative where the reference is not 0, absolute otherwise.
std::string error_of(const Row& r) {
  if (r.reference == 0) return number(r.measured);
  return fmt::format("{:+.2g} %", 100 * (r.measured / r.reference - 1));
}
std::string tolerance_of(const Row& r) {
  if (r.reference == 0) return number(r.tolerance);
  return fmt::format("{:.2g} %", 100 * r.tolerance / std::abs(r.reference));
}

std::string key_of(const std::string& item, const std::string& quantity) { return item + " | " + quantity; }

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  std::string cell;
  std::getline(in, cell, '|');
  while (std::getline(in, cell, '|')) {
    const auto first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

}  // namespace

std::string table_page(const Record& record) {
  std::string page =
      "# Verification table\n\n"
      "The program `verification_table` generates this page from the measurements of `tests/verification`; do not edit it. "
      "[README](README.md) describes how to generate it and what the items mean.\n"
      "A row passes if the error is within the tolerance (column *allowed*). The control is the same check with a deliberately wrong law. It must lie outside "
      "the tolerance.\n";
  std::string item;
  for (const auto& r : record.rows) {
    if (r.item != item) {
      item = r.item;
      page +=
          fmt::format("\n## {}\n\n| quantity | reference | measured | error | allowed | order | source | control |\n|---|---|---|---|---|---|---|---|\n", item);
    }
    const std::string unit = r.unit.empty() ? "" : " " + r.unit;
    const std::string control = std::isnan(r.control_value) ? r.control : fmt::format("{}: {}{}", r.control, number(r.control_value), unit);
    page += fmt::format("| {} | {}{} | {}{} | {} | {} | {} | {} | {} |\n", r.quantity, number(r.reference), unit, number(r.measured), unit, error_of(r),
                        tolerance_of(r), std::isnan(r.order) ? "" : fmt::format("{:.2f}", r.order), r.source, control);
  }
  return page;
}

void write_pages(const Record& record, const std::filesystem::path& folder) {
  std::set<std::string> present;
  for (const auto& r : record.rows) present.insert(r.item);
  for (const auto& i : items())
    if (!present.contains(i)) throw InputError({.problem = "no row was recorded for " + i, .suggestion = "run ctest -L verification first, all of it"});
  std::filesystem::create_directories(folder);
  write_atomically(folder / "table.md", table_page(record));
  std::map<std::string, std::vector<Curve>> pictures;
  for (const auto& c : record.curves) pictures[c.picture].push_back(c);
  pictures["convergence"].push_back({"convergence", "guide: first order", {0.2, 1}, {2e-3, 1e-2}});
  pictures["convergence"].push_back({"convergence", "guide: second order", {0.2, 1}, {4e-4, 1e-2}});
  for (const auto& [name, curves] : pictures) write_atomically(folder / (name + ".svg"), picture(name, curves));
}

std::vector<std::string> compare(const Record& record, const std::filesystem::path& page) {
  std::map<std::string, double> committed;
  std::istringstream in(read_text(page));
  std::string item;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("## ")) item = line.substr(3);
    const auto cells = cells_of(line);
    if (cells.size() < 8 || cells[0] == "quantity" || cells[0].starts_with("---")) continue;
    committed[key_of(item, cells[0])] = std::stod(cells[2]);
  }
  std::vector<std::string> differences;
  std::set<std::string> seen, partial;
  for (const auto& r : record.rows) {
    const std::string key = key_of(r.item, r.quantity);
    if (!seen.insert(key).second) differences.push_back("recorded twice: " + key);
    const auto found = committed.find(key);
    if (found == committed.end()) {
      differences.push_back("not in the table: " + key);
      continue;
    }
    // The table shows five digits.
    const double allowed = 0.1 * r.tolerance + 1e-4 * std::abs(found->second);
    if (std::abs(found->second - r.measured) > allowed)
      differences.push_back(fmt::format("moved: {}: {:.5g} in the table, now {:.5g}", key, found->second, r.measured));
  }
  if (record.absent.empty())
    for (const auto& [key, value] : committed)
      if (!seen.contains(key)) differences.push_back("in the table but not recorded: " + key);
  return differences;
}

}  // namespace calomel::testing
