#pragma once
/// A few histories as an SVG picture, solid against dashed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace calomel {

/// One panel: two histories on the same times.
struct PlotPanel {
  std::string title;
  std::vector<double> time, solid, dashed;  ///< [us], any
};

/// Panels below one another with the same times; `unit` of the values.
inline std::string line_plot(const std::string& solid_name, const std::string& dashed_name, const std::string& unit, const std::vector<PlotPanel>& panels) {
  constexpr double width = 640, height = 150, left = 70, right = 15, top = 40, gap = 28;
  const double whole = top + double(panels.size()) * (height + gap) + 20;
  std::string s = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" font-family="sans-serif" font-size="11"><rect width="100%" height="100%" fill="#fff"/>)",
      width, whole);
  s += fmt::format(R"(<path d="M{0} 18h30" stroke="#1f6f8b" stroke-width="2"/><text x="{1}" y="22">{2}</text>)", left, left + 36, solid_name);
  s += fmt::format(R"(<path d="M{0} 18h30" stroke="#c0392b" stroke-width="1.5" stroke-dasharray="4 3"/><text x="{1}" y="22">{2}</text>)", left + 160,
                   left + 196, dashed_name);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const auto& panel = panels[p];
    const double y0 = top + double(p) * (height + gap), end = panel.time.back();
    double low = 0, high = 0;
    for (const auto* v : {&panel.solid, &panel.dashed})
      low = std::min(low, *std::min_element(v->begin(), v->end())), high = std::max(high, *std::max_element(v->begin(), v->end()));
    const double span = std::max(high - low, 1e-300);
    const auto x = [&](double t) { return left + (width - left - right) * t / end; };
    const auto y = [&](double v) { return y0 + height * (high - v) / span; };
    s += fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="#999"/>)", left, y0, width - left - right, height);
    s += fmt::format(R"(<path d="M{} {:.1f}H{}" stroke="#ddd"/><text x="{}" y="{:.1f}" text-anchor="end">0</text>)", left, y(0), width - right, left - 5,
                     y(0) + 4);
    for (const double v : {low, high})
      if (std::abs(v) > 0.15 * span) s += fmt::format(R"(<text x="{}" y="{:.1f}" text-anchor="end">{:.3g}</text>)", left - 5, y(v) + 4, v);
    s += fmt::format(R"(<text x="{}" y="{}" text-anchor="end">{}</text>)", width - right, y0 - 5, panel.title);
    for (const bool solid : {true, false}) {
      const auto& values = solid ? panel.solid : panel.dashed;
      s += solid ? R"(<path fill="none" stroke="#1f6f8b" stroke-width="2" d=")"
                 : R"(<path fill="none" stroke="#c0392b" stroke-width="1.5" stroke-dasharray="4 3" d=")";
      for (std::size_t i = 0; i < values.size(); ++i) s += fmt::format("{}{:.1f} {:.1f}", i ? "L" : "M", x(panel.time[i]), y(values[i]));
      s += R"("/>)";
    }
    if (p + 1 == panels.size())
      for (int tick = 0; tick <= 4; ++tick)
        s += fmt::format(R"(<text x="{:.1f}" y="{}" text-anchor="middle">{:.3g}{}</text>)", x(end * tick / 4), y0 + height + 14, end * tick / 4,
                         tick == 4 ? " µs" : "");
  }
  return s + fmt::format(R"(<text x="5" y="22">{}</text></svg>)", unit) + "\n";
}

}  // namespace calomel
