#include "inverse/data/problem.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/random.hpp"
#include "inverse/objective/objective.hpp"

using namespace calomel;
using testing::HasSubstr;

namespace {

ModelShape shape_of(std::vector<std::string> sensors, std::size_t n, double step) {
  ModelShape s;
  s.conditions = {"default"};
  s.sensors = std::move(sensors);
  for (std::size_t t = 0; t < n; ++t) s.times.push_back(double(t) * step);
  return s;
}

Recordings recordings_of(std::vector<std::string> sensors, std::vector<int> pulses, std::vector<double> time) {
  Recordings r;
  r.conditions = {"default"};
  r.sensors = std::move(sensors), r.pulses = std::move(pulses), r.time = std::move(time);
  r.sensor_lines.assign(r.sensors.size(), 0);
  r.values.assign(r.sensors.size() * r.pulses.size() * r.time.size(), 0);
  r.source = "recordings.csv";
  return r;
}

/// Noisy oscillations with a dropout and an absent pulse.
Recordings noisy(std::size_t n, double step) {
  std::vector<double> time;
  for (std::size_t t = 0; t < n; ++t) time.push_back(double(t) * step);
  auto r = recordings_of({"B", "A"}, {0, 1, 2, 3}, time);
  RandomStream random(7, 0);
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t t = 0; t < n; ++t)
        r.values[r.at(0, s, p, t)] = 1e-4 * std::sin(0.3 * double(t) + double(s)) * double(t > 0) + double(t > 0) * 1e-5 * random.normal();
  r.values[r.at(0, 0, 2, 5)] = NAN;
  for (std::size_t t = 0; t < n; ++t) r.values[r.at(0, 1, 3, t)] = NAN;
  return r;
}

}  // namespace

TEST(Band, FollowsStudentsT) {
  // Quantiles of Student's t at 0.975 as printed in tables, three decimals.
  EXPECT_NEAR(band_factor(2, false), 12.706, 5e-4);
  EXPECT_NEAR(band_factor(3, false), 4.303, 5e-4);
  EXPECT_NEAR(band_factor(5, false), 2.776, 5e-4);
  EXPECT_NEAR(band_factor(11, false), 2.228, 5e-4);
  EXPECT_NEAR(band_factor(31, false), 2.042, 5e-4);
  EXPECT_NEAR(band_factor(5, true), 2.776 / std::sqrt(5.0), 5e-4);
}

TEST(Band, MeanAndWidthByHand) {
  auto r = recordings_of({"A"}, {0, 1, 2}, {0, 1});
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t p = 0; p < 3; ++p) r.values[r.at(0, 0, p, t)] = 10 + double(p) * (t == 0 ? 1 : 2);  // 10 11 12; 10 12 14: s = 1; 2
  const auto p = make_problem(shape_of({"A"}, 2, 1), r, {});
  ASSERT_EQ(p.observations.size(), 1u);
  const auto& o = p.observations[0];
  EXPECT_EQ(o.pulses, 3);
  EXPECT_DOUBLE_EQ(o.mean[0], 11);
  EXPECT_NEAR(o.low[0], 11 - 4.30265, 1e-4);
  EXPECT_NEAR(o.high[1], 12 + 2 * 4.30265, 1e-4);
  RecordingOptions of_mean;
  of_mean.band = "mean";
  EXPECT_NEAR(make_problem(shape_of({"A"}, 2, 1), r, of_mean).observations[0].high[0], 11 + 4.30265 / std::sqrt(3.0), 1e-4);
}

TEST(Band, OnePulseNeedsTheNoise) {
  auto r = recordings_of({"A"}, {4}, {0, 1});
  r.values = {3, 5};
  RecordingOptions options;
  try {
    (void)make_problem(shape_of({"A"}, 2, 1), r, options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("recordings.noise"));
  }
  options.noise = 0.5;
  const auto o = make_problem(shape_of({"A"}, 2, 1), r, options).observations[0];
  EXPECT_DOUBLE_EQ(o.low[0], 3 - 1.96 * 0.5);
  EXPECT_DOUBLE_EQ(o.high[1], 5 + 1.96 * 0.5);
}

TEST(Band, NarrowSamplesAreLeftOutAndCounted) {
  auto r = recordings_of({"A"}, {0, 1}, {0, 1, 2});
  const double values[2][3] = {{0, 99, 1.0000}, {0, 101, 1.0001}};  // no scatter at t = 0, little at t = 2
  for (std::size_t p = 0; p < 2; ++p)
    for (std::size_t t = 0; t < 3; ++t) r.values[r.at(0, 0, p, t)] = values[p][t];
  const auto p = make_problem(shape_of({"A"}, 3, 1), r, {});
  EXPECT_EQ(p.observations[0].narrow, 2u);
  // A simulation that is far from the record only at excluded samples is still wholly inside and has no excess.
  const std::vector<double> y{50, 100, -50};
  const Score s = score(p, y);
  EXPECT_EQ(s.accuracy, 100);
  EXPECT_EQ(s.delta2, 0);
  EXPECT_NEAR(s.mae, 1e6 * (50 + 0 + 51.00005) / 3, 1);
}

