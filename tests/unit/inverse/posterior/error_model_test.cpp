// Tests the covariance of the mean records against its parts, written out as dense matrices or simulated.
#include "inverse/posterior/error_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

AnalyticModel waves(std::size_t times = 300, double step = 1e-6) {
  return {{uniform_parameter("amplitude", 0.1, 10, 1)},
          {[](auto theta, double t) { return theta[0] * 100 * std::sin(6e4 * t); }, [](auto theta, double t) { return theta[0] * 60 * std::sin(9e4 * t); }},
          times,
          step};
}

TEST(Decimation, IsLinearTheSameForRecordAndModelAndKeepsConstants) {
  const auto model = waves();
  const auto recordings = pulses_of(model, {2}, {.pulses = 2, .noise = 1}, 3);
  const Problem problem = make_problem(model.shape(), recordings, {});
  const Decimation grid(problem, 100);
  EXPECT_LE(grid.size(), 100u);
  EXPECT_EQ(grid.factor(), 6u);
  const auto y = model.evaluate(std::vector<double>{2}).mean;
  const Eigen::VectorXd decimated = grid.apply(Eigen::Map<const Eigen::VectorXd>(y.data(), Eigen::Index(y.size())));
  const Eigen::VectorXd as_record = grid.apply_record(1, {y.data() + 300, 300});
  EXPECT_LT((decimated.tail(as_record.size()) - as_record).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((grid.apply(Eigen::VectorXd::Constant(600, 7)).array() - 7).abs().maxCoeff(), 1e-12);
}

TEST(Decimation, TakesOutWhatLiesAboveTheCoarseSamplingFrequency) {
  const auto amplitude = [](double frequency) {
    // Cosine and sine are both used: near the coarse Nyquist frequency one of them alone beats with the sampling.
    const auto phase = [&](double t) { return 2 * M_PI * frequency * t; };
    const AnalyticModel model({uniform_parameter("a", 0, 2, 1)},
                              {[&](auto, double t) { return std::cos(phase(t)); }, [&](auto, double t) { return std::sin(phase(t)); }}, 600, 1e-6);
    const Problem problem = make_problem(model.shape(), pulses_of(model, {1}, {.pulses = 2, .noise = 1e-3}, 1), {});
    const Decimation grid(problem, 120);  // a value in 10 us: Nyquist frequency 50 kHz
    const auto y = model.evaluate(std::vector<double>{1}).mean;
    const Eigen::VectorXd d = grid.apply(Eigen::Map<const Eigen::VectorXd>(y.data(), 1200));
    return std::sqrt((d.segment(3, 54).squaredNorm() + d.segment(63, 54).squaredNorm()) / 54);
  };
  EXPECT_GT(amplitude(10.3e3), 0.95);
  EXPECT_NEAR(amplitude(49.3e3), 0.5 + 0.7 / 50 * 0.5, 0.02);  // its gradient there is about -1/(2 x 50 kHz)
  EXPECT_LT(amplitude(107e3), 0.03);
  EXPECT_LT(amplitude(193e3), 0.03);
}

TEST(Decimation, LeavesOutWindowsThatLackHalfTheirSamplesAndBandLimits) {
  const auto model = waves(100);
  auto recordings = pulses_of(model, {1}, {.pulses = 3, .noise = 1}, 3);
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t t = 40; t < 60; ++t) recordings.values[recordings.at(0, 0, p, t)] = std::nan("");
  const Problem problem = make_problem(model.shape(), recordings, {});
  const Decimation grid(problem, 20);
  EXPECT_EQ(grid.windows(1).size(), 10u);
  EXPECT_EQ(grid.windows(0).size(), 8u);
  for (const auto& w : grid.windows(0))
    for (const auto i : w.index) EXPECT_FALSE(i >= 40 && i < 60);
  EXPECT_EQ(Decimation(problem, 1000, 25e3).factor(), 20u);
}

