#pragma once
/// A table of the report. One object gives the HTML for readers and the CSV for programs, so both hold the same values.
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/report/parts/html.hpp"

namespace calomel {

/// A value of a table; `strong` sets it in bold type. A value that is not known is an en dash on the page and empty in CSV.
struct Cell {
  std::variant<std::monostate, double, std::string> value;
  bool strong = false;
  Cell() = default;
  Cell(double x, bool bold = false);
  Cell(std::optional<double> x, bool bold = false);
  Cell(std::string text, bool bold = false) : value(std::move(text)), strong(bold) {}
  Cell(const char* text) : value(std::string(text)) {}
};

/// A column of a table.
struct Column {
  std::string key;    ///< CSV header
  std::string title;  ///< header on the page, plain text
  int digits = 4;     ///< significant digits on the page; a negative number -n means n decimals
  bool text = false;  ///< whether the values are words, which are set to the left
  double factor = 1;  ///< from the value in CSV to the number on the page
};

/// A table: columns, rows and a footer.
struct Table {
  std::string id;       ///< CSV file name without its ending
  std::string caption;  ///< plain text, one sentence
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::vector<Cell> footer;  ///< averages; may be empty
  std::string note;          ///< plain text below the table

  [[nodiscard]] bool empty() const { return rows.empty(); }
  [[nodiscard]] Html html() const;
  /// RFC 4180; numbers with 17 digits where needed. The footer is not part of it.
  [[nodiscard]] std::string csv() const;
};

/// The table's HTML; empty when it has no rows.
Html shown(const Table& table);

/// A text as a CSV field, quoted where it must be.
std::string csv_field(const std::string& text);

}  // namespace calomel
