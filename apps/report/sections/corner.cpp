#include "apps/report/sections/corner.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/quantities.hpp"
#include "apps/report/data/series.hpp"
#include "apps/report/data/density_curve.hpp"
#include "apps/report/sections/chains.hpp"
#include "apps/report/sections/published.hpp"
#include "uq/convergence/diagnostics.hpp"

namespace calomel {

namespace {

constexpr std::size_t curve_points = 120;
constexpr std::size_t cells = 32;

/// One quantity of the plot.
struct Axis {
  std::string name;
  std::string label;
  std::vector<double> values;  ///< (chain, draw)
  double low = 0;
  double high = 0;  ///< the ends of the frame
  std::optional<double> least;
  std::optional<double> greatest;  ///< the parameter's bounds
};

/// The density of a pair of quantities in cells, and the levels above which 50 and 90 % of the draws lie.
Json pair_json(const Axis& x, const Axis& y) {
  const auto cell_of = [](const Axis& a, double v) { return std::floor((v - a.low) / (a.high - a.low) * double(cells)); };
  std::vector<double> count(cells * cells, 0.0);  // (row of y, column of x)
  std::vector<double> across(cells * cells, 0.0);
  std::vector<double> smooth(cells * cells, 0.0);
  for (std::size_t k = 0; k < x.values.size(); ++k) {
    const double i = cell_of(x, x.values[k]);
    const double j = cell_of(y, y.values[k]);
    if (i >= 0 && j >= 0 && i < double(cells) && j < double(cells)) count[std::size_t(j) * cells + std::size_t(i)] += 1 / double(x.values.size());
  }
  const auto blur = [](const std::vector<double>& from, std::vector<double>& to, std::size_t step_row, std::size_t step_column) {
    constexpr double weights[] = {0.3992, 0.2421, 0.0540, 0.0044};  // a Gaussian of one cell
    for (std::size_t r = 0; r < cells; ++r)
      for (std::size_t c = 0; c < cells; ++c)
        for (int o = -3; o <= 3; ++o) {
          const int at = int(c) + o;
          if (at >= 0 && at < int(cells)) to[r * step_row + c * step_column] += weights[std::abs(o)] * from[r * step_row + std::size_t(at) * step_column];
        }
  };
  blur(count, across, cells, 1);
  blur(across, smooth, 1, cells);
  // The shares above the levels are those of the draws, not of their blurred density, since the two differ much across a narrow ridge.
  std::vector<std::size_t> order(smooth.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return smooth[a] > smooth[b]; });
  const double all = std::accumulate(count.begin(), count.end(), 0.0);
  double sum = 0;
  double level50 = 0;
  double level90 = 0;
  for (const std::size_t k : order) {
    if (sum < 0.5 * all) level50 = smooth[k];
    if (sum < 0.9 * all) level90 = smooth[k];
    sum += count[k];
  }
  const double highest = std::max(smooth[order[0]], 1e-300);
  Json density = Json::array();
  for (const double v : smooth) density.push_back(int(std::lround(1000 * v / highest)));
  return {{"density", std::move(density)}, {"level50", rounded(1000 * level50 / highest, 4)}, {"level90", rounded(1000 * level90 / highest, 4)}};
}

/// A point in the plot: the optimum of a calibration, the nominal values, or a published optimum.
struct Mark {
  std::string label;
  Json theta;
};

std::vector<Mark> marks_of(const Study& study, const std::vector<PublishedAnswer>& published) {
  std::vector<Mark> marks;
  for (const auto& c : study.calibrations) marks.push_back({c.label, part_at(c.summary, "theta")});
  if (!study.calibrations.empty()) marks.push_back({"nominal", part_at(study.calibrations.front().summary, "nominal")});
  for (const auto& p : published) marks.push_back({p.label, p.theta});
  return marks;
}

std::vector<Axis> axes_of(const Study& study, const ReportInput& input) {
  const Draws& draws = *study.posterior;
  std::vector<Axis> axes;
  for (const std::size_t k : shown_quantities(draws, input)) {
    Axis a{.name = draws.names[k], .label = parameter_label(input, draws.names[k]), .values = draws.of(k)};
    for (const auto& p : input.parameters)
      if (p.name == a.name && std::all_of(a.values.begin(), a.values.end(), [&](double v) { return v >= p.min && v <= p.max; })) {
        a.least = p.min;
        a.greatest = p.max;
      }
    axes.push_back(std::move(a));
  }
  // The frame spans the central 99.8 % and a little room. It is widened for a mark nearby; a mark far off is drawn on the frame.
  for (Axis& a : axes) {
    const double low = quantile(a.values, 0.001);
    const double high = quantile(a.values, 0.999);
    const double room = high > low ? high - low : std::max(std::abs(low) * 0.01, 1e-12);
    a.low = low - 0.05 * room;
    a.high = high + 0.05 * room;
    for (const auto& m : marks_of(study, {}))
      if (const auto v = number_at(m.theta, a.name); v && *v > low - 0.6 * room && *v < high + 0.6 * room) {
        a.low = std::min(a.low, *v - 0.05 * room);
        a.high = std::max(a.high, *v + 0.05 * room);
      }
  }
  return axes;
}

}  // namespace

