// What is drawn for one case. Lengths in metres, all else SI.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <variant>

#include "apps/challenge/suite.hpp"
#include "base/random.hpp"

namespace calomel::challenge {

namespace {

constexpr double never_parts = 1e9;  ///< tension at which a wetted face parts, in cutoffs, that nothing reaches

double rounded(double value, double step) { return step * std::round(value / step); }
double on_grid(double value) { return rounded(value, edge_step); }
double log_uniform(RandomStream& r, double low, double high) { return std::exp(r.uniform(std::log(low), std::log(high))); }
/// Of either sign.
double either_way(RandomStream& r, double low, double high) {
  const double sign = r.below(2) == 0 ? -1 : 1;
  return sign * r.uniform(low, high);
}

template <class T>
T one_of(RandomStream& r, std::initializer_list<T> choices) {
  return choices.begin()[r.below(choices.size())];
}

/// Keys of a table in the order of writing.
using Value = std::variant<double, std::int64_t, std::string>;
using Values = std::vector<std::pair<std::string, Value>>;

std::string toml_text(const Value& v) {
  if (const auto* s = std::get_if<std::string>(&v)) return '"' + *s + '"';
  if (const auto* i = std::get_if<std::int64_t>(&v)) return std::to_string(*i);
  std::string text = fmt::format("{:.8g}", std::get<double>(v));
  if (text.find_first_of(".e") == std::string::npos) text += ".0";  // a whole number would be an integer
  return text;
}

std::string table(const std::string& head, const Values& values) {
  std::string text = head + '\n';
  for (const auto& [key, value] : values) text += key + " = " + toml_text(value) + '\n';
  return text + '\n';
}

struct DrawnGauge {
  std::string name;
  double x, z;
  bool along_x;
};

/// From what a target is drawn.
struct TargetRanges {
  std::pair<double, double> length, height, wall, end;  ///< end of the records [s]
  std::vector<double> top, bottom;                      ///< places of the gauges, in lengths
  bool may_hold = false;                                ///< one in two has mercury that cannot part from its walls
};

const TargetRanges& ranges_of(const std::string& target) {
  static const std::map<std::string, TargetRanges> all{
      {"small", {{0.09, 0.11}, {0.032, 0.040}, {0.003, 0.005}, {0.22e-3, 0.26e-3}, {0.14, 0.32, 0.52, 0.75}, {0.2, 0.45, 0.7}}},
      {"full", {{0.19, 0.22}, {0.055, 0.065}, {0.004, 0.006}, {0.45e-3, 0.5e-3}, {0.1, 0.27, 0.42, 0.57, 0.75}, {0.16, 0.3, 0.45, 0.6, 0.78}, true}}};
  return all.at(target);
}

struct Target {
  double length, height, front, top, bottom;
  std::vector<DrawnGauge> gauges;

  Target(RandomStream& r, const TargetRanges& of) {
    const auto within = [&](std::pair<double, double> range) { return r.uniform(range.first, range.second); };
    length = on_grid(within(of.length));
    height = on_grid(within(of.height));
    for (double* wall : {&front, &top, &bottom}) *wall = on_grid(within(of.wall));
    const auto place = [](double x) { return rounded(x, 1e-4); };
    int count = 0;
    for (const double share : of.top) gauges.push_back({fmt::format("T{}", ++count), place(length * (share + r.uniform(-0.04, 0.04))), height, true});
    count = 0;
    for (const double share : of.bottom) gauges.push_back({fmt::format("B{}", ++count), place(length * (share + r.uniform(-0.04, 0.04))), 0, true});
    gauges.push_back({"F1", 0, place(height * r.uniform(0.45, 0.6)), false});
  }

  [[nodiscard]] double thickness(const std::string& wall) const { return wall == "front" ? front : wall == "top" ? top : bottom; }

