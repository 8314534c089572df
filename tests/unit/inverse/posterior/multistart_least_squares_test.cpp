// Tests multistart least squares for a model with cheap runs, and the width of the box about its optimum.
#include "inverse/posterior/multistart_least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

/// A wave of amplitude "a", recorded with a = 1.03 in five pulses with noise; `beside` are further parameters without effect, which are 1 in the records.
struct RecordedWave {
  explicit RecordedWave(const std::vector<Parameter>& beside = {})
      : model(with_amplitude(beside), {[](auto p, double t) { return p[0] * std::sin(6e4 * t); }}, 100, 1e-6), recordings(recorded(beside.size())) {}

  /// A run has the values of the model, each times `off()`.
  PosteriorInputs inputs(std::function<double()> off) const {
    PosteriorInputs in{.problem = problem,
                       .recordings = recordings,
                       .recording_options = options,
                       .errors = {.values = 100, .band = 5e5, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0},
                       .emulator = {}};
    in.parameters = model.shape().parameters;
    in.run = [this, off = std::move(off)](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> all(level.size());
      for (std::size_t i = 0; i < level.size(); ++i) {
        const Eigen::VectorXd theta = thetas.col(Eigen::Index(i));
        const auto p = model.evaluate({theta.data(), std::size_t(theta.size())});
        all[i].done = true;
        all[i].mean.assign(p.mean.begin(), p.mean.end());
        for (auto& v : all[i].mean) v *= float(off());
      }
      return all;
    };
    return in;
  }

  AnalyticModel model;
  Recordings recordings;
  RecordingOptions options;
  Problem problem = make_problem(model.shape(), recordings, options);

 private:
  static std::vector<Parameter> with_amplitude(const std::vector<Parameter>& beside) {
    std::vector<Parameter> all{normal_parameter("a", 1, 0.1)};
    all.insert(all.end(), beside.begin(), beside.end());
    return all;
  }
  [[nodiscard]] Recordings recorded(std::size_t beside) const {
    std::vector<double> true_values(beside + 1, 1);
    true_values[0] = 1.03;
    return pulses_of(model, true_values, {.pulses = 5, .noise = 0.01}, 3);
  }
};

// A parameter that the records do not constrain has its prior as posterior. A box of fewer deviations cuts it, and so do deviations from chains in such a box.
TEST(MultistartFit, ParametersThatTheRecordsDoNotDetermineHaveABoxOfAtLeastThreePriorDeviations) {
  Parameter idle = uniform_parameter("z", 0.01, 100, 1);
  idle.prior = "lognormal";
  idle.mu = std::log(2);
  idle.sigma = 0.7;
  const RecordedWave wave({idle});
  PosteriorInputs in = wave.inputs([] { return 1.0; });
  place_box_by_least_squares(in);
  EXPECT_NEAR(in.centre[0], 1.03, 0.02);
  EXPECT_LT(in.half_width[0], 0.2);
  EXPECT_NEAR(in.centre[1], 2, 0.02);  // in the logarithm, not in the density over z
  EXPECT_GE(in.half_width[1], 3 * 0.7);
  EXPECT_LT(in.half_width[1], 5 * 0.7);
}

// Two runs at nearly the same point differ by the numerical noise of the model. In 100 values of unit amplitude with errors of 0.01 / sqrt(5), noise of 0.2 %
// is sqrt(2) sqrt(100 / 2) 0.002 / (0.01 / sqrt(5)) = 4.5 standard errors, and spoils finite differences with a step of 0.1 % of the prior.
TEST(MultistartFit, JitterIsWhatTwoRunsOfNearlyOnePointDifferBy) {
  const RecordedWave wave;
  const auto jitter_of = [&](double share) {
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    return jitter_of_the_model(wave.inputs([&] { return 1 + share * normal(engine); })).value();
  };
  EXPECT_LT(jitter_of(0).standard_errors, 1e-3);
  EXPECT_NEAR(jitter_of(0.002).standard_errors / 4.5, 1, 0.3);
  EXPECT_NEAR(jitter_of(0.002).variance / (50 * 0.002 * 0.002), 1, 0.4);
}

}  // namespace
}  // namespace calomel
