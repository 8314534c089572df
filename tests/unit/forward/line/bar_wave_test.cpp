#include "forward/line/bar_wave.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace calomel {
namespace {

constexpr double speed = 5000, dt = 1e-6;

double pulse(double t) { return std::exp(-std::pow((t - 60e-6) / 10e-6, 2)); }

Signal drive() {
  Signal s{.begin = 0, .interval = dt};
  for (int i = 0; i < 300; ++i) s.value.push_back(pulse(i * dt));
  return s;
}

std::vector<std::complex<double>> undispersed(const BarWave& wave) {
  std::vector<std::complex<double>> k;
  for (const double w : wave.omega()) k.emplace_back(w / speed);
  return k;
}

TEST(BarWave, WithoutDispersionIsDelayedExactly) {
  const BarWave wave(drive(), 200e-6);
  const auto k = undispersed(wave);
  for (const double distance : {0.0, 0.5, 0.7777}) {
    const auto u = wave.at(distance, k, 3.3e-6);
    for (int i = 0; i < 400; ++i) ASSERT_NEAR(u[std::size_t(i)], pulse(i * dt - distance / speed - 3.3e-6), 1e-12) << distance << ", sample " << i;
  }
}

TEST(BarWave, IsAttenuatedAccordingToTheWavenumber) {
  // k'' = -b omega^2 makes a Gaussian exp(-t^2/s^2) one of s'^2 = s^2 + 4 b d, its area kept.
  const BarWave wave(drive(), 200e-6);
  auto k = undispersed(wave);
  const double b = 5e-11, distance = 0.5, s2 = 1e-10, wider = s2 + 4 * b * distance;
  for (std::size_t i = 0; i < k.size(); ++i) k[i] -= std::complex<double>(0, b * wave.omega()[i] * wave.omega()[i]);
  const auto u = wave.at(distance, k, 0);
  for (int i = 100; i < 250; ++i) {
    const double t = i * dt - 160e-6;
    ASSERT_NEAR(u[std::size_t(i)], std::sqrt(s2 / wider) * std::exp(-t * t / wider), 1e-9) << i;
  }
}

TEST(BarWave, OfARecordThatEndsHighHoldsUntilItsEnd) {
  Signal s{.begin = 0, .interval = dt};
  for (int i = 0; i < 300; ++i) s.value.push_back(1 / (1 + std::exp(-(i - 100.) / 8)));  // a step that remains
  const BarWave wave(s, 200e-6);
  const auto u = wave.at(0.5, undispersed(wave), 0);
  for (int i = 100; i < 400; ++i) ASSERT_NEAR(u[std::size_t(i)], s.value[std::size_t(i - 100)], 2e-5);
}

TEST(Resampled, TakesTheSamplesWhereTimesFallOnThem) {
  const std::vector<double> y{0, 1, 4, 9, 16, 25};
  EXPECT_EQ(resampled(1, 0.5, y, std::vector<double>{1, 2, 3}), (std::vector<double>{0, 4, 16}));
  const auto between = resampled(1, 0.5, y, std::vector<double>{0.5, 2.25});
  EXPECT_EQ(between[0], 0);  // before the record
  EXPECT_NEAR(between[1], 6.25, 0.05);
}

}  // namespace
}  // namespace calomel
