// Line plots as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "tests/verification/table.hpp"

namespace calomel::testing {
namespace {

struct Axis {
  std::string label;
  bool logarithmic = false;
  double low = 0, high = 1;

  [[nodiscard]] double scaled(double v) const { return logarithmic ? std::log10(v) : v; }
  [[nodiscard]] double share(double v) const { return (scaled(v) - scaled(low)) / (scaled(high) - scaled(low)); }

  void fit(const std::vector<double>& values) {
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    if (logarithmic)
      low = *least / 1.3, high = *greatest * 1.3;
    else
      low = *least - 0.03 * (*greatest - *least), high = *greatest + 0.03 * (*greatest - *least);
  }
  /// Powers of ten, times 1, 2 and 5 on a short axis; or about six round steps.
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> t;
    if (logarithmic) {
      const bool fine = std::log10(high / low) < 2.5;
      for (double decade = std::pow(10, std::floor(std::log10(low))); decade < high; decade *= 10)
        for (const double m : {1., 2., 5.})
          if ((fine || m == 1) && decade * m > low && decade * m < high) t.push_back(decade * m);
      return t;
    }
    const double raw = (high - low) / 6, power = std::pow(10, std::floor(std::log10(raw)));
    const double step = raw / power < 2 ? 2 * power : raw / power < 5 ? 5 * power : 10 * power;
    for (double v = std::ceil(low / step) * step; v <= high; v += step) t.push_back(std::abs(v) < 1e-9 * step ? 0 : v);
    return t;
  }
};

const std::map<std::string, std::pair<Axis, Axis>> axes{
    {"convergence", {{"element size over that of the coarsest mesh", true}, {"relative error", true}}},
    {"bleich_sandler", {{"time [ms]"}, {"velocity of the plate [m/s]"}}},
    {"pochhammer_chree", {{"omega a / c0"}, {"c / c0"}}},
};

constexpr std::array colours{"#1f5a99", "#b03a2e", "#2e7d4f", "#8a5a00", "#6a3d9a", "#c2527a", "#777777", "#444444"};
constexpr double left = 70, top = 20, width = 460, height = 320, legend = 200;

}  // namespace

std::string picture(const std::string& name, const std::vector<Curve>& curves) {
  const auto found = axes.find(name);
  Axis x = found == axes.end() ? Axis{name} : found->second.first, y = found == axes.end() ? Axis{""} : found->second.second;
  std::vector<double> all_x, all_y;
  for (const auto& c : curves) all_x.insert(all_x.end(), c.x.begin(), c.x.end()), all_y.insert(all_y.end(), c.y.begin(), c.y.end());
  x.fit(all_x);
  y.fit(all_y);
  const auto px = [&](double v) { return left + width * x.share(v); };
  const auto py = [&](double v) { return top + height * (1 - y.share(v)); };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      left + width + legend, top + height + 50);
  for (const double t : x.ticks())
    svg += fmt::format("<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:.3g}</text>\n", px(t), top,
                       top + height, top + height + 16, t);
  for (const double t : y.ticks())
    svg += fmt::format("<path d=\"M{1} {0:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.3g}</text>\n", py(t), left,
                       left + width, left - 6, py(t) + 4, t);
  svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#444\"/>\n", left, top, width, height);
  svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", left + width / 2, top + height + 38, x.label);
  svg += fmt::format("<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n", top + height / 2, y.label);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const auto& c = curves[k];
    const char* colour = colours[k % colours.size()];
    const bool guide = c.name.starts_with("guide"), alone = c.name.ends_with("(points)"), points = !guide && (alone || c.x.size() < 20);
    if (!alone) {
      std::string path;
      for (std::size_t i = 0; i < c.x.size(); ++i) path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? 'M' : 'L', px(c.x[i]), py(c.y[i]));
      svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{}/>\n", path, colour, guide ? " stroke-dasharray=\"5 4\"" : "");
    }
    if (points)
      for (std::size_t i = 0; i < c.x.size(); ++i)
        svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\" fill=\"{}\"/>\n", px(c.x[i]), py(c.y[i]), colour);
    const double at = top + 12 + 18 * double(k);
    svg += fmt::format("<rect x=\"{}\" y=\"{:.1f}\" width=\"14\" height=\"3\" fill=\"{}\"/><text x=\"{}\" y=\"{:.1f}\">{}</text>\n", left + width + 12, at - 5,
                       colour, left + width + 32, at, c.name);
  }
  return svg + "</svg>\n";
}

}  // namespace calomel::testing