// A channel that was sampled at a quarter of the others' rate has windows of its own; model and record use the same samples.
TEST(Decimation, KeepsASlowerChannel) {
  const auto model = waves(160);
  auto recordings = pulses_of(model, {1}, {.pulses = 3, .noise = 1}, 3);
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t t = 0; t < 160; ++t)
      if (t % 4 != 0) recordings.values[recordings.at(0, 0, p, t)] = std::nan("");
  const Problem problem = make_problem(model.shape(), recordings, {});
  EXPECT_EQ(Decimation(problem, 40).windows(0).size(), 20u);
  // Below its own step a channel has no samples at most times: an error is raised where the error model is made.
  const Recordings one = [&] {
    auto r = recordings;
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t t = 0; t < 160; ++t)
        if (t != 0 && t != 159) r.values[r.at(0, 0, p, t)] = std::nan("");
    return r;
  }();
  const Problem sparse = make_problem(model.shape(), one, {});
  ASSERT_TRUE(Decimation(sparse, 4, 1e3).windows(0).empty());
  EXPECT_THROW((ErrorModel(sparse, one, {}, {.values = 4, .band = 1e3}, {})), InputError);
}

TEST(FilteredCovariance, IsTheDenseProductOfFilterAndProcess) {
  const auto model = waves(60);
  const Problem problem = make_problem(model.shape(), pulses_of(model, {1}, {.pulses = 2, .noise = 1}, 1), {});
  const Decimation grid(problem, 20);
  const auto windows = grid.windows(0);
  Eigen::MatrixXd filter = Eigen::MatrixXd::Zero(Eigen::Index(windows.size()), 60);
  for (std::size_t k = 0; k < windows.size(); ++k)
    for (std::size_t i = 0; i < windows[k].index.size(); ++i) filter(Eigen::Index(k), Eigen::Index(windows[k].index[i])) = windows[k].weight[i];
  for (const double time : {0.0, 0.4e-6, 5e-6, 80e-6})
    for (const double white : {0.0, 0.3})
      for (const bool zeroed : {false, true}) {
        Eigen::MatrixXd c(60, 60);
        for (int i = 0; i < 60; ++i)
          for (int j = 0; j < 60; ++j) c(i, j) = time > 0 ? (1 - white) * std::exp(-std::abs(i - j) * 1e-6 / time) + white * (i == j) : double(i == j);
        if (zeroed) {
          Eigen::MatrixXd subtract = Eigen::MatrixXd::Identity(60, 60);
          subtract.col(0).array() -= 1;
          c = subtract * c * subtract.transpose();
        }
        const Eigen::MatrixXd expected = filter * c * filter.transpose();
        EXPECT_LT((filtered_covariance(windows, grid.record_time(), time, white, zeroed, 0) - expected).cwiseAbs().maxCoeff(), 1e-12)
            << time << ' ' << white << ' ' << zeroed;
      }
}

TEST(Correlation, TimeOfAnOrnsteinUhlenbeckProcessIsFoundWithinItsStandardError) {
  const auto model = waves(500);
  double z = 0, squares = 0;
  constexpr int sets = 12;
  for (int i = 0; i < sets; ++i) {
    const auto recordings = pulses_of(model, {1}, {.pulses = 15, .noise = 2, .noise_time = 8e-6, .energy_sd = 0.015}, 100 + std::uint64_t(i));
    const Problem problem = make_problem(model.shape(), recordings, {});
    const Decimation grid(problem, 200);
    const ReplicateNoise noise = learn_noise(problem, grid, recordings, {}, {});
    const SeriesNoise& s = noise.series[0];
    EXPECT_NEAR(s.time, 8e-6, 2.5e-6);  // about 3 standard errors: 15 pulses of 500 us have some 470 correlation times
    // Variance of one pulse after the filter.
    const double due = 4 * filtered_covariance(grid.windows(0), grid.record_time(), 8e-6, 0).diagonal().mean();
    const double mean = s.pulse.diagonal().mean(), se = due * std::sqrt(2 / s.freedom);
    z += (mean - due) / se / sets;
    squares += std::pow((mean - due) / se, 2) / sets;
  }
  EXPECT_LT(std::abs(z), 4 / std::sqrt(double(sets)));  // the standard error of the mean is 1 / sqrt(sets)
  EXPECT_LT(squares, 1 + 4 * std::sqrt(2.0 / sets));
  EXPECT_GT(squares, 0.1);
}

