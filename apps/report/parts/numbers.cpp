#include "apps/report/parts/numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>

namespace calomel {

namespace {

constexpr const char* minus = "\u2212";
constexpr const char* thin_space = "\u202f";
constexpr const char* not_known = "\u2013";

/// "-13546.2" with groups of three digits in the integer part and a true minus sign.
std::string grouped(std::string s) {
  const bool negative = !s.empty() && s[0] == '-';
  if (negative) s.erase(0, 1);
  const auto point = s.find('.');
  std::string whole = s.substr(0, point);
  if (whole.size() >= 5)
    for (auto i = std::ptrdiff_t(whole.size()) - 3; i > 0; i -= 3) whole.insert(std::size_t(i), thin_space);
  return (negative ? minus : "") + whole + (point == std::string::npos ? "" : s.substr(point));
}

/// Without zeros at the end of its decimals, and without a point at its end.
std::string without_trailing_zeros(std::string s) {
  if (s.find('.') == std::string::npos) return s;
  s.erase(s.find_last_not_of('0') + 1);
  if (s.back() == '.') s.pop_back();
  return s;
}

}  // namespace

std::string fixed_text(double x, int decimals) {
  if (!std::isfinite(x)) return not_known;
  std::string s = fmt::format("{:.{}f}", x, decimals);
  if (s.find_first_not_of("-0.") == std::string::npos && s[0] == '-') s.erase(0, 1);  // no "-0.0"
  return grouped(s);
}

Html fixed_html(double x, int decimals) { return fixed_text(x, decimals); }

Html number_html(double x, int digits) {
  if (!std::isfinite(x)) return not_known;
  if (x == 0) return "0";
  const std::string scientific = fmt::format("{:.{}e}", x, digits - 1);  // rounded first, since 9999.6 becomes a number of five digits
  const int power = std::stoi(scientific.substr(scientific.find('e') + 1));
  if (power >= -3 && power < 7) return grouped(without_trailing_zeros(fmt::format("{:.{}f}", x, std::max(0, digits - 1 - power))));
  const std::string mantissa = without_trailing_zeros(scientific.substr(0, scientific.find('e')));
  return fragment(grouped(mantissa), "\u00b710", element("sup", power < 0 ? minus : "", std::to_string(std::abs(power))));
}

}  // namespace calomel