Json corner_json(const Study& study, const ReportInput& input, std::size_t points) {
  if (!study.posterior || study.posterior->values.empty()) return nullptr;
  const auto axes = axes_of(study, input);
  if (axes.empty()) return nullptr;
  Json list = Json::array();
  Json pairs = Json::array();
  Json dots = Json::array();
  Json marks = Json::array();
  Json ridge;
  for (const Axis& a : axes) {
    Json density = Json::array();
    for (const double v : density_curve(a.values, a.low, a.high, a.least, a.greatest, curve_points)) density.push_back(rounded(v, 4));
    list.push_back({{"name", a.name},
                    {"label", a.label},
                    {"span", {a.low, a.high}},
                    {"density", std::move(density)},
                    {"q05", rounded(quantile(a.values, 0.05), 6)},
                    {"q50", rounded(quantile(a.values, 0.5), 6)},
                    {"q95", rounded(quantile(a.values, 0.95), 6)}});
  }
  for (std::size_t j = 1; j < axes.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      Json pair = pair_json(axes[i], axes[j]);
      pair["i"] = i;
      pair["j"] = j;
      pair["cells"] = cells;
      pairs.push_back(std::move(pair));
    }
  const std::size_t n = axes[0].values.size();
  const std::size_t step = stride(n, points);
  for (std::size_t k = 0; k < n; k += step) {
    Json row = Json::array();
    for (const Axis& a : axes) row.push_back(rounded(a.values[k], 5));
    dots.push_back(std::move(row));
  }
  for (const auto& m : marks_of(study, published_answers(input))) {
    Json values = Json::array();
    bool any = false;
    for (const Axis& a : axes) {
      const auto v = number_at(m.theta, a.name);
      any = any || v;
      values.push_back(v ? rounded(*v, 6) : Json());
    }
    if (any) marks.push_back({{"label", m.label}, {"values", std::move(values)}});
  }
  const Impedance z = impedance(input);
  const auto index = [&](const std::string& name) {
    return std::size_t(std::find_if(axes.begin(), axes.end(), [&](const auto& a) { return a.name == name; }) - axes.begin());
  };
  if (const auto a = index(z.density), b = index(z.sound_speed); z.ridge() && a < axes.size() && b < axes.size()) {
    std::vector<double> products;
    for (std::size_t k = 0; k < n; ++k) products.push_back(axes[a].values[k] * axes[b].values[k]);
    ridge = {{"i", std::min(a, b)}, {"j", std::max(a, b)}, {"product", rounded(quantile(products, 0.5), 7)}};
  }
  return {{"axes", std::move(list)},   {"pairs", std::move(pairs)}, {"points", std::move(dots)},
          {"marks", std::move(marks)}, {"ridge", std::move(ridge)}, {"of", study.posterior->names.size()}};
}

}  // namespace calomel
