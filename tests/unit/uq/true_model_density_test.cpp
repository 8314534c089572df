// The posterior by runs of the true model, on a model that is a formula.
#include "uq/true_model_density.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/uq/experiment.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/posterior_density.hpp"
#include "uq/sampler/delayed_acceptance.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {
namespace {

/// Runs whose second parameter is off by so much; they fail where `fails` says so.
std::function<std::vector<RunRecord>(const Eigen::MatrixXd&, const std::vector<int>&)> runs_off_by(double off,
                                                                                                   std::function<bool(const Eigen::VectorXd&)> fails = {}) {
  return [off, fails](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
    std::vector<RunRecord> all;
    for (std::size_t i = 0; i < level.size(); ++i) {
      Eigen::VectorXd theta = thetas.col(Eigen::Index(i));
      theta[1] += off;
      all.push_back(Experiment::run(theta, level[i], {}, 1e-8));
      if (fails && fails(thetas.col(Eigen::Index(i)))) all.back() = {.done = false, .message = "failed"};
    }
    return all;
  };
}

struct Fitted {
  Experiment experiment{0, 0, 0, 1, 1};
  PosteriorInputs in = experiment.base();
  PosteriorFit fit;
  Fitted() {
    in.run = runs_off_by(0);
    in.discrepancy = false;
    fit = fit_posterior(in);
  }
  [[nodiscard]] SamplerStart start() const {
    return {.mean = fit.posterior->q(fit.modes[0].at.theta, fit.modes[0].at.beyond), .covariance = 1e-4 * Eigen::MatrixXd::Identity(3, 3), .points = {}};
  }
};

}  // namespace

TEST(TrueModelDensity, IsTheEmulatorsIfARunEqualsItsPrediction) {
  Fitted f;
  const LogPosterior& posterior = *f.fit.posterior;
  f.in.run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>&) {
    const Eigen::VectorXd theta = thetas.col(0), y = f.fit.history(posterior.box().u({theta.data(), std::size_t(theta.size())}), 0);
    RunRecord r{.done = true};
    r.mean.assign(y.data(), y.data() + y.size());
    return std::vector{r};
  };
  const TrueModelDensity exact(f.in, f.fit);
  const PosteriorDensity cheap(posterior);
  EXPECT_EQ(exact.coordinates(), cheap.coordinates());
  Eigen::VectorXd q = f.start().mean;
  for (const double beyond : {0.0, 0.3}) {
    q[2] = beyond;
    const auto at = posterior.point(q);
    const Eigen::VectorXd x = posterior.emulator().features(at.u, beyond);
    // The same prediction; the run's noise stands where the emulator's variance of the finest mesh stood.
    const double variance = 1 + posterior.emulator().variance(x - posterior.emulator().level_features(at.u, 0));
    const double expected = posterior.density(at).log_prior + posterior.log_likelihood_of(f.fit.coefficients * x, variance) +
                            (cheap.log_density({q.data(), 3}) - posterior.density(at).log_posterior());
    EXPECT_NEAR(exact.log_density({q.data(), 3}), expected, 1e-3 * (1 + std::abs(expected)));  // records keep single precision
    std::vector<double> a(3), b(3);
    exact.constrain({q.data(), 3}, a);
    cheap.constrain({q.data(), 3}, b);
    EXPECT_EQ(a, b);
  }
}

// Where the true model is another than the emulator was trained, its parameters off by a deviation, the answer moves by that, and the emulator's remains.
TEST(TrueModelDensity, DelayedAcceptanceSamplesTheTrueModel) {
  Fitted f;
  const PosteriorDensity cheap(*f.fit.posterior);
  const TrueModelDensity exact(f.in, f.fit);
  const double sd = assess(run_sampler(cheap, f.start(), {.warmup = 2000, .draws = 1000}, {.seed = 1}).quantities).parameters[1].sd;
  const auto by_runs = [&](double off) {
    f.in.run = runs_off_by(off);
    SamplerOptions options{.kind = "delayed_acceptance", .warmup = 300, .draws = 500, .thin = 1};
    options.table<DelayedAcceptanceOptions>().first_stage = 20;
    const auto r = run_sampler(cheap, exact, f.start(), options, {.seed = 2, .threads = 2});
    EXPECT_LE(r.summary.evaluations, 4u * (1 + 20 + 500));
    EXPECT_GT(r.summary.acceptance[0], 0.4);
    return assess(r.quantities).parameters[1];
  };
  const ParameterSummary as_trained = by_runs(0), moved = by_runs(sd);
  const double error = std::hypot(as_trained.mcse_mean, moved.mcse_mean);
  EXPECT_LT(error, 0.15 * sd);
  EXPECT_LT(std::abs(as_trained.mean - moved.mean - sd), 4 * error);
  EXPECT_GT(std::abs(as_trained.mean - moved.mean), 4 * error);  // control: an answer that is the emulator's would not move
}

TEST(TrueModelDensity, IsZeroWhereARunFailsAndCountsIt) {
  Fitted f;
  const double middle = f.fit.modes[0].at.theta[0];
  f.in.run = runs_off_by(0, [middle](const Eigen::VectorXd& theta) { return theta[0] > middle; });
  const TrueModelDensity exact(f.in, f.fit);
  const Eigen::VectorXd low = f.fit.posterior->q(std::vector{middle - 1e-4, 1.0}, 0.2), high = f.fit.posterior->q(std::vector{middle + 1e-4, 1.0}, 0.2);
  EXPECT_TRUE(std::isfinite(exact.log_density({low.data(), 3})));
  EXPECT_EQ(exact.log_density({high.data(), 3}), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(exact.failed(), 1u);
}

}  // namespace calomel
