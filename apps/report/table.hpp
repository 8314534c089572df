#pragma once
/// A table of the report: one object gives the HTML that is read and the CSV that is computed with, so both hold the same values.
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace calomel {

/// Text with & < > " ' replaced by entities.
std::string escape_html(std::string_view text);
/// `x` with `digits` significant digits for reading: digits of the integer part are kept ("13546"), from five on in groups
/// ("13 546"), below 1e-3 and from 1e7 on as mantissa and power of ten. HTML.
std::string number_html(double x, int digits = 4);
/// `x` rounded to `decimals` places, "17.3". HTML.
std::string fixed_html(double x, int decimals);

/// A value of a table; `strong` sets it in bold type. Nothing = not known: an en dash on the page, empty in CSV.
struct Cell {
  std::variant<std::monostate, double, std::string> value;
  bool strong = false;
  Cell() = default;
  Cell(double x, bool bold = false);
  Cell(std::optional<double> x, bool bold = false);
  Cell(std::string text, bool bold = false) : value(std::move(text)), strong(bold) {}
  Cell(const char* text) : value(std::string(text)) {}
};

struct Column {
  std::string key;    ///< CSV header
  std::string title;  ///< page header, plain text
  int digits = 4;     ///< significant digits on the page; negative: -n decimals after the point
  bool text = false;  ///< words: set to the left
  double factor = 1;  ///< from the value (as in CSV) to what the page shows
};

struct Table {
  std::string id;       ///< CSV file name without its ending
  std::string caption;  ///< plain text, one sentence
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::vector<Cell> footer;  ///< averages; may be empty
  std::string note;          ///< plain text below the table

  [[nodiscard]] bool empty() const { return rows.empty(); }
  [[nodiscard]] std::string html() const;
  /// RFC 4180; numbers with 17 digits where needed. The footer is not part of it.
  [[nodiscard]] std::string csv() const;
};

/// A text as a CSV field, quoted where it must be.
std::string csv_field(const std::string& text);

}  // namespace calomel
