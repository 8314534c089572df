#include "uq/diagnosis/plain_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

constexpr std::size_t numbers_told = 2;  ///< of an explanation, in a sentence

}  // namespace

std::string listed(const std::vector<std::string>& words, const char* last) {
  std::string s;
  for (std::size_t i = 0; i < words.size(); ++i) s += (i == 0 ? "" : i + 1 == words.size() ? fmt::format(" {} ", last) : ", ") + words[i];
  return s;
}

const ParameterGroup* group_of(std::span<const ParameterGroup> groups, const std::string& name) {
  const auto at = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.name == name; });
  return at == groups.end() ? nullptr : &*at;
}

ShownUnit shown_unit(const std::string& unit, double greatest) {
  if (unit == "m" && greatest > 0 && greatest < 1e-4) return {1e6, "µm"};
  if (unit == "m" && greatest < 0.1) return {1e3, "mm"};
  if (unit == "s" && greatest < 1e-3) return {1e6, "µs"};
  if (unit == "s" && greatest < 1) return {1e3, "ms"};
  if (unit == "Pa" && greatest >= 1e5) return {1e-6, "MPa"};
  if (unit == "Pa" && greatest >= 1e3) return {1e-3, "kPa"};
  if (unit == "Hz" && greatest >= 1e3) return {1e-3, "kHz"};
  if (unit == "kg/m^2") return {1, "kg/m²"};
  if (unit == "Pa s^2") return {1, "Pa s²"};
  return {1, unit};
}

std::string with_sd(double value, double sd, const std::string& unit) {
  const std::string tail = unit.empty() ? "" : ' ' + unit;
  if (!std::isfinite(sd) || sd <= 0) return fmt::format("{:.3g}{}", value, tail);
  const int decimals = int(std::ceil(1 - std::log10(sd) - 1e-9));
  if (decimals > 5 || sd >= 1e5) {
    const auto exponent = [](double x) { return int(std::floor(std::log10(x))); };
    const int digits = value == 0 ? 2 : std::clamp(exponent(std::abs(value)) - exponent(sd) + 1, 2, 9);
    return fmt::format("{:.{}e} ± {:.1e}{}", value, digits, sd, tail);
  }
  return fmt::format("{:.{}f} ± {:.{}f}{}", value, std::max(0, decimals), sd, std::max(0, decimals), tail);
}

std::string time_text(double t) {
  const auto unit = shown_unit("s", std::abs(t));
  return fmt::format("{:.{}f} {}", unit.factor * t, std::abs(unit.factor * t) < 9.95 ? 1 : 0, unit.name);
}

std::string plain_name(const Alternative& a, std::span<const ParameterGroup> groups) {
  std::vector<std::string> names;
  for (const auto& name : a.groups) {
    const auto* g = group_of(groups, name);
    const auto place = a.places.find(name);
    names.push_back((g && !g->plain.empty() ? g->plain : name) + (place != a.places.end() && !place->second.empty() ? " (" + place->second + ')' : ""));
  }
  if (!a.sensor.empty()) return "a fault of gauge " + a.sensor;
  if (names.empty()) return a.explanation.name;
  return names.size() > 1 ? names[0] + ", together with " + names[1] : names[0];
}

PlainNumber plain_number(const Alternative& a, const Estimate& n, std::span<const ParameterGroup> groups) {
  PlainNumber out;
  const std::string name = a.sensor.empty() ? n.name : n.name.substr(a.sensor.size() + 1);
  const auto first_of = [&](std::vector<AddedParameter> ParameterGroup::*numbers) -> const AddedParameter* {
    for (const auto& g : groups)
      for (const auto& p : g.*numbers)
        if (p.parameter.name == name) return &p;
    return nullptr;
  };
  const AddedParameter* added = first_of(&ParameterGroup::added);
  if (!added) {
    const AddedParameter* shape = first_of(&ParameterGroup::shapes);
    const auto unit = shown_unit(shape ? shape->unit : "", std::abs(n.mean));
    if (shape) out.doc = shape->doc;
    out.value = with_sd(unit.factor * n.mean, unit.factor * n.sd, unit.name);
    return out;
  }
  out.doc = added->doc;
  const double off = added->whole * added->parameter.nominal.value_or(0);
  out.deviations = n.sd > 0 ? std::abs(n.mean - off) / n.sd : 0;
  if (added->inverse) {
    const double sign = added->parameter.max > 0 ? 1 : -1, size = sign * n.mean;  // of a number that is none at minus infinity its inverse is below 0
    const auto unit = shown_unit(added->unit, size > 0 ? 1 / size : 0);
    out.off = "none";
    out.value = size > 2 * n.sd ? with_sd(unit.factor / n.mean, unit.factor * n.sd / (n.mean * n.mean), unit.name) : "none";
    if (out.value == "none" && size + 2 * n.sd > 0)
      out.value = fmt::format("{} {:.3g} {}", sign > 0 ? "above" : "below", sign * unit.factor / (size + 2 * n.sd), unit.name);
    return out;
  }
  const auto unit = shown_unit(added->unit, std::max({std::abs(n.mean), std::abs(n.sd), std::abs(off)}));
  out.value = n.told ? with_sd(unit.factor * n.mean, unit.factor * n.sd, unit.name) : "below the mercury's own (the records tell no more)";
  out.off = added->share_of.empty() ? fmt::format("{:.3g}{}{}", unit.factor * off, unit.name.empty() ? "" : " ", unit.name) : "the mercury's own";
  return out;
}

std::string plain_size(const Alternative& a, std::span<const ParameterGroup> groups) {
  std::vector<std::pair<PlainNumber, std::string>> all;
  std::vector<std::string> told;
  const auto of_many = [&](const Estimate& n) {
    const auto* g = group_of(groups, n.name.substr(0, n.name.find('.')));
    return g && g->linear;
  };
  std::vector<Estimate> many;
  for (const auto& n : a.numbers)
    if (of_many(n)) many.push_back(n);
  if (!many.empty()) {
    double squares = 0;
    for (const auto& n : many) squares += n.mean * n.mean;
    const auto key = [](const Estimate& n) { return n.name.substr(n.name.rfind('.') + 1); };
    told.push_back(fmt::format("{} to {} together {:.2g} (root of the sum of squares) in place of 0", key(many.front()), key(many.back()), std::sqrt(squares)));
  }
  for (const auto& n : a.numbers) {
    if (of_many(n)) continue;
    all.emplace_back(plain_number(a, n, groups), n.name.substr(n.name.rfind('.') + 1));
    if (!n.told) all.back().first.off.clear();
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& x, const auto& y) { return x.first.deviations > y.first.deviations; });
  for (std::size_t i = 0; i < std::min(all.size(), numbers_told); ++i)
    told.push_back(all[i].second + ' ' + all[i].first.value + (all[i].first.off.empty() ? "" : " in place of " + all[i].first.off));
  return listed(told);
}

std::string fitted_place(const std::string& mechanism, const std::string& place, const std::vector<Estimate>& numbers) {
  const auto number = [&](const char* key) { return std::find_if(numbers.begin(), numbers.end(), [&](const auto& n) { return n.name == mechanism + key; }); };
  const auto begin = number(".begin"), end = number(".end");
  if (begin == numbers.end() || end == numbers.end()) return place;
  return fmt::format("{}, {:.3g} to {:.3g} mm", place.substr(0, place.find(',')), 1e3 * begin->mean, 1e3 * end->mean);
}

}  // namespace calomel
