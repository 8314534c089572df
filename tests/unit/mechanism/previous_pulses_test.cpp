#include "forward/mechanism/previous_pulses.hpp"

#include <cmath>

#include "base/linear_algebra.hpp"
#include "forward/built_in_model.hpp"
#include "forward/sensor/channel.hpp"
#include "tests/unit/forward/small_case.hpp"
#include "tests/unit/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

struct Tone {
  double frequency, ratio, phase;
  std::vector<double> shape;
};

/// Three modes below 10 kHz, an offset that stays, and two tones above that are not to be taken for modes.
const std::vector<Tone> tones{{1200, 0.01, 0.3, {1e-4, -3e-5, 2e-5}}, {3700, 0.005, -1.1, {2e-5, 5e-5, -4e-5}}, {7900, 0.02, 2.0, {-3e-5, 1e-5, 6e-5}},
                              {14000, 0.003, 0.7, {8e-5, 8e-5, -2e-5}}, {61000, 0.002, 0.1, {3e-5, -5e-5, 4e-5}}};

RingDown ringing(double interval) {
  RingDown r{.interval = interval, .sensors = 3, .strain = {}};
  const auto times = std::size_t(std::lround(4e-3 / interval)) + 1;
  for (std::size_t s = 0; s < 3; ++s)
    for (std::size_t i = 0; i < times; ++i) {
      const double t = double(i) * interval;
      double y = t < 0.9e-3 ? 1e-4 * std::sin(1e5 * t) : 2e-5;  // what is before the record's end does not matter
      for (const auto& [f, ratio, phase, shape] : tones) y += shape[s] * std::cos(2 * M_PI * f * t + phase) * std::exp(-ratio * 2 * M_PI * f * t);
      r.strain.push_back(y);
    }
  return r;
}

constexpr double end = 1e-3;  // of the record

}  // namespace

// Frequency, decay and shape of what rings after the record, common poles for all gauges; what is above 10 kHz is left out.
TEST(PreviousPulses, TheWetModesAreThoseOfTheLateRingDown) {
  for (const double interval : {1e-6, 2e-6}) {
    const auto modes = wet_modes(ringing(interval), end);
    ASSERT_EQ(modes.size(), 3u);
    for (std::size_t j = 0; j < 3; ++j) {
      const auto& [f, ratio, phase, shape] = tones[j];
      const double omega = 2 * M_PI * f, left = std::exp(-ratio * omega * end), sign = modes[j].shape[0] * shape[0] > 0 ? 1 : -1;
      EXPECT_NEAR(modes[j].omega, omega, 1e-4 * omega);
      EXPECT_NEAR(modes[j].decay, ratio * omega, 0.01 * ratio * omega);
      for (std::size_t s = 0; s < 3; ++s) EXPECT_NEAR(sign * modes[j].shape[s], left * shape[s], 0.01 * left * 1e-4);
    }
    EXPECT_EQ(wet_modes(ringing(interval), end, 2).size(), 2u);
    EXPECT_EQ(wet_modes(ringing(interval), end, 8, 5000).size(), 2u);
  }
}

// s(t) = r(t) - r(0) with amplitudes common to all gauges, linear in them; a mode that the model does not have is an error.
TEST(PreviousPulses, AddsTheLawOfTheTable) {
  const RingDown r = ringing(1e-6);
  const auto modes = wet_modes(r, end);
  const auto entry = previous_pulses();
  const double interval = 2e-6;
  const std::size_t times = std::size_t(end / interval) + 1;
  const auto added = [&](const std::map<std::string, double>& set) {
    std::vector<double> y(3 * times, 0);
    entry.superpose(values_of(entry, set), r, interval, y);
    return y;
  };
  const auto y = added({{"cos_1", 0.4}, {"sin_1", -0.2}, {"cos_3", -0.1}}), first = added({{"cos_1", 0.4}, {"sin_1", -0.2}}), third = added({{"cos_3", -0.1}}), twice = added({{"cos_3", -0.2}});
  for (std::size_t s = 0; s < 3; ++s)
    for (std::size_t i = 0; i < times; ++i) {
      const double t = double(i) * interval;
      const auto at = [&](const WetMode& m, double a, double b) { return m.shape[s] * ((a * std::cos(m.omega * t) + b * std::sin(m.omega * t)) * std::exp(-m.decay * t) - a); };
      EXPECT_NEAR(y[s * times + i], at(modes[0], 0.4, -0.2) + at(modes[2], -0.1, 0), 1e-15);
      EXPECT_NEAR(first[s * times + i] + third[s * times + i], y[s * times + i], 1e-15);
      EXPECT_NEAR(twice[s * times + i], 2 * third[s * times + i], 1e-15);
      if (i == 0) EXPECT_EQ(y[s * times], 0);
    }
  EXPECT_GT(std::abs(y[times - 1]), 1e-6);
  try {
    (void)added({{"sin_4", 0.1}});
    FAIL() << "it should have been refused";
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().key, "mechanism.previous_pulses.sin_4");
    EXPECT_THAT(e.what(), HasSubstr("rings in 3 wet modes"));
  }
}

