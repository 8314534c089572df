// What the records say of marginalised numbers: of those that are off, of those that are not, and against the formula written out.
#include "inverse/posterior/pulls.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/linear_algebra.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Four gauges whose records have gains of their own and a common energy; the model knows neither.
struct Target {
  std::vector<Parameter> parameters{normal_parameter("rate", 1, 0.02)};
  static double shape(std::size_t gauge, double rate, double t) { return 100 * std::sin(rate * 6e4 * t + 0.4 * double(gauge)) * std::exp(-t / 1e-4); }
  static AnalyticModel model(const std::vector<Parameter>& parameters, std::size_t faulty, double gain, double energy) {
    std::vector<AnalyticModel::Function> all;
    for (std::size_t g = 0; g < 4; ++g) all.emplace_back([=](auto p, double t) { return energy * (g == faulty ? gain : 1) * shape(g, p[0], t); });
    return {parameters, all, 200, 1e-6};
  }

  [[nodiscard]] PosteriorFit fitted(std::size_t faulty, double gain, double energy) const {
    const Recordings recordings = pulses_of(model(parameters, faulty, gain, energy), {1.01}, {.pulses = 10, .noise = 2, .noise_time = 3e-6}, 5);
    const RecordingOptions recording_options;
    const AnalyticModel known = model(parameters, 0, 1, 1);
    const Problem problem = make_problem(known.shape(), recordings, recording_options);
    PosteriorInputs in{.problem = problem, .recordings = recordings, .recording_options = recording_options, .errors = {.values = 160, .band = 2e5, .young_sd = 0, .beyond_sd = 0}, .emulator = {}};
    in.parameters = parameters, in.levels = 1, in.centre = {1}, in.half_width = {0.06};
    in.run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) {
        const auto mean = known.evaluate(std::vector<double>{thetas(0, Eigen::Index(i))}).mean;
        all.push_back({.done = true, .mean = {mean.begin(), mean.end()}});
      }
      return all;
    };
    return fit_posterior(in);
  }
};

TEST(Pulls, AreSmallOfNumbersThatAreAsTheyWereSaidToBe) {
  const auto all = pulls(Target().fitted(0, 1, 1));
  EXPECT_THAT(far_pulls(all, {}), IsEmpty());
  EXPECT_EQ(all.size(), 4u + 4u + 1u);  // gains, zeros, energy
}

TEST(Pulls, NameTheGaugeWhoseGainIsOff) {
  const auto all = pulls(Target().fitted(2, 1.08, 1));
  EXPECT_EQ(all[0].term, "gain");
  EXPECT_EQ(pulled_number(all[0].term, all[0].gauge), "the gain of " + all[0].gauge);
  EXPECT_NEAR(all[0].pull, 8 * (1 - all[0].sd * all[0].sd), 1);  // what the records do not say stays where it was said to be
  EXPECT_LT(all[0].sd, 0.6);
  EXPECT_THAT(far_pulls(all, {}), ElementsAre(AllOf(HasSubstr("the gain of " + all[0].gauge + " by +"), HasSubstr("errors.gain_sd), +"), HasSubstr(" %:"))));
}

TEST(Pulls, NameTheEnergyWhereAllGaugesAreOff) {
  const auto all = pulls(Target().fitted(0, 1, 0.93));
  EXPECT_EQ(all[0].term, "energy scale");
  EXPECT_NEAR(all[0].pull, -0.07 / 0.015, 1);
  EXPECT_THAT(far_pulls(all, {})[0], HasSubstr("the energy of all pulses by -"));
}

// d^T C^-1 r and 1 - d^T C^-1 d, by the dense covariance.
TEST(Pulls, AreTheFormulaWrittenOut) {
  const PosteriorFit fit = Target().fitted(1, 1.03, 1.01);
  const LocalMode& m = fit.modes[0];
  const ErrorModel& errors = fit.likeliest().errors;
  const Eigen::MatrixXd inverse = inverse_symmetric(errors.covariance() + fit.posterior->density(m.at).variance * fit.noise);
  const Eigen::VectorXd r = errors.data() - fit.prediction(m.at);
  const auto all = pulls(fit);
  for (const auto& d : errors.directions())
    for (const auto& p : all)
      if (p.term == d.term && p.gauge == d.gauge) {
        EXPECT_NEAR(p.pull, d.change.dot(inverse * r), 1e-6 * std::max(1.0, std::abs(p.pull)));
        EXPECT_NEAR(p.sd * p.sd, 1 - d.change.dot(inverse * d.change), 1e-6);
      }
}

}  // namespace
}  // namespace calomel