// A lost sample does not exclude the pulse, and where pulses end early the mean is that of fewer pulses.
TEST(ReplicateNoise, PulsesMayHaveDropoutsAndEndEarly) {
  const auto model = waves(80);
  auto recordings = pulses_of(model, {1}, {.pulses = 4, .noise = 1}, 3);
  for (std::size_t p = 0; p < 4; ++p) recordings.values[recordings.at(0, 0, p, 10 + 5 * p)] = std::nan("");  // one of each
  for (std::size_t p = 1; p < 4; ++p)
    for (std::size_t t = 60; t < 80; ++t) recordings.values[recordings.at(0, 1, p, t)] = std::nan("");
  const RecordingOptions options{.noise = 1};
  const Problem problem = make_problem(model.shape(), recordings, options);
  const ErrorOptions errors{.values = 160, .band = 1e9, .gain_sd = 0, .baseline = 0, .coherent_noise = 0};
  const ErrorModel e(problem, recordings, options, errors, {});
  const ReplicateNoise& noise = e.noise();
  EXPECT_EQ(noise.series[0].pulses, 4);
  EXPECT_FALSE(noise.series[0].given);
  EXPECT_EQ(noise.series[0].present[10], 3);
  EXPECT_EQ(noise.series[0].present[50], 4);
  EXPECT_TRUE(noise.series[1].given);  // three of its four pulses are incomplete
  const auto& terms = e.terms();
  const auto of_mean = std::find_if(terms.begin(), terms.end(), [](const auto& t) { return t.name == "noise"; });
  ASSERT_NE(of_mean, terms.end());
  EXPECT_NEAR(of_mean->covariance(80 + 30, 80 + 30), 0.25, 1e-9);
  EXPECT_NEAR(of_mean->covariance(80 + 70, 80 + 70), 1, 1e-9);
}

TEST(ReplicateNoise, EnergiesOfThePulsesAreFoundAndTakenOff) {
  const auto model = waves();
  const auto recordings = pulses_of(model, {1}, {.pulses = 20, .noise = 1, .noise_time = 5e-6, .energy_sd = 0.02}, 7);
  RandomStream random(7, 0);
  const Problem problem = make_problem(model.shape(), recordings, {});
  const Decimation grid(problem, 100);
  const ReplicateNoise noise = learn_noise(problem, grid, recordings, {}, {});
  EXPECT_NEAR(noise.energy.row(0).mean(), 1, 1e-12);
  EXPECT_NEAR(noise.energy_sd, 0.02, 4 * 0.02 / std::sqrt(2 * 19.0));
  const double due = filtered_covariance(grid.windows(0), grid.record_time(), 5e-6, 0).diagonal().mean();
  EXPECT_NEAR(noise.series[0].pulse.diagonal().mean(), due, 4 * due * std::sqrt(2 / noise.series[0].freedom));
  // With these pulses the energies would be larger by half or more.
  const double scatter = std::pow(0.02 * 100, 2) / 2;
  EXPECT_LT(noise.series[0].pulse.diagonal().mean(), 0.5 * (due + scatter));
}