namespace {

/// A box of mercury that never gives way, one lively record.
ForwardCase box(const std::string& mechanism, double record, const std::string& rest = "") {
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
law = "linear"
[load]
peak_pressure = 1e6
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
)" + rest + (mechanism.empty() ? "" : "[mechanism.previous_pulses]\nenabled = true\n" + mechanism));
  return ForwardCase::read(file);
}

}  // namespace

namespace {

/// What is left of the signals (sensor, time) after `from`, low-passed, when the modes with amplitudes A_j and B_j common to all gauges are fitted, and the constant strain of each
/// under the heat: residue over signal without that constant.
double left_by(const std::vector<WetMode>& modes, std::vector<double> strain, std::size_t sensors, double interval, double from) {
  const std::size_t times = strain.size() / sensors, first = std::size_t(from / interval), unknowns = 2 * modes.size() + sensors;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(Eigen::Index(unknowns), Eigen::Index(unknowns));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(Eigen::Index(unknowns));
  double squares = 0;
  for (std::size_t s = 0; s < sensors; ++s) {
    const std::span<double> y(strain.data() + s * times, times);
    for (int pass = 0; pass < 3; ++pass) low_pass(7e3, interval, y);
    double mean = 0;
    for (std::size_t i = first; i < times; ++i) mean += y[i] / double(times - first);
    for (std::size_t i = first; i < times; ++i) {
      Eigen::VectorXd a = Eigen::VectorXd::Zero(Eigen::Index(unknowns));
      a(Eigen::Index(2 * modes.size() + s)) = 1;
      const double t = double(i - first) * interval;
      for (std::size_t j = 0; j < modes.size(); ++j) {
        const double scale = modes[j].shape[s] * std::exp(-modes[j].decay * t);
        a(Eigen::Index(2 * j)) = scale * std::cos(modes[j].omega * t), a(Eigen::Index(2 * j + 1)) = scale * std::sin(modes[j].omega * t);
      }
      normal += a * a.transpose(), right += (y[i] - mean) * a, squares += (y[i] - mean) * (y[i] - mean);
    }
  }
  return std::sqrt(std::max(0.0, 1 - right.dot(solve_symmetric(normal, right)) / squares));
}

}  // namespace

// Of a model: its modes explain its own longer record with amplitudes that all gauges share, which modes of another tune or shape do not. What is added is the same in every run
// of the mean.
TEST(PreviousPulses, TheModesOfAModelExplainItsLongerRecord) {
  const double record = 0.8e-3;
  const auto whole = BuiltInModel(box("", 5e-3), {.pulses = 1}).evaluate({});
  ASSERT_TRUE(whole.ok);
  const auto modes = wet_modes({4e-6, 2, whole.mean}, record);
  ASSERT_GT(modes.size(), 2u);
  auto other_shape = modes, other_tune = modes;
  for (auto& m : other_shape) m.shape[1] *= -1;
  for (auto& m : other_tune) m.omega *= 1.03;
  const double own = left_by(modes, whole.mean, 2, 4e-6, 2e-3);
  measured("modes", double(modes.size())), measured("first", modes[0].omega / (2 * M_PI)), measured("left", own);
  measured("of_another_shape", left_by(other_shape, whole.mean, 2, 4e-6, 2e-3)), measured("of_another_tune", left_by(other_tune, whole.mean, 2, 4e-6, 2e-3));
  EXPECT_LT(own, 0.05);
  EXPECT_GT(left_by(other_shape, whole.mean, 2, 4e-6, 2e-3), 0.1);
  EXPECT_GT(left_by(other_tune, whole.mean, 2, 4e-6, 2e-3), 0.1);

  const auto evaluate = [&](const std::string& mechanism, int pulses, const std::string& rest = "") {
    const auto p = BuiltInModel(box(mechanism, record, rest), {.pulses = pulses}).evaluate({});
    EXPECT_TRUE(p.ok) << p.message;
    return p;
  };
  const auto base = evaluate("", 3), with = evaluate("cos_1 = 0.5\nsin_2 = 0.3\n", 3), weak = evaluate("cos_1 = 0.25\nsin_2 = 0.15\n", 3);
  const std::size_t values = base.mean.size();
  const double size = *std::max_element(base.mean.begin(), base.mean.end());
  double greatest = 0;
  for (std::size_t i = 0; i < values; ++i) {
    const double added = with.mean[i] - base.mean[i];
    greatest = std::max(greatest, std::abs(added));
    EXPECT_NEAR(weak.mean[i] - base.mean[i], 0.5 * added, 1e-15);
    for (std::size_t r = 0; r < 3; ++r) EXPECT_NEAR(with.pulses[r * values + i] - base.pulses[r * values + i], added, 1e-6 * size);  // kept in single precision
  }
  measured("added_over_pulse", greatest / size);
  EXPECT_GT(greatest, 0.01 * size);
  EXPECT_EQ(with.mean[0], base.mean[0]);
  EXPECT_EQ(with.mean[values / 2], base.mean[values / 2]);
}
