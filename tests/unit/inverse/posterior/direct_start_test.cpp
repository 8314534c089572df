// Where a quick model fits its records, and how wide a box is laid about it.
#include "inverse/posterior/direct_start.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

// The posterior of what the records do not tell is its prior: a box of fewer deviations cuts it, and so do deviations that are taken from chains in it.
TEST(DirectStart, WhatTheRecordsDoNotTellHasABoxOfThreePriorDeviationsAboutItsMiddleAtLeast) {
  Parameter idle = uniform_parameter("z", 0.01, 100, 1);
  idle.prior = "lognormal", idle.mu = std::log(2), idle.sigma = 0.7;
  const AnalyticModel model({normal_parameter("a", 1, 0.1), idle}, {[](auto p, double t) { return p[0] * std::sin(6e4 * t); }}, 100, 1e-6);
  const Recordings recordings = pulses_of(model, {1.03, 1}, {.pulses = 5, .noise = 0.01}, 3);
  const RecordingOptions options;
  const Problem problem = make_problem(model.shape(), recordings, options);
  PosteriorInputs in{.problem = problem,
                     .recordings = recordings,
                     .recording_options = options,
                     .errors = {.values = 100, .band = 5e5, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0},
                     .emulator = {}};
  in.parameters = model.shape().parameters;
  in.run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
    std::vector<RunRecord> all(level.size());
    for (std::size_t i = 0; i < level.size(); ++i) {
      const Eigen::VectorXd theta = thetas.col(Eigen::Index(i));
      const auto p = model.evaluate({theta.data(), 2});
      all[i].done = true, all[i].mean.assign(p.mean.begin(), p.mean.end());
    }
    return all;
  };
  start_directly(in);
  EXPECT_NEAR(in.centre[0], 1.03, 0.02);
  EXPECT_LT(in.half_width[0], 0.2);
  EXPECT_NEAR(in.centre[1], 2, 0.02);  // of the logarithm, not of the density over z
  EXPECT_GE(in.half_width[1], 3 * 0.7);
  EXPECT_LT(in.half_width[1], 5 * 0.7);
}

// Two runs at nearly one point: what they differ by is the model's own jitter. Of 100 values of unit amplitude with errors of 0.01 / sqrt(5) a jitter of 0.2 %
// is sqrt(2) sqrt(100 / 2) 0.002 / (0.01 / sqrt(5)) = 4.5 standard errors, and drives finite differences of a step of 0.1 % of the prior astray.
TEST(DirectStart, JitterIsWhatTwoRunsOfNearlyOnePointDifferBy) {
  const AnalyticModel model({normal_parameter("a", 1, 0.1)}, {[](auto p, double t) { return p[0] * std::sin(6e4 * t); }}, 100, 1e-6);
  const Recordings recordings = pulses_of(model, {1.03}, {.pulses = 5, .noise = 0.01}, 3);
  const RecordingOptions options;
  const Problem problem = make_problem(model.shape(), recordings, options);
  const auto jitter_of = [&](double share) {
    PosteriorInputs in{.problem = problem,
                       .recordings = recordings,
                       .recording_options = options,
                       .errors = {.values = 100, .band = 5e5, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0},
                       .emulator = {}};
    in.parameters = model.shape().parameters;
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    in.run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> all(level.size());
      for (std::size_t i = 0; i < level.size(); ++i) {
        const auto p = model.evaluate({thetas.col(Eigen::Index(i)).data(), 1});
        all[i].done = true, all[i].mean.assign(p.mean.begin(), p.mean.end());
        for (auto& v : all[i].mean) v *= float(1 + share * normal(engine));
      }
      return all;
    };
    return jitter_of_the_model(in).value();
  };
  EXPECT_LT(jitter_of(0).standard_errors, 1e-3);
  EXPECT_NEAR(jitter_of(0.002).standard_errors / 4.5, 1, 0.3);
  EXPECT_NEAR(jitter_of(0.002).variance / (50 * 0.002 * 0.002), 1, 0.4);
}

}  // namespace
}  // namespace calomel