TEST(ReplicateNoise, ModulationInTimeAndZeroingAreSeen) {
  const auto model = waves(400);
  const auto recordings = pulses_of(model, {1}, {.pulses = 30, .noise = 2, .noise_time = 10e-6, .zeroed = true, .growth = 2}, 11);
  const Problem problem = make_problem(model.shape(), recordings, {});
  const Decimation grid(problem, 100);
  const ReplicateNoise noise = learn_noise(problem, grid, recordings, {}, {});
  const auto& s = noise.series[0];
  ASSERT_TRUE(s.zeroed);
  const Eigen::Index n = s.pulse.rows();
  EXPECT_GT(s.modulation[n - 1], 1.8 * s.modulation[1]);
  EXPECT_LT(s.modulation[n - 1], 4.5 * s.modulation[1]);
  // Samples that are far apart share only the noise of the sample at t = 0, sd 2.
  double shared = 0;
  int count = 0;
  for (Eigen::Index i = n / 2; i < n; ++i)
    for (Eigen::Index j = n / 4; j < n / 2 - 8; ++j) shared += s.pulse(i, j), ++count;
  EXPECT_NEAR(shared / count, 4, 2.2);  // one number, from 30 pulses and a smoothed modulation
}

TEST(ReplicateNoise, DriftingPulsesRaiseTheSplitHalf) {
  const auto model = waves();
  auto recordings = pulses_of(model, {1}, {.pulses = 12, .noise = 1, .noise_time = 5e-6}, 5);
  const auto ratio = [&] {
    const Problem problem = make_problem(model.shape(), recordings, {});
    return learn_noise(problem, Decimation(problem, 100), recordings, {}, {}).split_half;
  };
  EXPECT_NEAR(ratio(), 1, 0.5);
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t p = 0; p < 12; ++p)
      for (std::size_t t = 0; t < 300; ++t) recordings.values[recordings.at(0, s, p, t)] += 0.3 * double(p);
  EXPECT_GT(ratio(), 3);
}

/// A likelihood on few values, with every term.
struct Small {
  AnalyticModel model = waves(40);
  Recordings recordings = pulses_of(model, {1}, {.pulses = 6, .noise = 2, .noise_time = 4e-6}, 2);
  Problem problem = make_problem(model.shape(), recordings, {});
};

TEST(ErrorModel, MarginalNuisancesAreTheIntegralOverThem) {
  const Small s;
  ErrorOptions off{.values = 12, .band = 1e9, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0, .coherent_noise = 0};
  ErrorOptions on = off;
  on.energy_scale_sd = 0.02;
  const ErrorModel without(s.problem, s.recordings, {}, off, {}), with(s.problem, s.recordings, {}, on, {});
  const Eigen::VectorXd r = Eigen::VectorXd::LinSpaced(without.data().size(), -1, 1.5);
  // integral N(r - x y; 0, C) N(x; 0, 0.02^2) dx, the Gaussian of both
  const Cholesky plain(without.covariance()), marginal(with.covariance());
  const auto log_density = [](const Cholesky& c, const Eigen::VectorXd& x) { return -0.5 * x.dot(c.solve(x)) - c.half_log_determinant(); };
  const auto integrand = [&](double x) {
    return std::exp(log_density(plain, r - x * without.data()) - log_density(plain, r) - 0.5 * std::pow(x / 0.02, 2)) / (0.02 * std::sqrt(2 * M_PI));
  };
  double integral = 0;
  for (int i = -80; i < 80; ++i) integral += boost::math::quadrature::gauss<double, 15>::integrate(integrand, i * 0.002, (i + 1) * 0.002);
  EXPECT_NEAR(log_density(marginal, r), log_density(plain, r) + std::log(integral), 1e-8);
}

