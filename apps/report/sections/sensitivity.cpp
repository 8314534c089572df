#include "apps/report/sections/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/quantities.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"
#include "apps/report/sections/sensitivity_tables.hpp"
#include "apps/report/sections/sensitivity_totals.hpp"

namespace calomel {

namespace {

constexpr std::size_t map_windows = 100;
constexpr std::size_t curve_windows = 300;
constexpr double hardly_varies = 0.01;    ///< share of a record's greatest standard deviation
constexpr double negligible = 0.02;       ///< total index; a parameter whose whole interval lies below it hardly matters
constexpr double believable = 0.9;        ///< least left-out R2 of a polynomial that may check a surrogate
constexpr double poor_surrogate = 0.95;   ///< R2 below which the indices of a surrogate are doubted
constexpr double hardly_together = 0.98;  ///< sum of the first-order indices from which the parameters hardly interact

Html share_html(double x) { return fixed_html(percent * x, std::abs(x) < 0.0995 ? 1 : 0) + "\u00a0%"; }

Html interval_html(const Json& index) {
  const auto low = number_at(index, "low");
  const auto high = number_at(index, "high");
  return low && high ? fragment(" (", share_html(*low), " to ", share_html(*high), ")") : Html();
}

/// The indices of one parameter over all records together.
struct Whole {
  std::string parameter;
  const Json* total = nullptr;
  double share = 0;  ///< total index
  double alone = 0;  ///< first-order index
};

/// All parameters, the greatest total index first.
std::vector<Whole> whole_of(const Study& study) {
  std::vector<Whole> list;
  const Json& first = list_at(sensitivity_summary(study), "first_order");
  const Json& total = list_at(sensitivity_summary(study), "total_order");
  for (std::size_t k = 0; k < total.size() && k < first.size(); ++k)
    if (const auto t = number_at(total[k], "value")) list.push_back({text_at(total[k], "parameter"), &total[k], *t, number_at(first[k], "value").value_or(0)});
  std::stable_sort(list.begin(), list.end(), [](const Whole& a, const Whole& b) { return a.share > b.share; });
  return list;
}

/// The share of each parameter in the variation of the records.
Html shares_paragraphs(const std::vector<Whole>& list) {
  double alone = 0;
  for (const auto& w : list) alone += w.alone;
  Html shares = fragment(strong(list[0].parameter), " has a part in ", share_html(list[0].share), interval_html(*list[0].total));
  for (std::size_t k = 1; k < list.size(); ++k)
    shares += fragment(k + 1 == list.size() ? " and " : ", ", list[k].parameter, " in ", share_html(list[k].share), interval_html(*list[k].total));
  return paragraph_of("outcome", "Of all the variation of the records, ", shares, ".") +
         paragraph(
             "These are total indices: the effect of a parameter alone and in interactions, so they may add up to more than 100\u00a0%. In brackets: 95\u00a0% "
             "intervals. Alone, the parameters cause ",
             share_html(alone), " of the variation", alone < hardly_together ? "; the rest is due to interactions." : ", so interactions are small.");
}

/// The parameters that hardly matter.
Html weak_paragraph(const std::vector<Whole>& list) {
  std::vector<Html> weak;
  for (const auto& w : list)
    if (const auto high = number_at(*w.total, "high"); high && *high < negligible) weak.emplace_back(w.parameter);
  if (weak.empty()) return {};
  const bool one = weak.size() == 1;
  return paragraph(joined(weak, ", "), one ? " hardly matters" : " hardly matter", " within these bounds: these records contain almost no information on ",
                   one ? "it" : "them", ".");
}

/// The neighbours in the order whose intervals overlap.
Html tied_paragraph(const std::vector<Whole>& list) {
  std::vector<Html> tied;
  for (std::size_t k = 0; k + 1 < list.size(); ++k) {
    const auto low = number_at(*list[k].total, "low");
    const auto high = number_at(*list[k + 1].total, "high");
    if (low && high && *high > *low && list[k].share >= negligible) tied.emplace_back(list[k].parameter + " and " + list[k + 1].parameter);
  }
  if (tied.empty()) return {};
  return paragraph("Their intervals overlap, so which of them matters more is not settled: ", joined(tied, "; "), ". More ",
                   element("code", "sensitivity.samples"), " narrow the intervals.");
}

Html result_paragraphs(const Study& study) {
  const auto list = whole_of(study);
  if (list.empty()) return missing("sensitivity.json holds no index of all records, for nothing varies.");
  return shares_paragraphs(list) + weak_paragraph(list) + tied_paragraph(list);
}

/// The bounds within which the parameters varied, from the options of the analysis.
Html bounds_paragraph(const Study& study, const ReportInput& input) {
  std::vector<Html> bounds;
  const Json& own = part_at(part_at(part_at(sensitivity_summary(study), "provenance"), "options"), "parameter");
  for (const auto& p : input.parameters) {
    const std::string unit = parameter_unit(input, p.name);
    const Json& then = part_at(own, p.name);
    bounds.push_back(fragment(p.name, " ", number_html(number_at(then, "min").value_or(p.min), 5), " to ",
                              number_html(number_at(then, "max").value_or(p.max), 5), unit.empty() ? "" : "\u00a0" + unit));
  }
  const bool by_prior = text_at(sensitivity_summary(study), "measure") == "prior";
  return paragraph("The parameters varied ", by_prior ? "by their priors within their bounds" : "evenly between their bounds",
                   bounds.empty() ? Html() : fragment(" (", joined(bounds, "; "), ")"),
                   ". A share is a statement about these bounds as much as about the model: a parameter whose bounds are wider has more of it.");
}

/// The source of the indices, with the error of the surrogate.
Html source_sentence(const Study& study) {
  if (text_at(sensitivity_summary(study), "source").find("surrogate") == std::string::npos) return "The indices are those of the model itself.";
  Html s = "The indices are those of the surrogate";
  const Json trained = study.train ? list_at(*study.train, "surrogates") : Json();
  if (const auto r2 = trained.empty() ? std::nullopt : number_at(trained[0], "r2")) {
    s += fragment(", whose R\u00b2 on runs that it was not trained on is ", fixed_html(*r2, 3));
    if (*r2 < poor_surrogate) s += ": " + strong("too poor for shares that are to be relied on; make the campaign larger");
  }
  return s + ".";
}

/// The comparison with the indices of polynomials that were fitted to the runs themselves.
Html check_sentence(const Study& study) {
  std::size_t checked = 0;
  std::size_t quantities = 0;
  double farthest = 0;
  for (const auto& q : list_at(sensitivity_summary(study), "quantities")) {
    const Json& p = part_at(q, "polynomial");
    if (!p.is_object() || is_run_total(text_at(q, "name"))) continue;  // the indices of a total are those of its polynomial, which is no check
    ++quantities;
    if (number_at(p, "left_out_r2").value_or(0) < believable) continue;
    ++checked;
    const Json& own = list_at(q, "total_order");
    const Json& other = list_at(p, "total_order");
    for (std::size_t k = 0; k < own.size() && k < other.size(); ++k)
      farthest = std::max(farthest, std::abs(number_at(own[k], "value").value_or(0) - number_at(other[k], "value").value_or(0)));
  }
  if (quantities == 0) return {};
  if (checked == 0)
    return fmt::format(" A polynomial fitted to the runs themselves follows none of the {} numbers (left-out R\u00b2 below 0.9), so it is no check.",
                       quantities);
  return fragment(fmt::format(" A polynomial fitted to the runs themselves follows {} of the {} numbers (left-out R\u00b2 above 0.9); there its total indices "
                              "differ from these by ",
                              checked, quantities),
                  fixed_html(farthest, 2), " at most.");
}

/// How far the indices may be trusted: the errors of the surrogate, the check by polynomials, failures.
Html trust_paragraph(const Study& study) {
  const Json& s = sensitivity_summary(study);
  const auto evaluations = number_at(s, "evaluations");
  const auto failed = number_at(s, "failed");
  Html effort;
  if (evaluations)
    effort = fragment(" It took ", number_html(*evaluations, 7), " evaluations",
                      failed && *failed > 0 ? fragment(", of which ", number_html(*failed, 6), " failed and were left out") : Html(), ".");
  return paragraph(source_sentence(study), check_sentence(study), effort);
}

/// Windows of time with nearly equal numbers of samples.
struct Windows {
  std::size_t times;
  std::size_t count;
  [[nodiscard]] std::size_t begin(std::size_t w) const { return w * times / count; }
};

/// The indices of one record by window, (parameter, window), empty where the record hardly varies; and its standard deviation by window.
struct Windowed {
  std::vector<std::vector<std::optional<double>>> first;
  std::vector<std::vector<std::optional<double>>> total;
  std::vector<double> sd;
};

Windowed windowed(const SensitivityArtefacts& s, std::size_t record, const Windows& windows) {
  const std::size_t d = s.parameters.size();
  const std::size_t n = s.time.size();
  double greatest = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (const double x = s.sd[record * n + i]; std::isfinite(x)) greatest = std::max(greatest, x);
  Windowed out{.first = std::vector(d, std::vector<std::optional<double>>(windows.count)), .total = {}, .sd = {}};
  out.total = out.first;
  for (std::size_t w = 0; w < windows.count; ++w) {
    double variance = 0;
    std::vector<double> first(d, 0.0);
    std::vector<double> total(d, 0.0);
    for (std::size_t i = windows.begin(w); i < windows.begin(w + 1); ++i) {
      const double v = s.sd[record * n + i] * s.sd[record * n + i];
      if (!std::isfinite(v) || !(v > 0)) continue;
      variance += v;
      for (std::size_t k = 0; k < d; ++k) {
        const double a = s.first_order[(record * n + i) * d + k];
        const double b = s.total_order[(record * n + i) * d + k];
        first[k] += std::isfinite(a) ? v * a : 0;
        total[k] += std::isfinite(b) ? v * b : 0;
      }
    }
    out.sd.push_back(std::sqrt(variance / double(windows.begin(w + 1) - windows.begin(w))));
    if (!(out.sd.back() >= hardly_varies * greatest) || greatest == 0) continue;
    for (std::size_t k = 0; k < d; ++k) {
      out.first[k][w] = first[k] / variance;
      out.total[k][w] = total[k] / variance;
    }
  }
  return out;
}

Json list_json(const std::vector<std::optional<double>>& values) {
  Json list = Json::array();
  for (const auto& v : values) list.push_back(v ? rounded(std::round(*v * 1e3) / 1e3, 4) : Json());
  return list;
}

/// (parameter, record, window)
Json by_parameter(const std::vector<Windowed>& records, std::vector<std::vector<std::optional<double>>> Windowed::*what, std::size_t parameters) {
  Json all = Json::array();
  for (std::size_t k = 0; k < parameters; ++k) {
    Json one = Json::array();
    for (const auto& r : records) one.push_back(list_json((r.*what)[k]));
    all.push_back(std::move(one));
  }
  return all;
}

bool has_curves(const Study& study) { return study.sensitivity && study.sensitivity->time.size() > 1 && !study.sensitivity->total_order.empty(); }

/// The map and the curves of the indices over time.
Html curves_part() {
  return plot("sensitivity-map",
              "Total index of each parameter by gauge and time: 0, white, the parameter does nothing there; 1, dark, nothing varies without it. Hatched: the "
              "record "
              "varies less than a hundredth of its greatest standard deviation there, so that shares mean little.",
              "Map of the total index by parameter, gauge and time") +
         place("sensitivity-controls", "choice") + "\n" +
         plot("sensitivity-curves",
              "Indices over time of one gauge. Solid: total index; dashed: first order, the effect of the parameter alone. Where the two differ, parameters "
              "interact. Below: standard deviation of the record as the parameters vary.",
              "Curves of the indices over time at one gauge");
}

Html effects_part(const Study& study, const ReportInput& input) {
  const Table t = morris_table(study, input);
  if (t.empty()) return {};
  return heading("Elementary effects") +
         plot("sensitivity-morris",
              "Every disc is a gauge and a parameter. Horizontal axis: mean absolute change of the number over the range of the parameter. Vertical axis: "
              "standard deviation of the change between points of the bounds. Near the horizontal axis the effect is linear. Near the dashed line and above, "
              "it is nonlinear or depends on the other parameters.",
              "Elementary effects, mean against standard deviation") +
         folded(fmt::format("All {} effects", t.rows.size()), t);
}

}  // namespace

Html sensitivity_section(const Study& study, const ReportInput& input) {
  const Html again = command(input, "sensitivity");
  if (!study.sensitivity) return missing("No sensitivity has been computed (sensitivity.json).", fragment("Compute it with ", again, "."));
  Html s = result_paragraphs(study) + bounds_paragraph(study, input);
  if (has_curves(study)) {
    s += curves_part();
  } else if (study.sensitivity->time.empty()) {
    s += missing("sensitivity.nc is missing or belongs to another analysis, so nothing is drawn over time.", fragment("Make it with ", again, "."));
  }
  s += shown(total_order_table(study, "record")) + folded("First-order indices beside them", sensitivity_table(study));
  for (const char* name : {"value", "peak", "time_of_peak", "rms"}) s += folded("The same for the " + plain_quantity(name), total_order_table(study, name));
  return s + run_totals_part(study) + effects_part(study, input) + heading("How far to believe it") + trust_paragraph(study) +
         paragraph_of("note", "The table to hand in is sensitivity.csv: docs/how-to/hand_in_a_sensitivity.md.");
}

Json sensitivity_drawings(const Study& study, const ReportInput& input) {
  if (!study.sensitivity) return nullptr;
  const auto& s = *study.sensitivity;
  const auto unit = display_unit(input);
  const auto names = names_of(list_at(s.summary, "total_order"));
  Json out{{"parameters", names}, {"rows", Json::array()}, {"unit", unit.name},      {"time_unit", study.time.name},
           {"map", nullptr},      {"curves", nullptr},     {"morris", Json::array()}};
  if (has_curves(study)) {
    const std::size_t n = s.time.size();
    const std::size_t records = s.conditions.size() * s.sensors.size();
    const Windows coarse{n, std::min(n, map_windows)};
    const Windows fine{n, std::min(n, curve_windows)};
    std::vector<Windowed> map;
    std::vector<Windowed> curves;
    Json begin = Json::array();
    Json end = Json::array();
    Json time = Json::array();
    Json sd = Json::array();
    for (std::size_t r = 0; r < records; ++r) {
      out["rows"].push_back(s.conditions.size() > 1 ? s.sensors[r % s.sensors.size()] + ", " + s.conditions[r / s.sensors.size()] : s.sensors[r]);
      map.push_back(windowed(s, r, coarse));
      curves.push_back(windowed(s, r, fine));
      Json line = Json::array();
      for (const double x : curves.back().sd) line.push_back(rounded(unit.factor * x, 4));
      sd.push_back(std::move(line));
    }
    const double half = 0.5 * (s.time.back() - s.time.front()) / double(n - 1);  // a sample represents the interval around it
    for (std::size_t w = 0; w < coarse.count; ++w) {
      begin.push_back(rounded(study.time.factor * (s.time[coarse.begin(w)] - half), 6));
      end.push_back(rounded(study.time.factor * (s.time[coarse.begin(w + 1) - 1] + half), 6));
    }
    for (std::size_t w = 0; w < fine.count; ++w) time.push_back(rounded(0.5 * study.time.factor * (s.time[fine.begin(w)] + s.time[fine.begin(w + 1) - 1]), 6));
    const std::size_t d = s.parameters.size();
    out["parameters"] = s.parameters;
    out["map"] = {{"begin", begin}, {"end", end}, {"total", by_parameter(map, &Windowed::total, d)}};
    out["curves"] = {{"time", time}, {"first", by_parameter(curves, &Windowed::first, d)}, {"total", by_parameter(curves, &Windowed::total, d)}, {"sd", sd}};
  }
  for (const char* name : {"peak", "time_of_peak", "rms", "value", "dissipated_energy", "time_at_cutoff"}) {
    Json points = Json::array();
    auto effects = unit;
    for (const auto& q : list_at(s.summary, "quantities")) {
      if (text_at(q, "name") != name || (is_run_total(name) && text_at(q, "source").empty())) continue;  // a total without shares has no effects
      effects = effect_unit(q, unit, study.time);
      for (const auto& e : list_at(q, "morris"))
        if (const auto mu = number_at(e, "mu_star"), sigma = number_at(e, "sigma"); mu && sigma) {
          const auto k = std::size_t(std::find(names.begin(), names.end(), text_at(e, "parameter")) - names.begin());
          points.push_back(
              {{"record", record_label(q)}, {"parameter", k}, {"mu_star", rounded(effects.factor * *mu, 4)}, {"sigma", rounded(effects.factor * *sigma, 4)}});
        }
    }
    if (!points.empty()) out["morris"].push_back({{"title", plain_quantity(name)}, {"unit", effects.name}, {"points", std::move(points)}});
  }
  return out;
}

}  // namespace calomel
