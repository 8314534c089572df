#include "apps/report/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/html.hpp"
#include "apps/report/sensitivity_totals.hpp"
#include "apps/report/tables.hpp"
#include "apps/report/traces.hpp"

namespace calomel {

namespace {

constexpr std::size_t map_windows = 100, curve_windows = 300;
constexpr double hardly_varies = 0.01;   ///< of a record's greatest standard deviation
constexpr double negligible = 0.02;      ///< total index whose whole interval lies below it
constexpr double believable = 0.9;       ///< left-out R2 of a polynomial that may check a surrogate
constexpr double poor_surrogate = 0.95;  ///< R2 below which indices of a surrogate are doubted

const Json& summary_of(const Study& study) {
  static const Json nothing;
  return study.sensitivity ? study.sensitivity->summary : nothing;
}

std::string record_label(const Json& quantity) {
  const std::string sensor = text_at(quantity, "sensor"), condition = text_at(quantity, "condition");
  if (sensor.empty() && is_run_total(text_at(quantity, "name"))) return condition.empty() ? "the run" : condition;
  if (sensor.empty()) return "all records";
  return condition.empty() ? sensor : sensor + ", " + condition;
}

std::string plain_quantity(const std::string& name) {
  if (is_run_total(name)) return plain_run_total(name);
  return name == "peak" ? "greatest absolute value" : name == "time_of_peak" ? "time of the greatest value" : name == "rms" ? "root mean square" : name;
}

/// The unit in which effects on a quantity are shown, and what a number of its own unit is multiplied by.
DisplayUnit shown_in(const Json& quantity, const DisplayUnit& of_records, const DisplayUnit& of_times) {
  const std::string unit = text_at(quantity, "unit");
  return unit == "s" ? of_times : is_run_total(text_at(quantity, "name")) ? DisplayUnit{unit, 1} : of_records;
}

std::vector<std::string> names_of(const Json& indices) {
  std::vector<std::string> names;
  for (const auto& i : indices) names.push_back(text_at(i, "parameter"));
  return names;
}

/// "0.38 (0.34 to 0.42)"
std::string with_interval(const Json& index, int decimals = 2) {
  const auto value = number_at(index, "value"), low = number_at(index, "low"), high = number_at(index, "high");
  if (!value) return "\u2013";
  std::string s = fixed_html(*value, decimals);
  if (low && high) s += " (" + fixed_html(*low, decimals) + " to " + fixed_html(*high, decimals) + ")";
  return s;
}

std::string percent(double x) { return fixed_html(100 * x, std::abs(x) < 0.0995 ? 1 : 0) + "\u00a0%"; }

std::string interval_percent(const Json& index) {
  const auto low = number_at(index, "low"), high = number_at(index, "high");
  return low && high ? " (" + percent(*low) + " to " + percent(*high) + ")" : "";
}

/// Indices of all records together, the greatest total first.
struct Whole {
  std::string parameter;
  const Json *first = nullptr, *total = nullptr;
  double share = 0, alone = 0;
};
std::vector<Whole> whole_of(const Study& study) {
  std::vector<Whole> list;
  const Json &first = list_at(summary_of(study), "first_order"), &total = list_at(summary_of(study), "total_order");
  for (std::size_t k = 0; k < total.size() && k < first.size(); ++k)
    if (const auto t = number_at(total[k], "value"))
      list.push_back({text_at(total[k], "parameter"), &first[k], &total[k], *t, number_at(first[k], "value").value_or(0)});
  std::stable_sort(list.begin(), list.end(), [](const Whole& a, const Whole& b) { return a.share > b.share; });
  return list;
}

/// Which parameter the records hang on, what parameters do together, which hardly matter.
std::string what_came_out(const Study& study) {
  const auto list = whole_of(study);
  if (list.empty()) return missing("sensitivity.json holds no index of all records, for nothing varies.");
  double alone = 0;
  for (const auto& w : list) alone += w.alone;
  std::string s = "<p class=\"outcome\">Of all the variation of the records, <strong>" + escape_html(list[0].parameter) + "</strong> has a part in " +
                  percent(list[0].share) + interval_percent(*list[0].total);
  for (std::size_t k = 1; k < list.size(); ++k)
    s += (k + 1 == list.size() ? " and " : ", ") + escape_html(list[k].parameter) + " in " + percent(list[k].share) + interval_percent(*list[k].total);
  s += ".</p>\n<p>These are total indices: what a parameter does alone and together with others, so they may add up to more than 100\u00a0%. In brackets: "
       "95\u00a0% intervals. Alone, the parameters make " +
       percent(alone) + " of the variation" + (alone < 0.98 ? "; the rest is what they do together.</p>\n" : ", so they hardly act upon one another.</p>\n");
  std::string weak, tied;
  for (const auto& w : list)
    if (const auto high = number_at(*w.total, "high"); high && *high < negligible) weak += (weak.empty() ? "" : ", ") + w.parameter;
  if (!weak.empty())
    s += "<p>" + escape_html(weak) + (weak.find(',') == std::string::npos ? " hardly matters" : " hardly matter") +
         " within these bounds: these records say next to nothing of " + (weak.find(',') == std::string::npos ? "it" : "them") + ".</p>\n";
  for (std::size_t k = 0; k + 1 < list.size(); ++k) {
    const auto low = number_at(*list[k].total, "low"), high = number_at(*list[k + 1].total, "high");
    if (low && high && *high > *low && list[k].share >= negligible) tied += (tied.empty() ? "" : "; ") + list[k].parameter + " and " + list[k + 1].parameter;
  }
  if (!tied.empty())
    s += "<p>Their intervals overlap, so which of them matters more is not settled: " + escape_html(tied) +
         ". More <code>sensitivity.samples</code> narrow the intervals.</p>\n";
  return s;
}

std::string bounds_sentence(const Study& study, const ReportInput& input) {
  std::string bounds;
  const Json& own = part_at(part_at(part_at(summary_of(study), "provenance"), "options"), "parameter");  // those that it was made with
  for (const auto& p : input.parameters) {
    const std::string unit = parameter_unit(input, p.name);
    const Json& then = part_at(own, p.name);
    bounds += (bounds.empty() ? "" : "; ") + escape_html(p.name) + " " + number_html(number_at(then, "min").value_or(p.min), 5) + " to " +
              number_html(number_at(then, "max").value_or(p.max), 5) + (unit.empty() ? "" : "\u00a0" + escape_html(unit));
  }
  const bool by_prior = text_at(summary_of(study), "measure") == "prior";
  return "<p>The parameters varied " + std::string(by_prior ? "by their priors within their bounds" : "evenly between their bounds") +
         (bounds.empty() ? "" : " (" + bounds + ")") +
         ". A share is a statement about these bounds as much as about the model: a parameter whose bounds are wider has more of it.</p>\n";
}

/// How far the numbers are to be believed: the surrogate's errors, the polynomial's own answer, failures.
std::string trust_paragraph(const Study& study) {
  const Json& s = summary_of(study);
  std::string text;
  if (text_at(s, "source").find("surrogate") != std::string::npos) {
    text = "The indices are those of the surrogate";
    const Json& trained = study.train ? list_at(*study.train, "surrogates") : Json();
    if (const auto r2 = trained.empty() ? std::nullopt : number_at(trained[0], "r2")) {
      text += ", whose R\u00b2 on runs that it was not trained on is " + fixed_html(*r2, 3);
      text += *r2 < poor_surrogate ? ": <strong>too poor for shares that are to be relied on; make the campaign larger</strong>" : "";
    }
    text += ".";
  } else {
    text = "The indices are those of the model itself.";
  }
  std::size_t checked = 0, numbers = 0;
  double farthest = 0;
  for (const auto& q : list_at(s, "quantities")) {
    const Json& p = part_at(q, "polynomial");
    if (!p.is_object() || is_run_total(text_at(q, "name"))) continue;  // of a total it is what the indices are of, and no check
    ++numbers;
    if (number_at(p, "left_out_r2").value_or(0) < believable) continue;
    ++checked;
    const Json &own = list_at(q, "total_order"), &other = list_at(p, "total_order");
    for (std::size_t k = 0; k < own.size() && k < other.size(); ++k)
      farthest = std::max(farthest, std::abs(number_at(own[k], "value").value_or(0) - number_at(other[k], "value").value_or(0)));
  }
  if (numbers > 0)
    text += checked == 0
                ? fmt::format(" A polynomial fitted to the runs themselves follows none of the {} numbers (left-out R\u00b2 below 0.9), so it is no check.",
                              numbers)
                : fmt::format(
                      " A polynomial fitted to the runs themselves follows {} of the {} numbers (left-out R\u00b2 above 0.9); there its total indices differ "
                      "from these by {} at most.",
                      checked, numbers, fixed_html(farthest, 2));
  const auto evaluations = number_at(s, "evaluations"), failed = number_at(s, "failed");
  if (evaluations)
    text += " It took " + number_html(*evaluations, 7) + " evaluations" +
            (failed && *failed > 0 ? ", of which " + number_html(*failed, 6) + " failed and were left out" : "") + ".";
  return "<p>" + text + "</p>\n";
}

/// Windows of equal count.
struct Windows {
  std::size_t times, count;
  [[nodiscard]] std::size_t begin(std::size_t w) const { return w * times / count; }
};

/// Of one record: indices of the windows (parameter, window), null where it hardly varies; and its sd.
struct Windowed {
  std::vector<std::vector<std::optional<double>>> first, total;
  std::vector<double> sd;
};
Windowed windowed(const SensitivityArtefacts& s, std::size_t record, const Windows& windows) {
  const std::size_t d = s.parameters.size(), n = s.time.size();
  double greatest = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (const double x = s.sd[record * n + i]; std::isfinite(x)) greatest = std::max(greatest, x);
  Windowed out{.first = std::vector(d, std::vector<std::optional<double>>(windows.count)), .total = {}, .sd = {}};
  out.total = out.first;
  for (std::size_t w = 0; w < windows.count; ++w) {
    double variance = 0;
    std::vector<double> first(d, 0.0), total(d, 0.0);
    for (std::size_t i = windows.begin(w); i < windows.begin(w + 1); ++i) {
      const double v = s.sd[record * n + i] * s.sd[record * n + i];
      if (!std::isfinite(v) || !(v > 0)) continue;
      variance += v;
      for (std::size_t k = 0; k < d; ++k) {
        const double a = s.first_order[(record * n + i) * d + k], b = s.total_order[(record * n + i) * d + k];
        first[k] += std::isfinite(a) ? v * a : 0, total[k] += std::isfinite(b) ? v * b : 0;
      }
    }
    out.sd.push_back(std::sqrt(variance / double(windows.begin(w + 1) - windows.begin(w))));
    if (!(out.sd.back() >= hardly_varies * greatest) || greatest == 0) continue;
    for (std::size_t k = 0; k < d; ++k) out.first[k][w] = first[k] / variance, out.total[k][w] = total[k] / variance;
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

}  // namespace

Table sensitivity_table(const Study& study) {
  Table t{.id = "sensitivity", .caption = "First-order and total indices of every record with 95 % intervals, over the whole record."};
  t.columns = {{"record", "Record", 4, true}, {"parameter", "Parameter", 4, true},    {"first_order", "Alone", -3}, {"first_low", "from", -3},
               {"first_high", "to", -3},      {"total_order", "With the others", -3}, {"total_low", "from", -3},    {"total_high", "to", -3}};
  const Json& quantities = list_at(summary_of(study), "quantities");
  const auto add = [&](const Json& q) {
    const Json &first = list_at(q, "first_order"), &total = list_at(q, "total_order");
    for (std::size_t k = 0; k < first.size() && k < total.size(); ++k)
      t.rows.push_back({record_label(q), text_at(first[k], "parameter"), number_at(first[k], "value"), number_at(first[k], "low"), number_at(first[k], "high"),
                        number_at(total[k], "value"), number_at(total[k], "low"), number_at(total[k], "high")});
  };
  for (const bool all : {true, false})
    for (const auto& q : quantities)
      if ((text_at(q, "name") == "record" || text_at(q, "name") == "value") && text_at(q, "sensor").empty() == all) add(q);
  return t;
}

Table total_order_table(const Study& study, const std::string& quantity) {
  const bool record = quantity == "record";
  Table t{.id = "sensitivity_" + quantity,
          .caption = (record ? std::string("Total index of each parameter over the whole record")
                             : "Total index of each parameter for the " + plain_quantity(quantity)) +
                     ", with 95 % intervals; bold: the greatest of the row."};
  t.columns = {{"record", "Record", 4, true}};
  for (const auto& name : names_of(list_at(summary_of(study), "total_order"))) t.columns.push_back({name, name, 4, true});
  for (const auto& q : list_at(summary_of(study), "quantities")) {
    if (text_at(q, "name") != quantity) continue;
    const Json& total = list_at(q, "total_order");
    double greatest = -1;
    for (const auto& i : total) greatest = std::max(greatest, number_at(i, "value").value_or(-1));
    std::vector<Cell> row{record_label(q)};
    for (const auto& i : total) row.emplace_back(with_interval(i), number_at(i, "value") == std::optional(greatest));
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table morris_table(const Study& study, const ReportInput& input) {
  Table t{.id = "sensitivity_morris", .caption = "Elementary effects: the change of a number as a parameter goes through its whole range."};
  t.columns = {{"quantity", "Number", 4, true},
               {"record", "Record", 4, true},
               {"unit", "Unit", 4, true},
               {"parameter", "Parameter", 4, true},
               {"mu", "Mean", 3},
               {"mu_star", "Mean of the absolute values", 3},
               {"mu_star_se", "its standard error", 2},
               {"sigma", "Standard deviation", 3}};
  const auto unit = display_unit(input);
  for (const auto& q : list_at(summary_of(study), "quantities")) {
    const auto shown = shown_in(q, unit, study.time);
    for (const auto& e : list_at(q, "morris")) {
      std::vector<Cell> row{plain_quantity(text_at(q, "name")), record_label(q), shown.name, text_at(e, "parameter")};
      for (const char* key : {"mu", "mu_star", "mu_star_se", "sigma"}) {
        const auto x = number_at(e, key);
        row.emplace_back(x ? std::optional(shown.factor * *x) : std::nullopt);
      }
      t.rows.push_back(std::move(row));
    }
  }
  return t;
}

std::string sensitivity_section(const Study& study, const ReportInput& input) {
  const std::string again = command(input, "sensitivity");
  if (!study.sensitivity) return missing("No sensitivity has been computed (sensitivity.json).", "Compute it with " + again + ".");
  std::string s = what_came_out(study) + bounds_sentence(study, input);
  if (has_curves(study)) {
    s += plot("sensitivity-map",
              "Total index of each parameter by gauge and time: 0, white, the parameter does nothing there; 1, dark, nothing varies without it. Hatched: the "
              "record varies less than a hundredth of its greatest standard deviation there, so that shares mean little.",
              "Map of the total index by parameter, gauge and time");
    s += "<div id=\"sensitivity-controls\" class=\"choice\"></div>\n";
    s += plot("sensitivity-curves",
              "Indices over time of one gauge. Solid: total index; dashed: first order, what the parameter does alone. Where the two part, parameters act "
              "together. Below: standard deviation of the record as the parameters vary.",
              "Curves of the indices over time at one gauge");
  } else if (study.sensitivity->time.empty()) {
    s += missing("sensitivity.nc is missing or belongs to another analysis, so nothing is drawn over time.", "Make it with " + again + ".");
  }
  if (const Table t = total_order_table(study, "record"); !t.empty()) s += t.html();
  s += folded("First-order indices beside them", sensitivity_table(study));
  for (const char* name : {"value", "peak", "time_of_peak", "rms"}) {
    const Table t = total_order_table(study, name);
    s += folded("The same for the " + plain_quantity(name), t);
  }
  s += run_totals_part(study);
  if (const Table t = morris_table(study, input); !t.empty()) {
    s += "<h3>Elementary effects</h3>\n";
    s += plot("sensitivity-morris",
              "Every disc is a gauge and a parameter. To the right: the parameter moves the number much (mean absolute change over its range). Upwards: how "
              "much depends on where in the bounds one stands (standard deviation of the change). Near the axis the effect is a straight "
              "line; about the dashed line and above it bends, or depends on the other parameters.",
              "Elementary effects, mean against standard deviation");
    s += folded(fmt::format("All {} effects", t.rows.size()), t);
  }
  return s + "<h3>How far to believe it</h3>\n" + trust_paragraph(study) +
         "<p class=\"note\">The table to hand in is sensitivity.csv: docs/how-to/hand_in_a_sensitivity.md.</p>\n";
}

Json sensitivity_drawings(const Study& study, const ReportInput& input) {
  if (!study.sensitivity) return nullptr;
  const auto& s = *study.sensitivity;
  const auto unit = display_unit(input);
  const auto names = names_of(list_at(s.summary, "total_order"));
  Json out{{"parameters", names}, {"rows", Json::array()}, {"unit", unit.name},      {"time_unit", study.time.name},
           {"map", nullptr},      {"curves", nullptr},     {"morris", Json::array()}};
  if (has_curves(study)) {
    const std::size_t n = s.time.size(), records = s.conditions.size() * s.sensors.size();
    const Windows coarse{n, std::min(n, map_windows)}, fine{n, std::min(n, curve_windows)};
    std::vector<Windowed> map, curves;
    Json begin = Json::array(), end = Json::array(), time = Json::array(), sd = Json::array();
    for (std::size_t r = 0; r < records; ++r) {
      out["rows"].push_back(s.conditions.size() > 1 ? s.sensors[r % s.sensors.size()] + ", " + s.conditions[r / s.sensors.size()] : s.sensors[r]);
      map.push_back(windowed(s, r, coarse)), curves.push_back(windowed(s, r, fine));
      Json line = Json::array();
      for (const double x : curves.back().sd) line.push_back(rounded(unit.factor * x, 4));
      sd.push_back(std::move(line));
    }
    const double half = 0.5 * (s.time.back() - s.time.front()) / double(n - 1);  // a sample stands for the time about it
    for (std::size_t w = 0; w < coarse.count; ++w)
      begin.push_back(rounded(study.time.factor * (s.time[coarse.begin(w)] - half), 6)),
          end.push_back(rounded(study.time.factor * (s.time[coarse.begin(w + 1) - 1] + half), 6));
    for (std::size_t w = 0; w < fine.count; ++w) time.push_back(rounded(0.5 * study.time.factor * (s.time[fine.begin(w)] + s.time[fine.begin(w + 1) - 1]), 6));
    const std::size_t d = s.parameters.size();
    out["parameters"] = s.parameters;
    out["map"] = {{"begin", begin}, {"end", end}, {"total", by_parameter(map, &Windowed::total, d)}};
    out["curves"] = {{"time", time}, {"first", by_parameter(curves, &Windowed::first, d)}, {"total", by_parameter(curves, &Windowed::total, d)}, {"sd", sd}};
  }
  for (const char* name : {"peak", "time_of_peak", "rms", "value", "dissipated_energy", "time_at_cutoff"}) {
    Json points = Json::array();
    auto shown = unit;
    for (const auto& q : list_at(s.summary, "quantities")) {
      if (text_at(q, "name") != name || (is_run_total(name) && text_at(q, "source").empty())) continue;  // a total without shares has no effects to look at
      shown = shown_in(q, unit, study.time);
      for (const auto& e : list_at(q, "morris"))
        if (const auto mu = number_at(e, "mu_star"), sigma = number_at(e, "sigma"); mu && sigma) {
          const auto k = std::size_t(std::find(names.begin(), names.end(), text_at(e, "parameter")) - names.begin());
          points.push_back(
              {{"record", record_label(q)}, {"parameter", k}, {"mu_star", rounded(shown.factor * *mu, 4)}, {"sigma", rounded(shown.factor * *sigma, 4)}});
        }
    }
    if (!points.empty()) out["morris"].push_back({{"title", plain_quantity(name)}, {"unit", shown.name}, {"points", std::move(points)}});
  }
  return out;
}

}  // namespace calomel