TEST(ErrorModel, EveryTermIsInItsPlace) {
  const Small s;
  const ErrorOptions options{.values = 12, .band = 1e9, .energy_scale_sd = 0.02, .gain_sd = 0.05, .baseline = 2, .coherent_noise = 0.3, .beyond_rest = 0.5};
  ErrorDirections d;
  d.gauge_places = Eigen::MatrixXd::Zero(80, 2);  // one direction that all gauges share, one of the second gauge alone
  d.gauge_places.col(0).setConstant(3);
  d.gauge_places.col(1).tail(40).setConstant(5);
  d.last_difference = Eigen::VectorXd::Constant(80, 4);
  const ErrorModel m(s.problem, s.recordings, {}, options, d);
  const auto& grid = m.grid();
  Eigen::MatrixXd expected = std::pow(0.02, 2) * m.data() * m.data().transpose();
  for (std::size_t i = 0; i < 2; ++i) {
    const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
    const auto& noise = m.noise().series[i];
    Eigen::MatrixXd mesh(n, n);
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < n; ++b) mesh(a, b) = 4 * white_noise(grid)(std::abs(grid.times()[at + a] - grid.times()[at + b]));  // (0.5 * 4)^2
    expected.block(at, at, n, n) += noise.pulse * (std::max(1.0, m.noise().split_half) / 6 + 0.09) + mesh +
                                    std::pow(0.05, 2) * m.data().segment(at, n) * m.data().segment(at, n).transpose() +
                                    Eigen::MatrixXd::Constant(n, n, std::pow(2 * noise.sd(), 2));
  }
  const auto second = Eigen::Index(grid.offset(1)), rest = Eigen::Index(grid.size()) - second;
  expected.array() += 9;
  expected.block(second, second, rest, rest).array() += 25;
  EXPECT_LT((m.covariance() - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.maxCoeff());
  double total = 0;
  for (const auto& [source, share] : m.shares()) total += share;
  EXPECT_NEAR(total, 1, 1e-12);
}

// Records with a late clock differ from those without by the one direction of the term: the same delay of all gauges.
TEST(ErrorModel, AnUncertainTriggerIsWhatLateRecordsDifferBy) {
  constexpr double delay = 0.4e-6;
  const auto at = [](double late) {
    const AnalyticModel model(
        {uniform_parameter("a", 0, 2, 1)},
        {[=](auto, double t) { return 100 * std::sin(6e4 * (t - late)); }, [=](auto, double t) { return 60 * std::sin(9e4 * (t - late)); }}, 300, 1e-6);
    const auto recordings = pulses_of(model, {1}, {.pulses = 4, .noise = 0.5}, 3);
    return ErrorModel(make_problem(model.shape(), recordings, {}), recordings, {}, {.values = 100, .trigger_sd = delay}, {});
  };
  const ErrorModel in_time = at(0);
  const auto term = std::find_if(in_time.terms().begin(), in_time.terms().end(), [](const auto& t) { return t.name == "trigger"; });
  ASSERT_NE(term, in_time.terms().end());
  const Eigen::VectorXd change = at(delay).data() - in_time.data();
  EXPECT_LT((term->covariance - change * change.transpose()).norm(), 0.05 * term->covariance.norm());  // half of the delay times the frequency, to second order
  const ErrorModel known = in_time.without("trigger");
  EXPECT_LT(Cholesky(in_time.covariance()).solve_lower(change).squaredNorm(), 1.1);  // one deviation, and the remainder of second order
  EXPECT_GT(Cholesky(known.covariance()).solve_lower(change).squaredNorm(), 100);
}

/// A single pulse of two gauges, for which the case must give the noise.
struct OnePulse {
  AnalyticModel model = waves(40);
  Recordings recordings = pulses_of(model, {1}, {.pulses = 1, .noise = 2}, 2);
  RecordingOptions options{.noise = 2.0};
  Problem problem = make_problem(model.shape(), recordings, options);
  ErrorOptions plain{.values = 80, .band = 1e9, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0, .coherent_noise = 0};
  Eigen::MatrixXd noise = 4 * Eigen::MatrixXd::Identity(80, 80);

  [[nodiscard]] double off(const ErrorModel& m, const Eigen::MatrixXd& expected) const { return (m.covariance() - expected).cwiseAbs().maxCoeff(); }
};

TEST(ErrorModel, GivenNoiseIsIndependentOrKeepsItselfForATime) {
  OnePulse s;
  const ErrorModel m(s.problem, s.recordings, s.options, s.plain, {});
  EXPECT_LT(s.off(m, s.noise), 1e-12);
  EXPECT_TRUE(std::isinf(m.freedom()));
  s.options.noise_time = 3e-6;  // a time step is 1 us; a hundredth of the variance remains white
  const ErrorModel coloured(s.problem, s.recordings, s.options, s.plain, {});
  EXPECT_NEAR(coloured.covariance()(10, 10), 4, 1e-12);
  EXPECT_NEAR(coloured.covariance()(10, 13), 4 * 0.99 * std::exp(-1.0), 1e-9);
  EXPECT_EQ(coloured.covariance()(10, 50), 0);  // another gauge
}

