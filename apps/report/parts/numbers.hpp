#pragma once
/// Numbers for reading.
#include <string>

#include "apps/report/parts/html.hpp"

namespace calomel {

inline constexpr double percent = 100;  ///< factor from a share to its number of percent

/// `x` with `digits` significant digits. Digits of the integer part are kept ("13546") and set in groups from five digits on ("13 546"). Below 1e-3 and from
/// 1e7 on it is a mantissa and a power of ten. A number that is not finite is an en dash.
Html number_html(double x, int digits = 4);
/// `x` rounded to `decimals` places, "17.3", as plain text. A number that is not finite is an en dash.
std::string fixed_text(double x, int decimals);
/// The same as HTML.
Html fixed_html(double x, int decimals);

}  // namespace calomel
