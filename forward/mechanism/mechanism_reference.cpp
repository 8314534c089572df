#include "forward/mechanism/mechanism_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

std::string off_text(const MechanismKey& key) {
  const std::string off = std::isfinite(key.off) ? number_text(key.off) : "none";
  return key.off_at.empty() ? off : "`" + key.off_at + "` (" + off + ")";
}

std::string prior_text(const MechanismKey& k) {
  if (!k.shows_below.empty()) return "uniform, as a share of `" + k.shows_below + '`';
  if (!std::isfinite(k.off)) return "uniform in the inverse";
  return k.log_uniform ? "half-Cauchy about the geometric middle" : "normal";
}

/// The text after the name of a key in its row.
std::string cells(const MechanismKey& k) {
  if (!k.choices.empty()) return fmt::format(" |  | `\"{}\"` (any) |  |  | {} | {} |\n", k.choices.at(std::size_t(k.off)), join(k.choices), k.doc);
  return fmt::format(" | {} | {} | {} | {} | {} | {} |\n", k.unit, off_text(k) + (k.decides ? "" : " (any)"), number_text(k.low), number_text(k.high),
                     prior_text(k), k.doc);
}

/// A name without the number that it ends with: "left_" of left_1.
std::string stem(const std::string& name) { return name.substr(0, name.find_last_not_of("0123456789") + 1); }

}  // namespace

std::string mechanism_rows(const std::vector<MechanismKey>& keys) {
  std::string s = "\n\n| key | unit | off | low | high | prior | meaning |\n|---|---|---|---|---|---|---|\n";
  for (auto k = keys.begin(); k != keys.end();) {
    const auto end = std::find_if(k + 1, keys.end(), [&](const auto& other) { return stem(other.name) != stem(k->name) || cells(other) != cells(*k); });
    s += fmt::format("| `{}`{}", k->name, end - k > 1 ? fmt::format(" to `{}`", (end - 1)->name) : "") + cells(*k);
    k = end;
  }
  return s;
}

}  // namespace calomel
