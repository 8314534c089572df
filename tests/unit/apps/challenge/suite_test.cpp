// What is drawn for a suite: the same for the same seed, as many as requested, within the ranges of docs/proof/generator.md, and readable by the generator.
#include "apps/challenge/suite.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "base/case_file.hpp"
#include "tests/proof/experiment.hpp"
#include "tests/scratch.hpp"

namespace calomel::challenge {
namespace {

using ::testing::HasSubstr;

std::string refused(const SuiteOptions& options) {
  try {
    options.validate();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// How often each list of effects is there, joined.
std::map<std::string, int> counted(const std::vector<std::vector<std::string>>& cases) {
  std::map<std::string, int> count;
  for (const auto& c : cases) ++count[join(c, "+")];
  return count;
}

/// SPEC files of every effect, some of each, and of pairs and of nothing.
std::vector<std::pair<std::string, CaseFile>> many_specs() {
  std::vector<std::pair<std::string, CaseFile>> all;
  const SuiteOptions options{.none = 40, .single = 12, .outside = 12, .sensor = 40, .pair = 20};
  const auto cases = cases_of(options, 3);
  for (std::size_t k = 0; k < cases.size(); ++k) all.emplace_back(join(cases[k], "+"), CaseFile::from_text(draw_spec(k, cases[k], 3, {})));
  return all;
}

TEST(Suite, UnknownNamesAreRefusedWithTheNearest) {
  EXPECT_NO_THROW(suites().get("small").validate());
  EXPECT_NO_THROW(suites().get("quick").validate());
  try {
    (void)suites().get("smal", "--suite");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("--suite"), HasSubstr("small, quick"), HasSubstr("did you mean \"small\"?")));
  }
}

TEST(Suite, SmallHasTheCountsThatTheGatesAreJudgedBy) {
  const auto count = counted(cases_of(suites().get("small"), 1));
  EXPECT_EQ(count.at(""), 60);
  EXPECT_EQ(count.at("gauge_fault"), 5);
  int singles = 0, outside = 0, pairs = 0;
  for (const auto& e : library_effects()) {
    EXPECT_GE(count.at(e), 5) << e;
    singles += count.at(e);
  }
  for (const auto& e : outside_effects()) outside += count.at(e);
  for (const auto& [name, n] : count)
    if (name.find('+') != std::string::npos) pairs += n;
  EXPECT_GE(singles, 60);
  EXPECT_EQ(outside, 30);
  EXPECT_EQ(pairs, 8);
}

TEST(Suite, QuickHasEachKindOnceOrTwice) {
  const auto count = counted(cases_of(suites().get("quick"), 1));
  EXPECT_THAT(count, testing::ElementsAre(testing::Pair("", 1), testing::Pair("beam", 1), testing::Pair("beam+rear_layer", 1), testing::Pair("gas_pocket", 1),
                                          testing::Pair("gauge_fault", 1), testing::Pair("rear_layer", 1)));
}

TEST(Suite, OrderIsRandomAndDependsOnTheSeed) {
  const auto& small = suites().get("small");
  const auto one = cases_of(small, 1);
  EXPECT_EQ(one, cases_of(small, 1));
  EXPECT_NE(one, cases_of(small, 2));
  EXPECT_EQ(counted(one), counted(cases_of(small, 2)));
  // Sixty of 169 conceal nothing: among the first sixty there are 21 +- 4 of them in a random order, 60 in the order of the list.
  const auto none = std::count_if(one.begin(), one.begin() + 60, [](const auto& c) { return c.empty(); });
  EXPECT_NEAR(double(none), 60 * 60 / 169.0, 4 * 4);
}

TEST(Suite, EffectsAreKeptTo) {
  const SuiteOptions only{.single = 2, .outside = 3, .effects = {"thinning", "slot"}};
  EXPECT_THAT(counted(cases_of(only, 1)), testing::ElementsAre(testing::Pair("slot", 3), testing::Pair("thinning", 2)));
}

TEST(Suite, RefusesWhatCannotBeDrawn) {
  EXPECT_THAT(refused({.single = 1, .effects = {"beem"}}), testing::AllOf(HasSubstr("beem"), HasSubstr("did you mean \"beam\"?")));
  EXPECT_THAT(refused({}), HasSubstr("no case"));
  EXPECT_THAT(refused({.single = 1, .effects = {"slot"}}), HasSubstr("no case"));  // outside the library, of which none are requested
  for (const double grid : {0.0, -1e-3, 0.3e-3, 1e-3, std::nan("")}) EXPECT_THAT(refused({.none = 1, .grid = grid}), HasSubstr("grid")) << grid;
  for (const double grid : {0.5e-3, 0.25e-3, 0.125e-3, 0.1e-3}) EXPECT_EQ(refused({.none = 1, .grid = grid}), "") << grid;
}

TEST(Draw, SameSeedSameSpec) {
  const std::vector<std::string> beam{"beam"};
  const std::string spec = draw_spec(7, beam, 11, {});
  EXPECT_EQ(spec, draw_spec(7, beam, 11, {}));
  EXPECT_NE(spec, draw_spec(7, beam, 12, {}));
  const CaseFile here = CaseFile::from_text(spec), there = CaseFile::from_text(draw_spec(8, beam, 11, {}));
  EXPECT_EQ(here.text("case.name"), "case_008");
  for (const char* key : {"case.seed", "mercury.density", "load.pulse_length", "steel.young"}) EXPECT_NE(here.number(key), there.number(key)) << key;
}

TEST(Draw, NumbersLieInTheirRanges) {
  struct {
    const char* key;
    double low, high;
  } const ranges[]{{"geometry.length", 0.09, 0.11},
                   {"geometry.height", 0.032, 0.040},
                   {"geometry.front", 0.003, 0.005},
                   {"geometry.top", 0.003, 0.005},
                   {"geometry.bottom", 0.003, 0.005},
                   {"mercury.density", 13250, 13590},
                   {"mercury.sound_speed", 1405, 1490},
                   {"mercury.tensile_cutoff", 8e4, 4e5},
                   {"mercury.viscosity", 500, 4000},
                   {"load.pulse_length", 0.63e-6, 0.77e-6},
                   {"load.peak_pressure", 20e6, 30e6},
                   {"time.end", 0.22e-3, 0.26e-3},
                   {"pulses.count", 18, 24},
                   {"gauges.noise_time", 2e-6, 8e-6},
                   {"steel.young", 193e9 * 0.97, 193e9 * 1.03},
                   {"pulses.energy", 0.95, 1.05}};
  std::map<std::string, std::pair<double, double>> seen;
  const auto specs = many_specs();
  ASSERT_EQ(specs.size(), 304u);
  for (const auto& [effects, spec] : specs) {
    for (const auto& r : ranges) {
      const double x = spec.number(r.key).value();
      EXPECT_GE(x, r.low * (1 - 1e-7)) << r.key;
      EXPECT_LE(x, r.high * (1 + 1e-7)) << r.key;
      auto& [least, most] = seen.try_emplace(r.key, x, x).first->second;
      least = std::min(least, x);
      most = std::max(most, x);
    }
    for (const char* key : {"geometry.length", "geometry.height", "geometry.front", "geometry.top", "geometry.bottom"}) {
      const double cells = spec.number(key).value() / 0.5e-3;
      EXPECT_NEAR(cells, std::round(cells), 1e-6) << key;
    }
    ASSERT_EQ(spec.count("gauge"), 8u);
    const bool scaled = !effects.empty() && effects != "tait";
    EXPECT_EQ(spec.has("strength.target"), scaled) << effects;
    if (scaled) {
      const bool pair = spec.count("effect") == 2;
      EXPECT_GE(spec.number("strength.target").value(), pair ? 0.05 : 0.02) << effects;
      EXPECT_LE(spec.number("strength.target").value(), pair ? 0.2 : 0.16) << effects;
      EXPECT_GE(spec.number("strength.greatest_scale").value(), 1);
    }
  }
  // What is drawn fills its range: of 304 uniform numbers one tenth at either end remains empty with a chance of 1e-14.
  for (const auto& r : ranges) {
    if (std::string(r.key) == "pulses.energy") continue;  // normal
    EXPECT_LT(seen.at(r.key).first, r.low + 0.2 * (r.high - r.low)) << r.key;
    EXPECT_GT(seen.at(r.key).second, r.high - 0.2 * (r.high - r.low)) << r.key;
  }
}

TEST(Draw, EffectsAreOnTheirWallsAndAwayFromTheGauges) {
  std::set<std::string> faults;
  for (const auto& [effects, spec] : many_specs())
    for (std::size_t k = 0; k < spec.count("effect"); ++k) {
      const std::string at = "effect[" + std::to_string(k) + "].";
      const auto number = [&](const char* key) { return spec.number(at + key); };
      const std::string name = spec.text(at + "name").value();
      if (const auto begin = number("begin")) {
        const double end = *begin + number("length").value(),
                     most = spec.text(at + "wall") == "front" ? spec.number("geometry.height").value() : spec.number("geometry.length").value();
        EXPECT_GT(*begin, 0) << name;
        EXPECT_LT(end, most) << name;
        EXPECT_GT(number("length").value(), 0) << name;
      }
      if (const auto place = number("place"))
        for (std::size_t g = 0; g < spec.count("gauge"); ++g) {
          const std::string gauge = "gauge[" + std::to_string(g) + "].", gauge_name = spec.text(gauge + "name").value();
          if ((gauge_name[0] == 'T') == (spec.text(at + "wall") == "top") && gauge_name[0] != 'F') {
            EXPECT_GT(std::abs(*place - spec.number(gauge + "x").value()), 0.005 - 1e-9) << name;
          }
        }
      if (name == "gas_pocket") {
        EXPECT_GE(number("thickness").value(), 2e-6);
        EXPECT_LE(number("thickness").value(), 2e-5);
      }
      if (name == "beam") {
        EXPECT_TRUE(number("offset_z") || number("width_ratio"));
      }
      if (name == "gauge_fault")
        for (const char* key : {"gain", "delay", "low_pass", "angle"})
          if (number(key)) faults.insert(key);
    }
  EXPECT_EQ(faults.size(), 4u);
}

TEST(Draw, AFullTargetIsTwiceAsLongAndMayHoldItsMercury) {
  const auto& full = suites().get("full");
  EXPECT_NO_THROW(full.validate());
  const auto cases = cases_of(full, 1);
  EXPECT_EQ(cases.size(), 12u);
  int held = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    const auto path = scratch_file("full.toml");
    std::ofstream(path) << draw_spec(k, {}, 7, full);
    const auto x = proof::Experiment::read(path);
    EXPECT_GE(x.length, 0.19);
    EXPECT_GE(x.height, 0.055);
    EXPECT_GE(x.end, 0.45e-3);
    EXPECT_EQ(x.gauges.size(), 11u);
    held += x.wall_strength_ratio > 1;
  }
  EXPECT_NEAR(held, 20, 3 * std::sqrt(40 * 0.25));
}

TEST(Draw, TheGeneratorReadsEveryEffect) {
  std::set<std::string> seen;
  const auto cases = cases_of({.none = 1, .single = 2, .outside = 2, .sensor = 4, .pair = 10}, 5);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const auto path = scratch_file("drawn.toml");
    std::ofstream(path) << draw_spec(k, cases[k], 5, {.grid = 0.5e-3});
    const auto x = proof::Experiment::read(path);
    ASSERT_EQ(x.effects.size(), cases[k].size());
    EXPECT_NO_THROW((void)x.slice(x.effects, x.grid)) << join(cases[k]);
    EXPECT_EQ(x.wall_strength_ratio, 1) << "small targets' mercury parts from its walls as it gives way";
    for (const auto& e : x.effects) {
      seen.insert(e.name);
      EXPECT_EQ(proof::library_name(e.name).empty(), std::count(outside_effects().begin(), outside_effects().end(), e.name) == 1) << e.name;
    }
  }
  EXPECT_EQ(seen.size(), library_effects().size() + outside_effects().size() + 1);
}

}  // namespace
}  // namespace calomel::challenge
