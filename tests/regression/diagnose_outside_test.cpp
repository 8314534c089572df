// `calomel diagnose` of an external model that does not repeat itself.
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "base/artefact.hpp"
#include "base/random.hpp"
#include "tests/regression/program.hpp"
#include "tests/slice_case.hpp"
#include "tests/unit/forward/external/served.hpp"

namespace calomel::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int times = 60;

/// A wave whose rate may drift, which is the mechanism.
double drifting_wave(std::size_t sensor, int k, double rate, double damping, double drift) {
  return 100 * std::exp(-damping * k) * std::cos(rate * k * (1 + drift * k) + 0.7 * double(sensor));
}

/// Every value off by that share of it, another one at every point.
ServedModel jittering(double share) {
  ServedModel m{.name = "waves", .input_sizes = {2, 1}, .output_sizes = {2 * times}, .evaluate = {}, .gradient = {}, .apply_jacobian = {}};
  m.evaluate = [share](const Blocks& x, const Json&) {
    RandomStream random(std::hash<double>{}(x[0][0] + 3 * x[0][1] + 7 * x[1][0]), 0);
    Blocks y(1);
    for (std::size_t s = 0; s < 2; ++s)
      for (int k = 0; k < times; ++k) y[0].push_back(drifting_wave(s, k, x[0][0], x[0][1], x[1][0]) * (1 + share * random.normal()));
    return y;
  };
  return m;
}

/// Eight pulses, with the drift in them.
std::string drifting_records(double drift) {
  std::string text = "sensor,pulse,time,strain\n";
  RandomStream random(5, 0);
  for (std::size_t s = 0; s < 2; ++s)
    for (int pulse = 0; pulse < 8; ++pulse)
      for (int k = 0; k < times; ++k)
        text += fmt::format("{},{},{:.6g},{:.6g}\n", s == 0 ? "A" : "B", pulse, 1e-3 * k, drifting_wave(s, k, 0.3, 0.02, drift) + 2 * random.normal());
  return text;
}

struct Diagnosed {
  Json answer;
  std::string said;
};

Diagnosed diagnosed(const std::string& name, double jitter, double drift) {
  const Served server({jittering(jitter)});
  const auto dir = folder_with(
      name, {{"records.csv", drifting_records(drift)},
             {"case.toml", "[model]\nkind = \"umbridge\"\nurl = \"" + server.url() +
                               "\"\nname = \"waves\"\n[output]\nsensors = [\"A\", \"B\"]\ntime = { start = 0.0, step = 1e-3, count = 60 }\n"
                               "[recordings]\nfile = \"records.csv\"\n[parameter.rate]\nmin = 0.2\nmax = 0.4\nprior = \"normal\"\nmean = 0.301\nsd = 0.003\n"
                               "[parameter.damping]\nmin = 0.0\nmax = 0.1\nprior = \"normal\"\nmean = 0.021\nsd = 0.002\n"
                               "[mechanism.drift.parameter.size]\noff = 0.0\nmin = 0.0\nmax = 5e-3\n[diagnosis]\npairs = false\n"}});
  const auto made = run(dir, "diagnose case.toml");
  EXPECT_EQ(made.status, 0) << made.said;
  return {read_json(dir / "case.out" / "diagnosis.json"), made.said};
}

// Jitter of 0.3 %: least squares by finite differences of such a model end anywhere.
TEST(DiagnoseOutside, NamesTheMechanismThatANonRepeatableModelOmits) {
  const auto d = diagnosed("jitters", 0.003, 4e-4);
  EXPECT_THAT(d.said, HasSubstr("warning: the model does not repeat itself: two runs at nearly one point differ by"));
  EXPECT_THAT(d.answer.at("mechanisms"), ElementsAre("drift")) << d.said;
  EXPECT_EQ(d.answer.at("warnings").size(), 1u);
}

TEST(DiagnoseOutside, OfARepeatableModelDoesNotWarn) {
  const auto d = diagnosed("repeats", 0, 4e-4);
  EXPECT_THAT(d.said, Not(HasSubstr("repeat itself")));
  EXPECT_THAT(d.answer.at("mechanisms"), ElementsAre("drift")) << d.said;
  EXPECT_THAT(d.answer.at("warnings"), IsEmpty());
}

TEST(DiagnoseOutside, OfANonRepeatableModelNamesNothingIfNothingIsOmitted) {
  const auto d = diagnosed("jitters_alone", 0.003, 0);
  EXPECT_EQ(d.answer.at("verdict"), "none") << d.said;
}

}  // namespace
}  // namespace calomel::testing
