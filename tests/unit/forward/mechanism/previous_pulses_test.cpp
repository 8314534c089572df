#include "forward/mechanism/previous_pulses.hpp"

#include <algorithm>
#include <cmath>

#include "forward/target/built_in_model.hpp"
#include "forward/mechanism/left_states.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

// The motion is a constant, a tone of 2 kHz and one of 60 kHz. The mean of all samples removes the first, the low pass the last, and the tone of 2 kHz remains
// whole, in displacement and velocity alike.
TEST(LeftStates, AreFreeMotionWithoutHighTones) {
  LeftStates left(1e-3, 1e-6);
  const double slow = 2 * M_PI * 2e3, fast = 2 * M_PI * 60e3;
  const auto picture = [&](double t) {
    FieldSnapshot f;
    f.time = t;
    f.displacement = {{1e-6 + 2e-7 * std::sin(slow * t) + 1e-7 * std::sin(fast * t), 0, 0}};
    f.velocity = {{2e-7 * slow * std::cos(slow * t) + 1e-7 * fast * std::cos(fast * t), 0, 0}};
    return f;
  };
  for (double t = 0; t < left.end() + 0.5 * left.interval(); t += left.interval()) left.take(picture(t));
  const auto states = left.states();
  ASSERT_EQ(states.size(), LeftStates::count);
  double mean = 0, mean_rate = 0;
  for (const double t : left.times()) {
    EXPECT_GT(t, 1e-3);
    mean += std::sin(slow * t) / LeftStates::count;
    mean_rate += slow * std::cos(slow * t) / LeftStates::count;
  }
  for (std::size_t k = 0; k < states.size(); ++k) {
    const double t = left.times()[k];
    EXPECT_NEAR(states[k].displacement[0][0], 2e-7 * (std::sin(slow * t) - mean), 1e-10);
    EXPECT_NEAR(states[k].velocity[0][0], 2e-7 * (slow * std::cos(slow * t) - mean_rate), 1e-3 * 2e-7 * slow);
  }
}

namespace {

/// A box of mercury with one lively record; unless the test sets a cutoff the mercury never cavitates.
ForwardCase box(const std::string& mechanism, double record, const std::string& mercury = "law = \"linear\"", double peak = 1e6) {
  CaseFile file = CaseFile::from_text(R"([geometry]
kind = "box"
length = 0.12
width = 0.1
height = 0.06
wall = 0.004
rear = "wall"
plane_strain = true
element_size = 0.004
[material.mercury]
)" + mercury + R"(
[load]
peak_pressure = )" + number_text(peak) +
                                      R"(
profile = { center = [0.0, 0.03], widths = [0.1, 0.01] }
[time]
end = )" + number_text(record) + R"(
output_interval = 4e-6
[[sensor]]
name = "T"
position = [0.05, 0.0, 0.06]
direction = [1, 0, 0]
[[sensor]]
name = "F"
position = [0.0, 0.0, 0.03]
direction = [0, 0, 1]
)" + (mechanism.empty() ? "" : "[mechanism.previous_pulses]\nenabled = true\n" + mechanism));
  return ForwardCase::read(file);
}

using Records = std::vector<double>;

Records mean_of(const ForwardCase& c) {
  const Prediction p = BuiltInModel(c, {.pulses = 1}).evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return p.mean;
}

Records minus(Records a, const Records& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

double size(const Records& y) {
  double sum = 0;
  for (const double v : y) sum += v * v;
  return std::sqrt(sum);
}

constexpr double interval = 4e-6, record = 0.8e-3;
constexpr int half = 32;  ///< samples of a triangle of 0.26 ms, which leaves little above 10 kHz

/// Mean of a gauge's history about sample i, weighted by the triangle.
double smooth(const double* y, std::ptrdiff_t i) {
  double sum = 0;
  for (int k = -half; k <= half; ++k) sum += (half + 1 - std::abs(k)) * y[i + k];
  return sum / ((half + 1) * (half + 1));
}

}  // namespace

// In mercury that never cavitates the record is that of the pulse plus that of the residual motion, which is the model's own longer record from the time of the
// state on, with the gauges set to zero at its beginning.
TEST(PreviousPulses, TheRunGoesOnWithWhatAPulseHasLeft) {
  const Records whole = mean_of(box("", 5e-3)), base = mean_of(box("", record));
  const std::size_t times = base.size() / 2, all = whole.size() / 2;
  const LeftStates left(record, interval);
  for (const std::size_t k : {1, 4}) {
    const Records added = minus(mean_of(box("left_" + std::to_string(k + 1) + " = 0.5\n", record)), base);
    const auto expected = [&](std::size_t gauge, std::size_t state, std::ptrdiff_t i) {
      const auto at = [&](double t) { return smooth(whole.data() + gauge * all, std::lround(t / interval) + i); };
      double mean = 0;
      for (const double t : left.times()) mean += at(t) / LeftStates::count;
      return 0.5 * (at(left.times()[state]) - mean);
    };
    double off = 0, other = 0, sum = 0;
    for (std::size_t g = 0; g < 2; ++g) {
      EXPECT_EQ(added[g * times], 0);
      for (std::ptrdiff_t i = half + 1; i + half < std::ptrdiff_t(times); ++i) {
        const double change = smooth(added.data() + g * times, i) - smooth(added.data() + g * times, half);
        off += std::pow(change - (expected(g, k, i) - expected(g, k, half)), 2);
        other += std::pow(change - (expected(g, k + 1, i) - expected(g, k + 1, half)), 2);
        sum += change * change;
      }
    }
    measured("off", std::sqrt(off / sum));
    measured("by_another_state", std::sqrt(other / sum));
    EXPECT_LT(off, 0.05 * 0.05 * sum);
    EXPECT_GT(other, 0.5 * 0.5 * sum);
  }
  const Records one = minus(mean_of(box("left_1 = 0.2\n", record)), base), two = minus(mean_of(box("left_2 = -0.1\n", record)), base),
                both = minus(mean_of(box("left_1 = 0.2\nleft_2 = -0.1\n", record)), base);
  EXPECT_LT(size(minus(minus(both, one), two)), 1e-9 * size(both));
}

// Where the mercury cavitates the two do not add: the pulse acts on a target that moves, and the residual motion goes on in walls without mercury.
TEST(PreviousPulses, WhereMercuryGivesWayTheEffectIsNotTheMotionAlone) {
  const auto change = [&](const std::string& mercury) {
    return minus(mean_of(box("left_1 = 0.1\n", record, mercury, 2e7)), mean_of(box("", record, mercury, 2e7)));
  };
  const Records linear = change("law = \"linear\""), cavitating = change("tensile_cutoff = 1.5e5");
  measured("difference", size(minus(cavitating, linear)) / size(linear));
  EXPECT_GT(size(minus(cavitating, linear)), 0.3 * size(linear));
}
