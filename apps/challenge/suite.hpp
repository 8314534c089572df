#pragma once
/// Suites of cases with concealed physics: how many of which, and what is drawn for each. docs/proof/challenge.md
#include <cstdint>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "base/registry.hpp"

namespace calomel::challenge {

inline constexpr double edge_step = 0.5e-3;  ///< [m] every edge of a target lies on a grid of this spacing

/// How many cases of each kind, and which effects.
struct SuiteOptions {
  int none = 0;                      ///< with nothing concealed
  int single = 0;                    ///< of each effect that the library has a mechanism for
  int outside = 0;                   ///< of each effect that it has none for
  int sensor = 0;                    ///< with a fault of one gauge
  int pair = 0;                      ///< with two effects
  std::vector<std::string> effects;  ///< singles and outside keep to these; empty: all
  double grid = 0.25e-3;             ///< of the records [m]
  std::string target = "small";      ///< which targets are drawn: small or full

  template <class V>
  void visit(V& v) {
    v("none", none, {.range = between(0, 100000), .doc = "cases with nothing concealed"});
    v("single", single, {.range = between(0, 100000), .doc = "cases of each effect that the library has a mechanism for"});
    v("outside", outside, {.range = between(0, 100000), .doc = "cases of each effect that the library has no mechanism for"});
    v("sensor", sensor, {.range = between(0, 100000), .doc = "cases with a fault of one gauge"});
    v("pair", pair, {.range = between(0, 100000), .doc = "cases with two effects"});
    v("effects", effects, {.doc = "effects that singles and outside keep to; empty: all"});
    v("grid", grid, {.unit = "m", .range = between(0.02e-3, 0.5e-3), .doc = "a whole part of 0.5 mm, spacing of the grid on which the records are made"});
    v("target", target,
      {.doc = "small: slices of 0.10 m by 0.04 m, 0.25 ms, 8 gauges; full: 0.20 m by 0.06 m, 0.5 ms, 11 gauges", .choices = {"small", "full"}});
  }
  /// Errors: InputError where an effect is not known, grid does not divide 0.5 mm, or there is no case at all.
  void validate() const;
};

/// Suites with fixed counts, by name.
const Registry<SuiteOptions>& suites();

/// Names of effects as the reference generator has them.
const std::vector<std::string>& library_effects();  ///< the library has a mechanism for each
const std::vector<std::string>& outside_effects();  ///< it has none

/// Names of the effects of each case, in shuffled order: a place in it carries no information. Depends on the counts and the seed alone.
std::vector<std::vector<std::string>> cases_of(const SuiteOptions& options, std::uint64_t seed);

/// "case_001" for index 0.
std::string case_name(std::size_t index);

/// SPEC of the reference generator (docs/proof/generator.md) for the case at `index` of a suite: target, true numbers, gauges, pulses, and the effects with
/// numbers drawn for them. Depends on seed, index, effects, and the options' target and grid alone.
std::string draw_spec(std::size_t index, const std::vector<std::string>& effects, std::uint64_t seed, const SuiteOptions& options);

}  // namespace calomel::challenge