/// Three gauges with noise of standard deviation 1; the signal of the last has this size about an offset.
Problem with_a_quiet_gauge(double size, double offset = 0, double noise = 1) {
  const std::size_t n = 200;
  std::vector<double> time;
  for (std::size_t t = 0; t < n; ++t) time.push_back(1e-6 * double(t));
  auto r = recordings_of({"A", "B", "C"}, {0, 1, 2, 3}, time);
  RandomStream random(11, 0);
  for (std::size_t s = 0; s < 3; ++s)
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t t = 0; t < n; ++t)
        r.values[r.at(0, s, p, t)] =
            s < 2 ? 100 * std::sin(0.3 * double(t)) + random.normal() : offset + size * std::sin(0.3 * double(t)) + noise * random.normal();
  return make_problem(shape_of({"A", "B", "C"}, n, 1e-6), r, {});
}

TEST(DeadGauge, IsOneThatRecordsItsNoiseAlone) {
  for (const auto& p : {with_a_quiet_gauge(0), with_a_quiet_gauge(0, 0, 0), with_a_quiet_gauge(0, 7, 0)}) {  // noise only, nothing, a value that never changes
    EXPECT_EQ(p.observations.size(), 2u);
    EXPECT_THAT(p.dead, testing::ElementsAre("C"));
  }
}

TEST(DeadGauge, IsNotAQuietOneWhoseRecordStandsOutOfItsNoise) {
  EXPECT_THAT(with_a_quiet_gauge(2).dead,
              testing::IsEmpty());  // half of its mean square is the noise of one pulse; the noise of the mean of four pulses is an eighth of it
  EXPECT_THAT(with_a_quiet_gauge(15, 0, 40).dead, testing::IsEmpty());  // noise hides the gauge, but would hide the others as much: it is not small beside them
}

TEST(DeadGauge, AllOfThemAreAnError) {
  auto r = recordings_of({"A"}, {0, 1}, {0, 1, 2});
  EXPECT_THROW((void)make_problem(shape_of({"A"}, 3, 1), r, {}), InputError);
}

TEST(Score, TheBandIsOpen) {
  auto r = recordings_of({"A"}, {0, 1}, {0, 1, 2, 3});
  for (std::size_t t = 0; t < 4; ++t) r.values[r.at(0, 0, 0, t)] = 9, r.values[r.at(0, 0, 1, t)] = 11;
  const auto p = make_problem(shape_of({"A"}, 4, 1), r, {});
  const auto& o = p.observations[0];
  const std::vector<double> y{o.low[0], o.high[1], std::nextafter(o.low[2], 100), std::nextafter(o.high[3], 0)};
  EXPECT_EQ(score(p, y).accuracy, 50);  // the two samples on the very edge are outside
}

TEST(Score, AgreesWithBruteForce) {
  const std::size_t n = 60;
  const auto r = noisy(n, 1e-6);
  const auto shape = shape_of({"A", "C", "B"}, n, 1e-6);  // the sensors are in another order, and one is not recorded
  const auto p = make_problem(shape, r, {});
  EXPECT_TRUE(p.same_grid);
  ASSERT_EQ(p.observations.size(), 2u);
  RandomStream random(3, 1);
  std::vector<double> y(shape.values());
  for (auto& v : y) v = 1e-4 * random.normal();
  const Score s = score(p, y);

  double accuracy = 0, mae = 0, delta1 = 0, delta2 = 0;
  for (const auto& [recorded, modelled] : {std::pair{1, 0}, std::pair{0, 2}}) {
    double peak = 0, absolute = 0, squares = 0, norm = 0, over = 0, under = 0, inside = 0, banded = 0;
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t t = 0; t < n; ++t) {
        std::vector<double> v;
        for (std::size_t k = 0; k < 4; ++k)
          if (const double x = r.values[r.at(0, std::size_t(recorded), k, t)]; !std::isnan(x)) v.push_back(x);
        double m = 0, q = 0;
        for (const double x : v) m += x / double(v.size());
        for (const double x : v) q += (x - m) * (x - m);
        peak = std::max(peak, std::abs(m));
        if (pass == 0) continue;
        const double half = (v.size() == 4 ? 3.182446305 : 4.302652730) * std::sqrt(q / double(v.size() - 1));
        const double x = y[shape.at(0, std::size_t(modelled), t)];
        absolute += std::abs(x - m), squares += (x - m) * (x - m), norm += m * m;
        if (2 * half < 0.01 * peak) continue;
        ++banded, inside += x > m - half && x < m + half;
        over = std::max(over, (x - m - half) / (2 * half)), under = std::max(under, (m - half - x) / (2 * half));
      }
    accuracy += 50 * inside / banded, mae += 0.5e6 * absolute / double(n), delta1 += std::sqrt(squares / norm), delta2 += over + under;
  }
  EXPECT_GT(s.accuracy, 5);
  EXPECT_LT(s.accuracy, 95);
  EXPECT_NEAR(s.accuracy, accuracy, 1e-9);
  EXPECT_NEAR(s.mae, mae, 1e-7 * mae);
  EXPECT_NEAR(s.delta1, delta1, 1e-7 * delta1);
  EXPECT_NEAR(s.delta2, delta2, 1e-6 * delta2);
  EXPECT_NEAR(s.nrmse, delta1 / 2, 1e-7 * delta1);
  EXPECT_NEAR(objectives().get("paper_enc").value(s), accuracy - mae, 1e-6 * mae);
  EXPECT_NEAR(objectives().get("paper_spe").value(s), delta1 + 5 * delta2, 1e-6 * (delta1 + 5 * delta2));
}

