#include "apps/presentation/diagnosis_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

constexpr std::size_t numbers_shown = 2;  ///< of an explanation, in a sentence

}  // namespace

std::string capital(std::string text) {
  if (!text.empty()) text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string sentence(const std::string& text) { return capital(text) + (text.ends_with('.') ? "" : "."); }

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

std::string percent(double share) { return fmt::format("{:.{}f} %", 100 * share, 100 * share < 9.95 ? 1 : 0); }

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
  if (!a.sensor.empty()) return "a fault of gauge " + a.sensor;
  const auto places = fitted_places(a);
  std::vector<std::string> names;
  for (const auto& name : a.groups) {
    const auto* g = group_of(groups, name);
    const auto place = places.find(name);
    names.push_back((g && !g->plain.empty() ? g->plain : name) + (place != places.end() && !place->second.empty() ? " (" + place->second + ')' : ""));
  }
  if (names.empty()) return a.explanation.name;
  return names.size() > 1 ? names[0] + ", together with " + names[1] : names[0];
}

namespace {

/// A number that the fit has as its inverse: none where that is 0.
PlainNumber inverse_number(const AddedParameter& added, const Estimate& n) {
  const double sign = added.parameter.max > 0 ? 1 : -1, size = sign * n.mean;  // the inverse of a number that is none at minus infinity is below 0
  const auto unit = shown_unit(added.unit, size > 0 ? 1 / size : 0);
  PlainNumber out{.value = "none", .off = "none"};
  if (size > 2 * n.sd)
    out.value = with_sd(unit.factor / n.mean, unit.factor * n.sd / (n.mean * n.mean), unit.name);
  else if (size + 2 * n.sd > 0)
    out.value = fmt::format("{} {:.3g} {}", sign > 0 ? "above" : "below", sign * unit.factor / (size + 2 * n.sd), unit.name);
  return out;
}

}  // namespace

PlainNumber plain_number(const Alternative& a, const Estimate& n, std::span<const ParameterGroup> groups) {
  const AddedParameter* added = added_parameter_of(a, n, groups);
  if (!added) {
    const AddedParameter* shape = shape_of(a, n, groups);
    const auto unit = shown_unit(shape ? shape->unit : "", std::abs(n.mean));
    return {.value = with_sd(unit.factor * n.mean, unit.factor * n.sd, unit.name), .off = {}};
  }
  if (added->inverse) return inverse_number(*added, n);
  const double off = added->whole * added->parameter.nominal.value_or(0);
  const auto unit = shown_unit(added->unit, std::max({std::abs(n.mean), std::abs(n.sd), std::abs(off)}));
  PlainNumber out;
  out.value = n.from_records ? with_sd(unit.factor * n.mean, unit.factor * n.sd, unit.name) : "below the mercury's own (the records do not narrow it)";
  out.off = added->share_of.empty() ? fmt::format("{:.3g}{}{}", unit.factor * off, unit.name.empty() ? "" : " ", unit.name) : "the mercury's own";
  return out;
}

namespace {

/// The last part of a number's dotted name.
std::string key_of(const Estimate& n) { return n.name.substr(n.name.rfind('.') + 1); }

/// Many small numbers as one: the root of the sum of their squares.
std::string size_together(const std::vector<Estimate>& many) {
  double squares = 0;
  for (const auto& n : many) squares += n.mean * n.mean;
  return fmt::format("{} to {} together {:.2g} (root of the sum of squares) in place of 0", key_of(many.front()), key_of(many.back()), std::sqrt(squares));
}

}  // namespace

std::string plain_size(const Alternative& a, std::span<const ParameterGroup> groups) {
  std::vector<Estimate> many, single;
  for (const auto& n : a.numbers) {
    const auto* g = group_of(groups, n.name.substr(0, n.name.find('.')));
    (g && g->linear ? many : single).push_back(n);
  }
  std::vector<std::string> parts;
  if (!many.empty()) parts.push_back(size_together(many));
  std::stable_sort(single.begin(), single.end(),
                   [&](const auto& x, const auto& y) { return deviations_from_off(a, x, groups) > deviations_from_off(a, y, groups); });
  for (std::size_t i = 0; i < std::min(single.size(), numbers_shown); ++i) {
    const PlainNumber plain = plain_number(a, single[i], groups);
    const bool with_off = single[i].from_records && !plain.off.empty();
    parts.push_back(key_of(single[i]) + ' ' + plain.value + (with_off ? " in place of " + plain.off : ""));
  }
  return listed(parts);
}

std::map<std::string, std::string> fitted_places(const Alternative& a) {
  auto places = a.places;
  for (auto& [group, place] : places) place = fitted_place(group, place, a.numbers);
  return places;
}

std::string fitted_place(const std::string& mechanism, const std::string& place, const std::vector<Estimate>& numbers) {
  const auto number = [&](const char* key) { return std::find_if(numbers.begin(), numbers.end(), [&](const auto& n) { return n.name == mechanism + key; }); };
  const auto begin = number(".begin"), end = number(".end");
  if (begin == numbers.end() || end == numbers.end()) return place;
  return fmt::format("{}, {:.3g} to {:.3g} mm", place.substr(0, place.find(',')), 1e3 * begin->mean, 1e3 * end->mean);
}

std::string plain_term(const MissingTerm& t) {
  const std::string sign = t.value < 0 ? "" : "+";
  if (t.unit.empty()) return sign + with_sd(100 * t.value, 100 * t.sd, "%");
  const auto unit = shown_unit(t.unit, std::max(std::abs(t.value), t.sd));
  return sign + with_sd(unit.factor * t.value, unit.factor * t.sd, unit.name);
}

}  // namespace calomel
