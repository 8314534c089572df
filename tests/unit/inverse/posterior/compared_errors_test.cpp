// Tests posteriors on one emulator with error models that omit a term, against their formulas.
#include "inverse/posterior/compared_errors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "tests/unit/inverse/meshed.hpp"

namespace calomel {
namespace {

/// Records for vanishing element size, emulated on two meshes; the last parameter is a nuisance parameter.
struct Compared {
  Meshed exact{0}, fine{0.25}, coarse{0.5};
  Recordings recordings = recorded(exact, {13600, 1440, 1.1e4}, 12, 2e-6, 3);
  RecordingOptions recording_options;
  Problem problem = make_problem(exact.shape(), recordings, recording_options);
  PosteriorInputs in{.problem = problem, .recordings = recordings, .recording_options = recording_options};
  std::size_t own = 2;
  PosteriorFit fit;

  Compared() {
    in.errors = {.values = 120, .band = 1e6, .energy_scale_sd = 0, .gain_sd = 0.01, .beyond = 1, .beyond_sd = 0.1, .beyond_rest = 0.1, .record_noise = 1};
    in.parameters = problem.shape.parameters, in.levels = 2;
    in.centre = {13500, 1450, 1e4}, in.half_width = {0.06, 0.03, 5e3};
    in.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> records;
      for (std::size_t i = 0; i < level.size(); ++i)
        records.push_back(evaluate_run(level[i] == 0 ? fine : coarse, {thetas.col(Eigen::Index(i)).data(), std::size_t(thetas.rows())}, false));
      return records;
    };
    fit = fit_posterior(in);
  }
};

}  // namespace

TEST(ComparedPosterior, IndependentIsTheSumOverTheSamplesOfTheModelsOwnHistories) {
  const Compared c;
  const LogPosterior posterior = compared_posterior(independent_errors, c.in, c.fit, c.own);
  EXPECT_EQ(posterior.names(), (std::vector<std::string>{"density", "sound_speed"}));
  const auto by_samples = [&](const LogPosterior::Point& at) {
    const Eigen::VectorXd history = c.fit.history(at.u, 0);
    double sum = 0;
    std::size_t samples = 0;
    for (const auto& o : c.problem.observations) {
      const auto first = Eigen::Index(c.problem.shape.at(o.condition, o.sensor, 0));
      const Eigen::VectorXd own = history.segment(first, Eigen::Index(c.problem.shape.times.size()));
      const auto y = on_record_times(c.problem, {own.data(), std::size_t(own.size())});
      for (std::size_t t = 0; t < y.size(); ++t)
        if (o.banded[t]) sum += std::pow((o.mean[t] - y[t]) / (0.5 * (o.high[t] - o.low[t]) / 1.959963984540054), 2), ++samples;
    }
    EXPECT_GT(samples, 300u);
    return -0.5 * sum;
  };
  const auto a = posterior.point(posterior.q(std::vector<double>{13600, 1440, 1e4}, 0)),
             b = posterior.point(posterior.q(std::vector<double>{13450, 1446, 1e4}, 0));
  EXPECT_NEAR(a.theta[2], 1e4, 1e-6);  // the nuisance parameter at its nominal value
  const double expected = by_samples(a) - by_samples(b), got = posterior.density(a).log_likelihood - posterior.density(b).log_likelihood;
  EXPECT_GT(std::abs(expected), 10);
  EXPECT_NEAR(got, expected, 1e-5 * std::abs(expected));
}

TEST(ComparedPosterior, NoMeshErrorsKeepsTheOtherTermsAndNothingElse) {
  const Compared c;
  const LogPosterior posterior = compared_posterior(no_mesh_errors, c.in, c.fit, c.own);
  EXPECT_EQ(posterior.names(), (std::vector<std::string>{"density", "sound_speed", "damping"}));
  const auto at = posterior.point(posterior.q(c.fit.modes[0].at.theta, 0));
  EXPECT_EQ(at.beyond, 0);
  const ErrorModel bare(c.problem, c.recordings, c.recording_options, c.in.errors, {});  // without the last difference: noise, baseline and gain
  for (const auto& t : c.fit.errors->terms())
    EXPECT_TRUE(t.name == beyond_term || t.name == record_noise_term ||
                std::any_of(bare.terms().begin(), bare.terms().end(), [&](const auto& b) { return b.name == t.name; }))
        << t.name;
  const Eigen::VectorXd r = bare.data() - c.fit.coefficients * posterior.emulator().features(at.u, 0);
  const double chi2 = r.dot(Cholesky(bare.covariance()).solve(r));
  EXPECT_NEAR(posterior.density(at).chi2, chi2, 1e-6 * chi2);
  EXPECT_GT(chi2, 2 * c.fit.posterior->density(c.fit.modes[0].at).chi2);  // control: with the errors of the mesh the fit is adequate
}

TEST(ComparedPosterior, FormsAreTwo) { EXPECT_EQ(compared_forms(), (std::vector<std::string>{no_mesh_errors, independent_errors})); }

}  // namespace calomel