// The uncertainties of gauge and beam apply to a single pulse, too. Once a target with one recorded pulse was taken as known to its noise, and earlier
// pulses were named where nothing was missing.
TEST(ErrorModel, ASinglePulseHasTheErrorsOfItsGaugesAndAnEnergyOfItsOwn) {
  OnePulse s;
  s.plain.gain_sd = 0.03;
  s.plain.energy_scale_sd = 0.02;
  s.plain.baseline = 0.5;
  const ErrorModel m(s.problem, s.recordings, s.options, s.plain, {});
  const Eigen::VectorXd y = m.data();
  Eigen::MatrixXd expected = s.noise + 4e-4 * y * y.transpose();
  for (const Eigen::Index at : {0, 40})
    expected.block(at, at, 40, 40) += 9e-4 * y.segment(at, 40) * y.segment(at, 40).transpose() + Eigen::MatrixXd::Constant(40, 40, 1);
  EXPECT_LT(s.off(m, expected), 1e-9);
  const auto with_energy = [&](const RecordingOptions& options) {
    return ErrorModel(s.problem, s.recordings, options, s.plain, {.energy_slope = {}, .gauge_places = {}, .last_difference = {}, .energy_sd = 0.04});
  };
  EXPECT_LT(s.off(with_energy(s.options), expected + 16e-4 * y * y.transpose()), 1e-9);
  s.options.energy_sd = 0.05;  // the recordings have precedence
  EXPECT_LT(s.off(with_energy(s.options), expected + 25e-4 * y * y.transpose()), 1e-9);
}

