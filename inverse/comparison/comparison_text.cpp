#include <fmt/format.h>

#include <algorithm>

#include "base/provenance.hpp"
#include "inverse/comparison/comparison.hpp"

namespace calomel {

namespace {

Json json_of(const std::optional<double>& x) { return x ? Json(*x) : Json(); }

Json rows_json(const Comparison& c, const std::vector<ComparedRow>& rows, bool with_sd) {
  Json all = Json::array();
  for (const auto& r : rows) {
    Json j{{"name", r.name}, {"nominal", json_of(r.nominal)}};
    for (std::size_t m = 0; m < c.methods.size(); ++m) j[c.methods[m]] = json_of(r.values[m]);
    if (with_sd) j["map_sd"] = json_of(r.map_sd);
    all.push_back(std::move(j));
  }
  return all;
}

/// Lines of equal columns, the first set to the left.
std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (const auto& line : lines)
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (i == widths.size()) widths.push_back(0);
      widths[i] = std::max(widths[i], line[i].size());
    }
  std::string s;
  for (const auto& line : lines) {
    s += "  ";
    for (std::size_t i = 0; i < line.size(); ++i) s += i == 0 ? fmt::format("{:<{}}", line[i], widths[i]) : fmt::format("  {:>{}}", line[i], widths[i]);
    while (s.ends_with(' ')) s.pop_back();
    s += '\n';
  }
  return s;
}

std::string text(const std::optional<double>& x, const std::string& format) { return x ? fmt::format(fmt::runtime(format), *x) : "-"; }

std::string table_text(const Comparison& c, const std::string& title, const std::vector<ComparedRow>& rows, const std::string& format, bool with_sd) {
  std::vector<std::vector<std::string>> lines{{title, "nominal"}};
  for (const auto& m : c.methods) lines[0].push_back(method_label(m));
  const bool sds = with_sd && std::any_of(rows.begin(), rows.end(), [](const auto& r) { return r.map_sd.has_value(); });
  if (sds) lines[0].push_back("sd by MAP");
  for (const auto& r : rows) {
    lines.push_back({r.name, text(r.nominal, format)});
    for (const auto& v : r.values) lines.back().push_back(text(v, format));
    if (sds) lines.back().push_back(text(r.map_sd, "{:.3g}"));
  }
  return aligned(lines);
}

}  // namespace

Json comparison_json(const Comparison& c, const Provenance& provenance) {
  Json j;
  j["methods"] = c.methods;
  j["parameters"] = rows_json(c, c.parameters, true);
  j["accuracy"] = rows_json(c, c.accuracy, false);
  j["mae"] = rows_json(c, c.mae, false);
  j["mae_unit"] = c.mae_unit;
  j["scores_on"] = c.scores_on;
  j["agreement"] = Json::array();
  for (const auto& p : c.pairs) {
    Json differences = Json::array();
    for (const auto& d : p.differences)
      differences.push_back({{"name", d.name}, {"absolute", json_of(d.absolute)}, {"percent", json_of(d.percent)}, {"in_map_sd", json_of(d.in_map_sd)}});
    j["agreement"].push_back({{"first", p.first}, {"second", p.second}, {"differences", differences}, {"largest_in_map_sd", json_of(p.largest_in_map_sd)}});
  }
  j["in_posterior"] = Json::array();
  for (const auto& p : c.in_posterior)
    j["in_posterior"].push_back({{"method", p.method}, {"distance", json_of(p.distance)}, {"share_nearer", json_of(p.share_nearer)}});
  j["agree"] = c.agree;
  j["sentence"] = c.sentence;
  j["effort"] = Json::array();
  for (const auto& e : c.effort)
    j["effort"].push_back({{"method", e.method},
                           {"evaluations", json_of(e.evaluations)},
                           {"evaluations_per_second", json_of(e.evaluations_per_second())},
                           {"model_runs", json_of(e.model_runs)},
                           {"search_s", json_of(e.search_s)},
                           {"model_s", json_of(e.model_s)}});
  j["provenance"] = provenance.json();
  return j;
}

std::string comparison_text(const Comparison& c) {
  std::string s = table_text(c, "parameter", c.parameters, "{:.6g}", true);
  s += '\n' + table_text(c, "accuracy [%]", c.accuracy, "{:.1f}", false);
  s += '\n' + table_text(c, "mae [" + c.mae_unit + "]", c.mae, "{:.2f}", false);
  if (!c.scores_on.empty()) s += "  (accuracy and mae on " + c.scores_on + ")\n";
  std::vector<std::vector<std::string>> lines{{"difference"}};
  for (const auto& p : c.pairs) lines[0].push_back(method_label(p.second) + " - " + method_label(p.first));
  for (std::size_t r = 0; r < c.parameters.size(); ++r) {
    lines.push_back({c.parameters[r].name});
    for (const auto& p : c.pairs)
      lines.back().push_back(text(p.differences[r].percent, "{:+.2f} %") +
                             (p.differences[r].in_map_sd ? fmt::format(" = {:+.2f} sd", *p.differences[r].in_map_sd) : ""));
  }
  s += '\n' + aligned(lines);
  if (!c.in_posterior.empty()) {
    lines = {{"in the posterior", "deviations from its mode", "share nearer [%]"}};
    for (const auto& p : c.in_posterior)
      lines.push_back({method_label(p.method), text(p.distance, "{:.2f}"), p.share_nearer ? fmt::format("{:.1f}", 100 * *p.share_nearer) : "-"});
    s += '\n' + aligned(lines);
  }
  return s + "  " + c.sentence;
}

}  // namespace calomel
