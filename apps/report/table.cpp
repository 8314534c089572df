#include "apps/report/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/options.hpp"

namespace calomel {

std::string escape_html(std::string_view text) {
  std::string s;
  s.reserve(text.size());
  for (const char c : text) switch (c) {
      case '&':
        s += "&amp;";
        break;
      case '<':
        s += "&lt;";
        break;
      case '>':
        s += "&gt;";
        break;
      case '"':
        s += "&quot;";
        break;
      case '\'':
        s += "&#39;";
        break;
      default:
        s += c;
    }
  return s;
}

namespace {
constexpr const char* minus = "\u2212";
constexpr const char* thin_space = "\u202f";

/// "-13546.2" -> groups of three in the integer part and a true minus sign.
std::string grouped(std::string s) {
  const bool negative = !s.empty() && s[0] == '-';
  if (negative) s.erase(0, 1);
  const auto point = s.find('.');
  std::string whole = s.substr(0, point);
  if (whole.size() >= 5)
    for (auto i = std::ptrdiff_t(whole.size()) - 3; i > 0; i -= 3) whole.insert(std::size_t(i), thin_space);
  return (negative ? minus : "") + whole + (point == std::string::npos ? "" : s.substr(point));
}
}  // namespace

std::string fixed_html(double x, int decimals) {
  if (!std::isfinite(x)) return "\u2013";
  std::string s = fmt::format("{:.{}f}", x, decimals);
  if (s.find_first_not_of("-0.") == std::string::npos && s[0] == '-') s.erase(0, 1);  // no "-0.0"
  return grouped(s);
}

std::string number_html(double x, int digits) {
  if (!std::isfinite(x)) return "\u2013";
  if (x == 0) return "0";
  const std::string scientific = fmt::format("{:.{}e}", x, digits - 1);  // rounded first: 9999.6 has five digits before the point
  const int power = std::stoi(scientific.substr(scientific.find('e') + 1));
  if (power >= -3 && power < 7) {
    std::string s = fmt::format("{:.{}f}", x, std::max(0, digits - 1 - power));
    if (s.find('.') != std::string::npos) {
      s.erase(s.find_last_not_of('0') + 1);
      if (s.back() == '.') s.pop_back();
    }
    return grouped(s);
  }
  std::string mantissa = scientific.substr(0, scientific.find('e'));
  if (mantissa.find('.') != std::string::npos) {
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.back() == '.') mantissa.pop_back();
  }
  return fmt::format("{}\u00b710<sup>{}{}</sup>", grouped(mantissa), power < 0 ? minus : "", std::abs(power));
}

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
std::string cell_html(const Cell& cell, const Column& column) {
  if (const auto* x = std::get_if<double>(&cell.value)) {
    const double shown = *x * column.factor;
    return column.digits < 0 ? fixed_html(shown, -column.digits) : number_html(shown, column.digits);
  }
  if (const auto* s = std::get_if<std::string>(&cell.value)) return escape_html(*s);
  return "\u2013";
}

std::string row_html(const std::vector<Cell>& row, const std::vector<Column>& columns) {
  std::string s = "<tr>";
  for (std::size_t i = 0; i < row.size() && i < columns.size(); ++i) {
    std::string inner = cell_html(row[i], columns[i]);
    if (row[i].strong) inner = "<strong>" + inner + "</strong>";
    const char* tag = i == 0 ? "th" : "td";
    s += fmt::format("<{}{}{}>{}</{}>", tag, i == 0 ? " scope=\"row\"" : "",
                     columns[i].text ? (inner.size() > 60 ? " class=\"text long\"" : " class=\"text\"") : "", inner, tag);
  }
  return s + "</tr>\n";
}
}  // namespace

std::string Table::html() const {
  std::string s = fmt::format("<div class=\"table\"><table id=\"table-{}\">\n<caption>{}</caption>\n<thead><tr>", escape_html(id), escape_html(caption));
  for (const auto& c : columns) s += fmt::format("<th scope=\"col\"{}>{}</th>", c.text ? " class=\"text\"" : "", escape_html(c.title));
  s += "</tr></thead>\n<tbody>\n";
  for (const auto& r : rows) s += row_html(r, columns);
  s += "</tbody>\n";
  if (!footer.empty()) s += "<tfoot>" + row_html(footer, columns) + "</tfoot>\n";
  s += "</table></div>\n";
  if (!note.empty()) s += "<p class=\"note\">" + escape_html(note) + "</p>\n";
  return s;
}

std::string Table::csv() const {
  std::string s;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i) s += ',';
    s += csv_field(columns[i].key);
  }
  s += '\n';
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i) s += ',';
      if (const auto* x = std::get_if<double>(&row[i].value)) s += number_text(*x);
      if (const auto* t = std::get_if<std::string>(&row[i].value)) s += csv_field(*t);
    }
    s += '\n';
  }
  return s;
}

}  // namespace calomel