TEST(ErrorModel, NumericalNoiseIsThatOfThePulsesThatWereRecorded) {
  const Eigen::MatrixXd of_a_run = Eigen::VectorXd::LinSpaced(80, 1, 2).asDiagonal();
  OnePulse s;
  s.plain.record_noise = 0.5;
  const ErrorModel one(s.problem, s.recordings, s.options, s.plain,
                       {.energy_slope = {}, .gauge_places = {}, .last_difference = {}, .pulses = 8});  // a run is the mean over eight
  EXPECT_LT(s.off(one.with_record_noise(of_a_run), s.noise + 0.25 * 8 * of_a_run), 1e-12);
  const Small repeated;  // whose scatter gives the noise
  const ErrorModel six(repeated.problem, repeated.recordings, {}, s.plain, {.energy_slope = {}, .gauge_places = {}, .last_difference = {}, .pulses = 8});
  EXPECT_LT((six.with_record_noise(of_a_run).covariance() - six.covariance() - 0.25 * of_a_run).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Discrepancy, IsZeroBeforeTheFirstArrivalAndSharedByNeighbours) {
  const AnalyticModel model({uniform_parameter("a", 0, 2, 1)},
                            {[](auto, double t) { return t < 100e-6 ? 0.0 : 50.0; }, [](auto, double t) { return t < 50e-6 ? 0.0 : 20.0; },
                             [](auto, double t) { return t < 50e-6 ? 0.0 : 20.0; }},
                            200, 1e-6);
  const auto recordings = pulses_of(model, {1}, {.pulses = 4, .noise = 0.05}, 2);
  const Problem problem = make_problem(model.shape(), recordings, {});
  const ErrorModel l(problem, recordings, {}, {.values = 60, .band = 1e9}, {});
  Eigen::MatrixXd positions(3, 3);
  positions << 0, 0, 0, 0.03, 0, 0, 0.5, 0, 0;
  const Eigen::MatrixXd c = discrepancy_shape(problem, l.grid(), l.data(), positions, {}, matern32(15e-6));
  const Eigen::VectorXd t = l.grid().times();
  for (Eigen::Index i = 0; i < 20; ++i) {
    if (t[i] < 85e-6) {
      EXPECT_EQ(c(i, i), 0);
    } else if (t[i] > 160e-6) {
      EXPECT_NEAR(c(i, i), 2500, 2500 * 0.05);
      EXPECT_NEAR(c(i, i + 20) / std::sqrt(c(i, i) * c(i + 20, i + 20)), std::exp(-1.0), 1e-9);
      EXPECT_LT(c(i, i + 40) / std::sqrt(c(i, i) * c(i + 40, i + 40)), 1e-6);
    }
  }
  EXPECT_GE(symmetric_eigenvalues(c).minCoeff(), -1e-8 * c.trace());
  // Control: without that rule there is a little before the front, too.
  const Eigen::MatrixXd everywhere = discrepancy_shape(problem, l.grid(), l.data(), positions, {.arrival_share = 0}, matern32(15e-6));
  for (Eigen::Index i = 0; i < 20; ++i) {
    if (t[i] > 80e-6 && t[i] < 85e-6) {
      EXPECT_GT(everywhere(i, i), 1);
    }
  }
  EXPECT_NEAR(everywhere(19, 19), c(19, 19), 1e-9 * c(19, 19));
}

TEST(Discrepancy, AnAmplitudeIsNoLargerThanTheSpanOfItsRecord) {
  const Eigen::VectorXd swing = Eigen::VectorXd::LinSpaced(50, 0, 20).array().sin();
  EXPECT_NEAR(greatest_amplitude(swing), 2, 0.01);
  EXPECT_NEAR(greatest_amplitude(swing.array() + 300), greatest_amplitude(swing), 1e-9);  // an absolute temperature
  EXPECT_LT(std::sqrt(swing.squaredNorm() / 50), greatest_amplitude(swing));              // about 0 nothing is subtracted
  EXPECT_EQ(greatest_amplitude(Eigen::VectorXd::Constant(3, -5)), 5);
}

TEST(Discrepancy, InOnePlaceAloneIsAsLargeOverAllRecordsAsOneEverywhere) {
  const auto step = [](auto, double t) { return t < 50e-6 ? 0.0 : 50.0; };
  const AnalyticModel model({uniform_parameter("a", 0, 2, 1)}, {step, step, step}, 200, 1e-6);
  const auto recordings = pulses_of(model, {1}, {.pulses = 4, .noise = 0.05}, 2);
  const Problem problem = make_problem(model.shape(), recordings, {});
  const ErrorOptions options{.values = 60, .band = 1e9};
  const ErrorModel plain(problem, recordings, {}, options, {});
  Eigen::MatrixXd positions(3, 3);
  positions << 0, 0, 0, 0.03, 0, 0, 0.5, 0, 0;
  const auto places = places_of_discrepancy(problem, positions);
  EXPECT_EQ(places, (std::vector<std::vector<std::size_t>>{{0}, {0, 1}, {1}, {1, 2}, {2}}));
  const double everywhere = discrepancy_shape(problem, plain.grid(), plain.data(), positions, options, matern32(15e-6)).trace();
  for (const auto& place : places) {
    const auto local = with_local_discrepancy(plain, problem, options, positions, place);
    ASSERT_EQ(local.size(), 2u * 5);  // correlation times and scales
    double total = 0;
    for (const auto& w : local) {
      total += std::exp(w.log_weight);
      const Eigen::MatrixXd more = w.errors.covariance() - plain.covariance();
      for (Eigen::Index g = 0; g < 3; ++g)
        EXPECT_EQ(more.block(20 * g, 0, 20, 60).cwiseAbs().maxCoeff() > 0, std::find(place.begin(), place.end(), std::size_t(g)) != place.end());
      EXPECT_NEAR(more.trace() / (w.discrepancy * w.discrepancy * everywhere), 1, 0.01);
    }
    EXPECT_NEAR(total, 1, 1e-12);
  }
  EXPECT_TRUE(places_of_discrepancy(problem, {}).empty());
}

}  // namespace
}  // namespace calomel
