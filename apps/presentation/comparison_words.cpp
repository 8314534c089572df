#include "apps/presentation/comparison_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

/// "30 %", "99.4 %", "more than 99.9 %"
std::string share_text(double share) {
  return share > 0.999 ? "more than 99.9 %" : share > Comparison::outside_share ? fmt::format("{:.1f} %", 100 * share) : fmt::format("{:.0f} %", 100 * share);
}

/// The parameters in which a method lies far from MAP: ", density (-2.5 sd, -1.8 %)".
std::string notable(const Comparison& c, const std::string& method) {
  std::string s;
  for (const auto& p : c.pairs) {
    if (!(p.first == method && p.second == "map") && !(p.first == "map" && p.second == method)) continue;
    const double sign = p.second == "map" ? -1 : 1;
    for (std::size_t k = 0; k < p.differences.size(); ++k) {
      const auto& d = p.differences[k];
      if (!d.in_map_sd || std::abs(*d.in_map_sd) <= Comparison::notable_sds) continue;
      const auto& values = c.parameters[k].values;
      const auto map = std::size_t(std::find(c.methods.begin(), c.methods.end(), "map") - c.methods.begin());
      s += fmt::format(", {} {:+.1f} sd{}", d.name, sign * *d.in_map_sd,
                       *values[map] != 0 ? fmt::format(" ({:+.1f} %)", sign * 100 * *d.absolute / *values[map]) : "");
    }
  }
  return s;
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

std::string cell_text(const std::optional<double>& x, const std::string& format) { return x ? fmt::format(fmt::runtime(format), *x) : "-"; }

std::string table_text(const Comparison& c, const std::string& title, const std::vector<ComparedRow>& rows, const std::string& format, bool with_sd) {
  std::vector<std::vector<std::string>> lines{{title, "nominal"}};
  for (const auto& m : c.methods) lines[0].push_back(method_label(m));
  const bool sds = with_sd && std::any_of(rows.begin(), rows.end(), [](const auto& r) { return r.map_sd.has_value(); });
  if (sds) lines[0].push_back("sd by MAP");
  for (const auto& r : rows) {
    lines.push_back({r.name, cell_text(r.nominal, format)});
    for (const auto& v : r.values) lines.back().push_back(cell_text(v, format));
    if (sds) lines.back().push_back(cell_text(r.map_sd, "{:.3g}"));
  }
  return aligned(lines);
}

}  // namespace

std::string comparison_sentence(const Comparison& c) {
  if (c.in_posterior.empty()) return "Whether the methods agree is not known without MAP's covariance; the differences in percent are listed.";
  std::string s;
  for (const auto& p : c.in_posterior) {
    s += (s.empty() ? "" : "; ") + method_label(p.method);
    if (!p.distance)
      s += "'s place in the posterior is not known";
    else if (p.outside())
      s += fmt::format(" lies outside the posterior: {:.1f} deviations from its mode, {} of it nearer{}", *p.distance, share_text(*p.share_nearer),
                       notable(c, p.method));
    else
      s += fmt::format(" lies within the posterior ({:.1f} deviations from its mode, {} of it nearer)", *p.distance, share_text(*p.share_nearer));
  }
  return s + '.';
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
      lines.back().push_back(cell_text(p.differences[r].percent, "{:+.2f} %") +
                             (p.differences[r].in_map_sd ? fmt::format(" = {:+.2f} sd", *p.differences[r].in_map_sd) : ""));
  }
  s += '\n' + aligned(lines);
  if (!c.in_posterior.empty()) {
    lines = {{"in the posterior", "deviations from its mode", "share nearer [%]"}};
    for (const auto& p : c.in_posterior)
      lines.push_back({method_label(p.method), cell_text(p.distance, "{:.2f}"), p.share_nearer ? fmt::format("{:.1f}", 100 * *p.share_nearer) : "-"});
    s += '\n' + aligned(lines);
  }
  return s + "  " + comparison_sentence(c);
}

}  // namespace calomel