  struct Stretch {
    double begin, length;
    double longest;  ///< how many times as long it may become
  };
  /// A stretch of a wall, away from the corners.
  Stretch stretch(RandomStream& r, const std::string& wall, double least, double most) const {
    double extent, low, high;
    if (wall == "front") {
      extent = on_grid(r.uniform(0.3, 0.6) * (height - top - bottom));
      low = bottom + 0.002;
      high = height - top - 0.002;
    } else {
      extent = on_grid(r.uniform(least, most));
      low = front + 0.004;
      high = length - 0.008;
    }
    const double begin = on_grid(r.uniform(low, high - extent));
    return {begin, extent, (high - begin) / extent};
  }

  /// A place on the top or bottom wall, more than 5 mm from its gauges.
  double free_place(RandomStream& r, const std::string& wall) const {
    const char first = wall == "top" ? 'T' : 'B';
    for (;;) {
      const double place = on_grid(r.uniform(0.015, length - 0.02));
      if (std::all_of(gauges.begin(), gauges.end(), [&](const DrawnGauge& g) { return g.name[0] != first || std::abs(place - g.x) > 0.005; })) return place;
    }
  }
};

struct DrawnEffect {
  Values numbers;   ///< at scale 1
  double greatest;  ///< scale that is still credible
};

DrawnEffect beam(const Target&, RandomStream& r) {
  // Up to three of the four, offset or width among them.
  std::array<bool, 4> taken{};
  const auto order = r.permutation(4);
  const std::size_t count = 1 + r.below(3);
  for (std::size_t k = 0; k < count; ++k) taken[order[k]] = true;
  if (!taken[0] && !taken[1]) taken[r.below(2)] = true;
  const Values all{{"offset_z", either_way(r, 1e-3, 3e-3)},
                   {"width_ratio", std::exp(either_way(r, 0.05, 0.12))},
                   {"energy_ratio", std::exp(either_way(r, 0.01, 0.02))},
                   {"pulse_length_ratio", r.uniform(1.5, 2.5)}};
  DrawnEffect e{{}, 1.8};
  for (std::size_t k = 0; k < all.size(); ++k)
    if (taken[k]) e.numbers.push_back(all[k]);
  return e;
}

DrawnEffect rear_layer(const Target&, RandomStream& r) {
  const double ratio = std::exp(either_way(r, 0.5, 1.5));
  return {{{"impedance_ratio", ratio}, {"depth", r.uniform(0.001, 0.004)}}, 2.5};
}

DrawnEffect bubbles(const Target&, RandomStream& r) {
  Values v;
  v.emplace_back("small_fraction", log_uniform(r, 1e-5, 1e-4));
  v.emplace_back("large_fraction", log_uniform(r, 1e-5, 1e-4));
  v.emplace_back("small_radius", log_uniform(r, 1e-5, 4e-5));
  v.emplace_back("large_radius", log_uniform(r, 6e-5, 3e-4));
  v.emplace_back("ambient", r.uniform(1e5, 3e5));
  v.emplace_back("viscosity", log_uniform(r, 0.05, 0.5));
  return {std::move(v), 20};
}

DrawnEffect nucleation(const Target&, RandomStream& r) {
  const double number = log_uniform(r, 3e6, 1e8);
  return {{{"number", number}, {"radius", 1e-5}, {"stronger", r.uniform(0.3, 0.7)}, {"strength", log_uniform(r, 3e5, 3e6)}}, 20};
}

DrawnEffect relaxing_liquid(const Target&, RandomStream& r) {
  const double viscosity = log_uniform(r, 2000, 8000);
  return {{{"viscosity", viscosity}, {"time", log_uniform(r, 0.5e-6, 4e-6)}}, 8};
}

DrawnEffect zener_steel(const Target&, RandomStream& r) {
  const double loss = r.uniform(0.01, 0.02);
  return {{{"loss", loss}, {"frequency", log_uniform(r, 8e3, 4e4)}}, 4};
}

DrawnEffect heated_steel(const Target&, RandomStream& r) {
  const double rise = r.uniform(0.5, 1);
  return {{{"rise", rise}, {"depth", log_uniform(r, 0.015, 0.06)}, {"expansion", 16e-6}}, 3};
}

DrawnEffect tait(const Target&, RandomStream& r) { return {{{"stiffening", r.uniform(8, 12)}}, 1.3}; }

DrawnEffect debonding(const Target& t, RandomStream& r) {
  const auto wall = one_of<std::string>(r, {"top", "bottom", "front"});
  const auto s = t.stretch(r, wall, 0.015, 0.03);
  const double holds = r.below(2) == 0 ? 0 : r.uniform(0, 5e4);
  return {{{"wall", wall}, {"begin", s.begin}, {"length", s.length}, {"strength", holds}}, s.longest};
}

DrawnEffect thinning(const Target& t, RandomStream& r) {
  const auto wall = one_of<std::string>(r, {"top", "bottom", "front"});
  const auto s = t.stretch(r, wall, 0.01, 0.025);
  return {{{"wall", wall}, {"begin", s.begin}, {"length", s.length}, {"fraction", r.uniform(0.15, 0.3)}}, 2};
}

DrawnEffect residual_ringing(const Target&, RandomStream& r) {
  const double amplitude = either_way(r, 0.1, 0.3);
  return {{{"amplitude", amplitude}, {"after", r.uniform(4e-3, 8e-3)}}, 3};
}

DrawnEffect gauge_fault(const Target& t, RandomStream& r) {
  const std::string gauge = t.gauges[r.below(t.gauges.size())].name;
  switch (r.below(4)) {
    case 0:
      return {{{"gauge", gauge}, {"gain", std::exp(either_way(r, 0.08, 0.15))}}, 2.5};
    case 1:
      return {{{"gauge", gauge}, {"delay", either_way(r, 1e-6, 2e-6)}}, 2.5};
    case 2:
      return {{{"gauge", gauge}, {"low_pass", log_uniform(r, 2e4, 1e5)}}, 2.5};
    default:
      return {{{"gauge", gauge}, {"angle", r.uniform(8, 15)}}, 2.5};
  }
}

DrawnEffect yielding(const Target&, RandomStream& r) {
  const double stress = r.uniform(6e7, 1.2e8);
  return {{{"stress", stress}, {"hardening", r.uniform(1e9, 4e9)}}, 6};
}

std::string top_or_bottom(RandomStream& r) { return one_of<std::string>(r, {"top", "bottom"}); }

DrawnEffect rib(const Target& t, RandomStream& r) {
  const auto wall = top_or_bottom(r);
  const double place = t.free_place(r, wall);
  return {{{"wall", wall}, {"place", place}, {"thickness", 0.003}, {"height", on_grid(r.uniform(0.004, 0.01))}}, 2};
}

DrawnEffect gas_pocket(const Target& t, RandomStream& r) {
  const auto s = t.stretch(r, "top", 0.008, 0.02);
  return {{{"wall", "top"}, {"begin", s.begin}, {"length", s.length}, {"thickness", log_uniform(r, 2e-6, 2e-5)}},
          s.longest};  // a thinner one is a face that lets go
}

DrawnEffect speed_gradient(const Target&, RandomStream& r) {
  const double change = either_way(r, 0.05, 0.1);
  return {{{"change", change}}, 3};
}

DrawnEffect added_mass(const Target& t, RandomStream& r) {
  const auto wall = top_or_bottom(r);
  const auto s = t.stretch(r, wall, 0.015, 0.04);
  return {{{"wall", wall}, {"begin", s.begin}, {"length", s.length}, {"mass", r.uniform(5, 15)}}, 10};
}

DrawnEffect slot(const Target& t, RandomStream& r) {
  const auto wall = top_or_bottom(r);
  const double place = t.free_place(r, wall);
  return {{{"wall", wall}, {"place", place}, {"width", 0.5e-3}, {"depth", r.uniform(0.3, 0.6) * t.thickness(wall)}}, 1.6};
}

using Draw = DrawnEffect (*)(const Target&, RandomStream&);
const std::map<std::string, Draw>& drawers() {
  static const std::map<std::string, Draw> all{{"beam", beam},
                                               {"rear_layer", rear_layer},
                                               {"bubbles", bubbles},
                                               {"nucleation", nucleation},
                                               {"relaxing_liquid", relaxing_liquid},
                                               {"zener_steel", zener_steel},
                                               {"heated_steel", heated_steel},
                                               {"tait", tait},
                                               {"debonding", debonding},
                                               {"thinning", thinning},
                                               {"residual_ringing", residual_ringing},
                                               {"gauge_fault", gauge_fault},
                                               {"yielding", yielding},
                                               {"rib", rib},
                                               {"gas_pocket", gas_pocket},
                                               {"speed_gradient", speed_gradient},
                                               {"added_mass", added_mass},
                                               {"slot", slot}};
  return all;
}

}  // namespace

std::string draw_spec(std::size_t index, const std::vector<std::string>& effects, std::uint64_t seed, const SuiteOptions& options) {
  RandomStream r(seed, 1 + index);  // 0 is that of the order
  const TargetRanges& of = ranges_of(options.target);
  const Target t(r, of);
  // One statement a number: the order in which arguments are evaluated is not fixed.
  const double noise = one_of(r, {2e-6, 3e-6, 4e-6});
  const auto generator_seed = std::int64_t(r.below(std::uint64_t{1} << 31));
  std::string text = table("[case]", {{"name", case_name(index)}, {"seed", generator_seed}, {"grid", options.grid}});
  text += table("[geometry]", {{"length", t.length}, {"height", t.height}, {"front", t.front}, {"top", t.top}, {"bottom", t.bottom}});
  const double young = 193e9 * (1 + 0.015 * std::clamp(r.normal(), -2.0, 2.0));
  text += table("[steel]", {{"young", young}, {"density", 7960.0}, {"poisson", 0.29}});
  const double density = r.uniform(13250, 13590), speed = r.uniform(1405, 1490), cutoff = log_uniform(r, 8e4, 4e5), viscosity = log_uniform(r, 500, 4000);
  Values mercury{{"density", density}, {"sound_speed", speed}, {"tensile_cutoff", cutoff}, {"viscosity", viscosity}};
  if (of.may_hold && r.below(2) == 0) mercury.emplace_back("wall_strength_ratio", never_parts);
  text += table("[mercury]", mercury);
  const double peak = rounded(r.uniform(20e6, 30e6), 1e5), center = rounded(t.height * r.uniform(0.45, 0.55), 1e-4),
               width = rounded(t.height * r.uniform(0.3, 0.42), 1e-4);
  const double pulse_length = 0.7e-6 * r.uniform(0.9, 1.1);
  text += table("[load]", {{"peak_pressure", peak}, {"center", center}, {"width", width}, {"pulse_length", pulse_length}});
  text += table("[time]", {{"end", rounded(r.uniform(of.end.first, of.end.second), 1e-6)}, {"interval", 1e-6}});
  const auto pulses = std::int64_t(18 + r.below(7));
  const double energy = 1 + 0.01 * r.normal();
  text += table("[pulses]", {{"count", pulses}, {"energy", energy}, {"energy_sd", 0.015}});
  text += table("[gauges]", {{"place_sd", 0.3e-3}, {"gain_sd", 0.01}, {"noise_time", log_uniform(r, 2e-6, 8e-6)}});
  for (const auto& g : t.gauges) {
    const double times = r.below(6) == 0 ? 3 : 1;  // one gauge in six is noisy
    text += table("[[gauge]]", {{"name", g.name}, {"x", g.x}, {"z", g.z}, {"direction", g.along_x ? "x" : "z"}, {"length", 0.002}, {"noise", noise * times}});
  }
  double greatest = 1e9;
  for (const auto& name : effects) {
    DrawnEffect e = drawers().at(name)(t, r);
    greatest = std::min(greatest, e.greatest);
    e.numbers.insert(e.numbers.begin(), {"name", name});
    text += table("[[effect]]", e.numbers);
  }
  if (!effects.empty() && effects != std::vector<std::string>{"tait"}) {  // a real liquid's curvature is no matter of choice
    const double target =
        effects.size() > 1 ? log_uniform(r, 0.05, 0.2) : log_uniform(r, 0.02, 0.16);  // of a pair as of one its weaker half would lie near the noise
    text += table("[strength]", {{"target", target}, {"greatest_scale", greatest}, {"least_scale", 1e-3}});
  }
  return text;
}

}  // namespace calomel::challenge
