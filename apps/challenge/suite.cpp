#include "apps/challenge/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"

namespace calomel::challenge {

namespace {

constexpr double least_grid = 0.02e-3;  ///< [m]

/// Pairs, taken in this order.
const std::vector<std::vector<std::string>>& pairs() {
  static const std::vector<std::vector<std::string>> all{
      {"beam", "rear_layer"},    {"beam", "bubbles"},     {"rear_layer", "zener_steel"}, {"beam", "gauge_fault"}, {"rear_layer", "gauge_fault"},
      {"bubbles", "rear_layer"}, {"beam", "zener_steel"}, {"bubbles", "gauge_fault"},    {"thinning", "beam"},    {"nucleation", "beam"}};
  return all;
}

bool among(const std::vector<std::string>& list, const std::string& name) { return std::find(list.begin(), list.end(), name) != list.end(); }

std::vector<std::string> drawable() {
  std::vector<std::string> all = library_effects();
  all.insert(all.end(), outside_effects().begin(), outside_effects().end());
  return all;
}

}  // namespace

const std::vector<std::string>& library_effects() {
  static const std::vector<std::string> all{"beam",         "rear_layer", "bubbles",   "nucleation", "relaxing_liquid", "zener_steel",
                                            "heated_steel", "tait",       "debonding", "thinning",   "residual_ringing"};
  return all;
}

const std::vector<std::string>& outside_effects() {
  static const std::vector<std::string> all{"yielding", "rib", "gas_pocket", "speed_gradient", "added_mass", "slot"};
  return all;
}

const Registry<SuiteOptions>& suites() {
  static const Registry<SuiteOptions> all = [] {
    Registry<SuiteOptions> r("suite");
    r.add("small", "the least that the gates of a diagnosis can be judged by", {.none = 60, .single = 6, .outside = 5, .sensor = 5, .pair = 8});
    r.add("quick", "one or two of each kind, to try out",
          {.none = 1, .single = 1, .outside = 1, .sensor = 1, .pair = 1, .effects = {"beam", "rear_layer", "gas_pocket"}});
    r.add("full", "a dozen slices of a whole target's size, which show that the results of small ones hold there",
          {.none = 3,
           .single = 1,
           .outside = 1,
           .sensor = 1,
           .pair = 1,
           .effects = {"beam", "bubbles", "zener_steel", "debonding", "thinning", "yielding", "speed_gradient"},
           .target = "full"});
    return r;
  }();
  return all;
}

void SuiteOptions::validate() const {
  const auto known = drawable();
  for (const auto& e : effects)
    if (!among(known, e))
      throw InputError({.problem = "no effect of this name can be drawn",
                        .key = "effects",
                        .value = '"' + e + '"',
                        .range = join(known),
                        .suggestion = name_suggestion(e, known)});
  const double cells = edge_step / grid;
  if (!(grid >= least_grid && grid <= edge_step) || std::abs(cells - std::round(cells)) > 1e-9 * cells)
    throw InputError({.problem = "edges of the targets lie on a grid of 0.5 mm, of which this must be a whole part",
                      .key = "grid",
                      .value = number_text(grid),
                      .range = number_text(least_grid) + " to " + number_text(edge_step),
                      .suggestion = "0.25e-3 is half a tool's own error, 0.5e-3 is quick"});
  if (cases_of(*this, 0).empty())
    throw InputError({.problem = "a suite of no case", .suggestion = "raise one of --none, --single, --outside, --sensor, --pair"});
}

std::vector<std::vector<std::string>> cases_of(const SuiteOptions& o, std::uint64_t seed) {
  const auto wanted = [&](const std::string& effect) { return o.effects.empty() || among(o.effects, effect); };
  std::vector<std::vector<std::string>> ordered(std::size_t(o.none));
  for (int k = 0; k < o.sensor; ++k) ordered.push_back({"gauge_fault"});
  for (const auto& e : library_effects())
    for (int k = 0; k < o.single && wanted(e); ++k) ordered.push_back({e});
  for (const auto& e : outside_effects())
    for (int k = 0; k < o.outside && wanted(e); ++k) ordered.push_back({e});
  for (int k = 0; k < o.pair; ++k) ordered.push_back(pairs()[std::size_t(k) % pairs().size()]);
  RandomStream random(seed, 0);
  std::vector<std::vector<std::string>> shuffled;
  for (const std::size_t k : random.permutation(ordered.size())) shuffled.push_back(ordered[k]);
  return shuffled;
}

std::string case_name(std::size_t index) { return fmt::format("case_{:03}", index + 1); }

}  // namespace calomel::challenge