TEST(Score, BatchAgreesWithSingle) {
  for (const double record_step : {1e-6, 0.7e-6}) {  // the same grid, and a different one
    const auto r = noisy(80, record_step);
    const auto shape = shape_of({"A", "C", "B"}, 64, 1e-6);
    const auto p = make_problem(shape, r, {});
    EXPECT_EQ(p.same_grid, record_step == 1e-6);
    EXPECT_EQ(p.outside > 0, record_step == 1e-6);
    RandomStream random(3, 2);
    Eigen::MatrixXf values(Eigen::Index(shape.values()), 7);
    for (Eigen::Index i = 0; i < values.size(); ++i) values(i) = float(1e-4 * random.normal());
    values(3, 5) = NAN;
    const auto batch = score_batch(p, values);
    for (Eigen::Index i = 0; i < 7; ++i) {
      std::vector<double> y(values.col(i).begin(), values.col(i).end());
      const Score s = score(p, y);
      if (i == 5) {
        EXPECT_FALSE(s.ok);
        EXPECT_TRUE(std::isnan(batch.mae[5]));
        EXPECT_EQ(objectives().get("paper_enc").costs(p, values)[5], INFINITY);
        continue;
      }
      EXPECT_NEAR(batch.accuracy[std::size_t(i)], s.accuracy, 1.0);  // in single precision a sample on the edge may fall on the other side
      EXPECT_NEAR(batch.mae[std::size_t(i)], s.mae, 2e-5 * s.mae);
      EXPECT_NEAR(batch.delta1[std::size_t(i)], s.delta1, 2e-5 * s.delta1);
      EXPECT_NEAR(batch.delta2[std::size_t(i)], s.delta2, 2e-4 * s.delta2);
      EXPECT_NEAR(objectives().get("paper_enc").costs(p, values)[std::size_t(i)], s.mae - s.accuracy, 1.0);
    }
  }
}

TEST(Score, InterpolationIsExactForParabolasAndThirdOrderForWaves) {
  const auto error = [](double step) {
    const auto shape = shape_of({"A"}, std::size_t(std::lround(1 / step)) + 1, step);
    std::vector<double> time;
    for (int i = 0; i <= 97; ++i) time.push_back(i / 97.0);
    auto r = recordings_of({"A"}, {0}, time);
    r.values.assign(r.values.size(), 1);
    RecordingOptions options;
    options.noise = 1;
    const auto p = make_problem(shape, r, options);
    std::vector<double> parabola, wave;
    for (const double t : shape.times) parabola.push_back(1 - 2 * t + 3 * t * t), wave.push_back(std::sin(6 * t));
    const auto a = on_record_times(p, parabola), b = on_record_times(p, wave);
    double worst = 0;
    for (std::size_t i = 0; i < time.size(); ++i) {
      EXPECT_NEAR(a[i], 1 - 2 * time[i] + 3 * time[i] * time[i], 1e-12);
      worst = std::max(worst, std::abs(b[i] - std::sin(6 * time[i])));
    }
    return worst;
  };
  const double coarse = error(1.0 / 40), fine = error(1.0 / 80);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_GT(coarse / fine, 6);  // third order gives 8 at the ends, fourth order 16 inside
}

