#include "apps/report/parts/table.hpp"

#include <algorithm>
#include <cmath>

#include "apps/report/parts/numbers.hpp"
#include "base/options.hpp"

namespace calomel {

Cell::Cell(double x, bool bold) : strong(bold) {
  if (std::isfinite(x)) value = x;
}
Cell::Cell(std::optional<double> x, bool bold) : Cell(x ? *x : std::nan(""), bold) {}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string s = "\"";
  for (const char c : text) s += c == '"' ? std::string("\"\"") : std::string(1, c);
  return s + '"';
}

namespace {

constexpr std::size_t long_text = 60;  ///< bytes of HTML above which a cell of words may be broken into lines

Html cell_content(const Cell& cell, const Column& column) {
  if (const auto* x = std::get_if<double>(&cell.value)) {
    const double number = *x * column.factor;
    return column.digits < 0 ? fixed_html(number, -column.digits) : number_html(number, column.digits);
  }
  if (const auto* s = std::get_if<std::string>(&cell.value)) return *s;
  return "\u2013";
}

Html cell_html(const Cell& cell, const Column& column, bool first) {
  const Html plain = cell_content(cell, column);
  const Html inner = cell.strong ? element("strong", plain) : plain;
  HtmlAttributes attributes;
  if (first) attributes.push_back({"scope", "row"});
  if (column.text) attributes.push_back({"class", inner.str().size() > long_text ? "text long" : "text"});
  return element(first ? "th" : "td", attributes, inner);
}

Html row_html(const std::vector<Cell>& row, const std::vector<Column>& columns) {
  Html cells;
  for (std::size_t i = 0; i < std::min(row.size(), columns.size()); ++i) cells += cell_html(row[i], columns[i], i == 0);
  return element("tr", cells) + "\n";
}

Html header_cell(const Column& column) {
  HtmlAttributes attributes{{"scope", "col"}};
  if (column.text) attributes.push_back({"class", "text"});
  return element("th", attributes, column.title);
}

}  // namespace

Html Table::html() const {
  Html header;
  for (const auto& c : columns) header += header_cell(c);
  Html body;
  for (const auto& r : rows) body += row_html(r, columns);
  const Html foot = footer.empty() ? Html() : element("tfoot", row_html(footer, columns)) + "\n";
  const Html table = element("table", {{"id", "table-" + id}}, "\n", element("caption", caption), "\n", element("thead", element("tr", header)), "\n",
                             element("tbody", "\n", body), "\n", foot);
  Html all = element("div", {{"class", "table"}}, table) + "\n";
  if (!note.empty()) all += element("p", {{"class", "note"}}, note) + "\n";
  return all;
}

std::string Table::csv() const {
  std::string s;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i > 0) s += ',';
    s += csv_field(columns[i].key);
  }
  s += '\n';
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) s += ',';
      if (const auto* x = std::get_if<double>(&row[i].value)) s += number_text(*x);
      if (const auto* t = std::get_if<std::string>(&row[i].value)) s += csv_field(*t);
    }
    s += '\n';
  }
  return s;
}

Html shown(const Table& table) { return table.empty() ? Html() : table.html(); }

}  // namespace calomel
