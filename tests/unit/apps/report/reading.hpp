#pragma once
/// Readers of a written report: its page, the data of its scripts, its tables.

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "apps/report/parts/table.hpp"
#include "apps/report/report.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"

namespace calomel::testing_report {

/// The page without the bodies of its scripts and styles.
inline std::string markup(const std::string& page) {
  std::string out;
  std::size_t at = 0;
  for (;;) {
    const auto script = page.find("<script", at), style = page.find("<style", at), open = std::min(script, style);
    if (open == std::string::npos) return out + page.substr(at);
    const auto body = page.find('>', open) + 1;
    out += page.substr(at, body - at);
    at = page.find(script < style ? "</script>" : "</style>", body);
  }
}

/// The page of the study in `dir`.
inline std::string report_of(const std::filesystem::path& dir, const ReportInput& in) {
  write_report(dir, in);
  return read_text(dir / "report.html");
}

/// The data of the page's scripts.
inline Json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"report-data\">";
  const auto at = page.find(open) + open.size();
  return Json::parse(page.substr(at, page.find("</script>", at) - at));
}

/// RFC 4180: rows of fields, the header first.
inline std::vector<std::vector<std::string>> csv_of(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows{{""}};
  bool quoted = false;
  const std::string text = read_text(path);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quoted && text[i] == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      rows.back().back() += '"';
      ++i;
    } else if (text[i] == '"') {
      quoted = !quoted;
    } else if (!quoted && text[i] == ',') {
      rows.back().emplace_back();
    } else if (!quoted && text[i] == '\n') {
      rows.emplace_back(1, "");
    } else {
      rows.back().back() += text[i];
    }
  }
  rows.pop_back();  // after the last line end
  return rows;
}

/// The number of data row `row` in a column.
inline double number_in(const std::vector<std::vector<std::string>>& csv, std::size_t row, const std::string& column) {
  const auto at = std::find(csv[0].begin(), csv[0].end(), column);
  if (at == csv[0].end()) throw std::runtime_error("no column " + column);
  return std::stod(csv.at(row + 1).at(std::size_t(at - csv[0].begin())));
}

/// The value of a cell that holds words, or a number.
inline std::string text_of(const Cell& cell) { return std::get<std::string>(cell.value); }
inline double value_of(const Cell& cell) { return std::get<double>(cell.value); }

}  // namespace calomel::testing_report