TEST(Problem, ComparesWithinTheOverlapAndReportsTheRest) {
  auto r = recordings_of({"A"}, {0}, {-1, 0, 1, 2, 3});
  r.values = {9, 0, 1, 2, 3};
  RecordingOptions options;
  options.noise = 1;
  const auto p = make_problem(shape_of({"A"}, 3, 1), r, options);
  EXPECT_EQ(p.time, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(p.outside, 2u);
  EXPECT_THAT(p.warnings, testing::Contains(HasSubstr("2 of 5")));
  for (auto& t : r.time) t += 100;
  EXPECT_THROW((void)make_problem(shape_of({"A"}, 3, 1), r, options), InputError);
}

TEST(Problem, ASingleSampleInCommonIsAnError) {
  auto r = recordings_of({"A"}, {0, 1}, {0, 10, 20});  // microseconds in a column of seconds
  r.values = {1, 2, 3, 4, 5, 6};
  try {
    (void)make_problem(shape_of({"A"}, 3, 1), r, {});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("a single sample"), HasSubstr("unit of time")));
  }
  r = recordings_of({"A"}, {0, 1}, {0});  // for a model with a single value this is not an error
  r.values = {1, 2};
  EXPECT_EQ(make_problem(shape_of({"A"}, 1, 1), r, {}).time.size(), 1u);
}

TEST(Problem, AGaugeWithoutASampleIsReported) {
  auto r = recordings_of({"A", "B"}, {0, 1}, {0, 1});
  r.values = {1, 2, 3, 4, NAN, NAN, NAN, NAN};
  EXPECT_THAT(make_problem(shape_of({"A", "B"}, 2, 1), r, {}).warnings, testing::Contains(HasSubstr("sensor B has no sample")));
}

TEST(Problem, CopiesAreReported) {
  auto r = noisy(40, 1);
  EXPECT_THAT(make_problem(shape_of({"A", "B"}, 40, 1), r, {}).warnings, testing::Each(testing::Not(HasSubstr("copy"))));
  auto pulse = r;
  for (std::size_t t = 0; t < 40; ++t) pulse.values[pulse.at(0, 0, 3, t)] = pulse.values[pulse.at(0, 0, 1, t)];
  EXPECT_THAT(make_problem(shape_of({"A", "B"}, 40, 1), pulse, {}).warnings, testing::Contains(HasSubstr("sensor B: pulses 1 and 3 are the same")));
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t t = 0; t < 40; ++t) r.values[r.at(0, 1, p, t)] = r.values[r.at(0, 0, p, t)];
  EXPECT_THAT(make_problem(shape_of({"A", "B"}, 40, 1), r, {}).warnings, testing::Contains(HasSubstr("sensors A and B have the same record")));
}

TEST(Problem, NoiseThatIsLargerThanTheRecordIsReported) {
  auto r = recordings_of({"A"}, {0}, {0, 1, 2});
  r.values = {0, 1e-5, 2e-5};
  RecordingOptions options;
  options.noise = 1;  // microstrain given as strain
  EXPECT_THAT(make_problem(shape_of({"A"}, 3, 1), r, options).warnings, testing::Contains(HasSubstr("is recordings.noise in the data's unit?")));
  options.noise = 1e-6;
  EXPECT_THAT(make_problem(shape_of({"A"}, 3, 1), r, options).warnings, testing::Each(testing::Not(HasSubstr("recordings.noise"))));
}

TEST(Problem, ConditionsAreMatchedByName) {
  auto shape = shape_of({"A"}, 2, 1);
  shape.conditions = {"low", "high"};
  Recordings r = recordings_of({"A"}, {0}, {0, 1});
  r.conditions = {"high", "low"};
  r.values = {3, 4, 1, 2};
  RecordingOptions options;
  options.noise = 1;
  const auto p = make_problem(shape, r, options);
  ASSERT_EQ(p.observations.size(), 2u);
  EXPECT_EQ(p.observations[0].mean, (std::vector<double>{1, 2}));
  EXPECT_EQ(p.label(p.observations[1]), "A (high)");
  const std::vector<double> y{1, 2, 3, 4};
  EXPECT_EQ(score(p, y).delta1, 0);
  r.conditions[0] = "huge";
  EXPECT_THROW((void)make_problem(shape, r, options), InputError);
}

TEST(Problem, ADeadGaugeAndAForeignUnitAreErrors) {
  auto r = recordings_of({"A"}, {0, 1}, {0, 1});
  EXPECT_THROW((void)make_problem(shape_of({"A"}, 2, 1), r, {}), InputError);
  r.values = {1, 2, 3, 4}, r.unit = "Volts";
  EXPECT_THROW((void)make_problem(shape_of({"A"}, 2, 1), r, {}), InputError);
}

TEST(Problem, OtherUnitsKeepTheirMae) {
  auto r = recordings_of({"A"}, {0, 1}, {0, 1});
  r.values = {1, 2, 3, 4}, r.unit = "kPa";
  auto shape = shape_of({"A"}, 2, 1);
  shape.unit = "kPa";
  const auto p = make_problem(shape, r, {});
  const std::vector<double> y{4, 3};
  EXPECT_DOUBLE_EQ(score(p, y).mae, 1);
  EXPECT_EQ(p.mae_unit, "kPa");
}
