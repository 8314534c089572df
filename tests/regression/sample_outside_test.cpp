// `calomel sample` by an external model itself, without an emulator: whether the records contradict it, and what they say of its errors.
#include <fmt/format.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/random.hpp"
#include "tests/regression/program.hpp"
#include "tests/slice_case.hpp"
#include "tests/unit/forward/external/served.hpp"

namespace calomel::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int times = 60;

double wave(std::size_t sensor, int k, double rate, double damping) { return 100 * std::exp(-damping * k) * std::cos(rate * k + 0.7 * double(sensor)); }

ServedModel damped_waves() {
  ServedModel m{.name = "waves", .input_sizes = {2}, .output_sizes = {2 * times}, .evaluate = {}, .gradient = {}, .apply_jacobian = {}};
  m.evaluate = [](const Blocks& x, const Json&) {
    Blocks y(1);
    for (std::size_t s = 0; s < 2; ++s)
      for (int k = 0; k < times; ++k) y[0].push_back(wave(s, k, x[0][0], x[0][1]));
    return y;
  };
  return m;
}

/// Four pulses of rate 0.3 and damping 0.02, gauge B times `gain`, and an echo of gauge A's that no parameter explains.
std::string records(double gain, double echo) {
  std::string text = "sensor,pulse,time,strain\n";
  RandomStream random(5, 0);
  for (std::size_t s = 0; s < 2; ++s)
    for (int pulse = 0; pulse < 4; ++pulse)
      for (int k = 0; k < times; ++k)
        text += fmt::format("{},{},{:.6g},{:.6g}\n", s == 0 ? "A" : "B", pulse, 1e-3 * k,
                            (s == 1 ? gain : 1) * wave(s, k, 0.3, 0.02) + (s == 0 && k > 20 ? echo * std::sin(0.9 * k) : 0) + 3 * random.normal());
  return text;
}

Json sampled(const std::string& name, const std::string& records) {
  const Served server({damped_waves()});
  const auto dir = folder_with(
      name, {{"records.csv", records},
             {"case.toml", "[model]\nkind = \"umbridge\"\nurl = \"" + server.url() +
                               "\"\nname = \"waves\"\n[output]\nsensors = [\"A\", \"B\"]\ntime = { start = 0.0, step = 1e-3, count = 60 }\n"
                               "[recordings]\nfile = \"records.csv\"\n[errors]\ngain_sd = 0.01\n[parameter.rate]\nmin = 0.2\nmax = 0.4\nprior = \"uniform\"\n"
                               "[parameter.damping]\nmin = 0.0\nmax = 0.1\nprior = \"uniform\"\n[sampler]\nwarmup = 500\ndraws = 1200\nthin = 1\n"}});
  const auto made = run(dir, "sample case.toml");
  EXPECT_EQ(made.status, 0) << made.said;
  return read_json(dir / "case.out" / "posterior.json");
}

TEST(SampleOutside, OfTheRightModelIsFinal) {
  const Json json = sampled("outside_right", records(1, 0));
  EXPECT_TRUE(json["final"].get<bool>()) << json.dump(1);
  EXPECT_TRUE(json["adequate"].get<bool>());
  EXPECT_THAT(json["warnings"], IsEmpty());
  EXPECT_FALSE(json["mode"]["pulls"].empty());
  EXPECT_NEAR(json["mode"]["theta"]["rate"].get<double>(), 0.3, 0.003);
}

TEST(SampleOutside, OfAModelThatTheRecordsContradictIsNotFinal) {
  const Json json = sampled("outside_echo", records(1, 15));
  EXPECT_FALSE(json["adequate"].get<bool>());
  EXPECT_FALSE(json["final"].get<bool>());
  EXPECT_THAT(json["warnings"].get<std::vector<std::string>>(), Contains(HasSubstr("the fit is not adequate")));
}

TEST(SampleOutside, ReportsAGainThatDiffersFromItsPrior) {
  const Json json = sampled("outside_gain", records(1.15, 0));
  EXPECT_FALSE(json["final"].get<bool>());
  EXPECT_THAT(json["warnings"].get<std::vector<std::string>>(), Contains(AllOf(HasSubstr("the gain of"), HasSubstr("errors.gain_sd"))));
}

}  // namespace
}  // namespace calomel::testing
