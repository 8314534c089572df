// Tests the posterior on the multilevel emulator: its density against the formula, its gradient against differences, its mode and evidence against
// closed forms, and the whole fit on a model with known errors of its meshes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "forward/campaign/campaign.hpp"
#include "forward/emulator/infill.hpp"
#include "inverse/posterior/basin.hpp"
#include "inverse/posterior/multistart_least_squares.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "tests/unit/inverse/lines.hpp"
#include "tests/unit/inverse/meshed.hpp"

namespace calomel {
namespace {

/// Two sensors that are linear in two parameters; the error of the coarse mesh is a constant and a gradient.
struct Lines {
  std::vector<Parameter> parameters{normal_parameter("a", 2, 0.5), uniform_parameter("b", -4, 4, 0)};
  AnalyticModel fine{
      parameters, {[](auto p, double t) { return p[0] * (1 + t / 3e-5); }, [](auto p, double t) { return p[1] * std::cos(4e4 * t) - p[0]; }}, 60, 1e-6};
  AnalyticModel coarse{parameters,
                       {[](auto p, double t) { return p[0] * (1 + t / 3e-5) + 0.1; }, [](auto p, double t) { return 1.05 * p[1] * std::cos(4e4 * t) - p[0]; }},
                       60,
                       1e-6};
  Recordings recordings = pulses_of(fine, {2.2, 0.7}, {.pulses = 8, .noise = 0.5}, 3);
  RecordingOptions recording_options;
  Problem problem = make_problem(fine.shape(), recordings, recording_options);
  ErrorOptions errors{
      .values = 40, .band = 1e6, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0, .coherent_noise = 0, .beyond = 0, .beyond_sd = 0, .beyond_rest = 0};
  EmulatorBox box{parameters, std::vector<double>{0.5, -3}, std::vector<double>{3.5, 3}};

  /// 20 coarse and 8 fine runs with numerical noise.
  [[nodiscard]] LogPosterior posterior(double noise, const ErrorOptions& with) const {
    RandomStream random(7, 0);
    const Eigen::MatrixXd u = first_design(2, 20, 4);
    EmulatorRuns runs{.u = Eigen::MatrixXd(2, 28), .level = {}, .levels = 2};
    Eigen::MatrixXd histories(120, 28);
    for (Eigen::Index i = 0; i < 28; ++i) {
      runs.level.push_back(i < 20 ? 1 : 0), runs.u.col(i) = u.col(i % 20);
      const auto p = (i < 20 ? coarse : fine).evaluate(box.theta(runs.u.col(i)));
      for (Eigen::Index v = 0; v < 120; ++v) histories(v, i) = p.mean[std::size_t(v)] + noise * random.normal();
    }
    const ErrorModel model(problem, recordings, recording_options, with, {});
    const Eigen::MatrixXd outputs = model.grid().apply(histories);
    const MultilevelRegression e(runs, outputs, Eigen::VectorXd::Ones(outputs.rows()));
    return {box,
            e,
            e.fit(outputs),
            {{model}},
            numerical_noise(model.grid(), e.residuals(outputs), e.freedom(), 25e-6),
            {Prior(parameters[0]), Prior(parameters[1])},
            {with.beyond, with.beyond_sd}};
  }
};

TEST(LogPosterior, IsTheFormulaWrittenOut) {
  const Lines lines;
  const auto with = lines.errors;
  const LogPosterior posterior = lines.posterior(0.3, with);
  const auto q = posterior.q(std::vector<double>{2.4, 0.5}, 0);
  const auto at = posterior.point(q);
  EXPECT_NEAR(at.theta[0], 2.4, 1e-9);
  EXPECT_NEAR(at.theta[1], 0.5, 1e-9);
  // Dense Gaussian with the covariance errors + v noise.
  const ErrorModel model(lines.problem, lines.recordings, lines.recording_options, with, {});
  RandomStream random(7, 0);
  Eigen::MatrixXd u = first_design(2, 20, 4), histories(120, 28);
  EmulatorRuns runs{.u = Eigen::MatrixXd(2, 28), .level = {}, .levels = 2};
  for (Eigen::Index i = 0; i < 28; ++i) {
    runs.level.push_back(i < 20 ? 1 : 0), runs.u.col(i) = u.col(i % 20);
    const auto p = (i < 20 ? lines.coarse : lines.fine).evaluate(lines.box.theta(runs.u.col(i)));
    for (Eigen::Index v = 0; v < 120; ++v) histories(v, i) = p.mean[std::size_t(v)] + 0.3 * random.normal();
  }
  const Eigen::MatrixXd outputs = model.grid().apply(histories);
  const MultilevelRegression e(runs, outputs, Eigen::VectorXd::Ones(outputs.rows()));
  const Eigen::VectorXd x = e.features(at.u, 0), r = model.data() - e.fit(outputs) * x;
  const double v = e.variance(x);
  EXPECT_GT(v, 0.05);
  const Eigen::MatrixXd c = model.covariance() + v * numerical_noise(model.grid(), e.residuals(outputs), e.freedom(), 25e-6);
  const Cholesky factor(c);
  const double chi2 = r.dot(factor.solve(r)), log_det = 2 * factor.half_log_determinant(), p = double(r.size());
  const auto density = posterior.density(at);
  EXPECT_NEAR(density.chi2, chi2, 1e-6 * chi2);
  ASSERT_FALSE(std::isinf(model.freedom()));
  // With a noise scale estimated from replicates the Gaussian becomes a t of the same chi-squared.
  const double f = model.freedom(),
               t = std::lgamma((f + p) / 2) - std::lgamma(f / 2) - 0.5 * p * std::log(f * M_PI) - 0.5 * log_det - 0.5 * (f + p) * std::log1p(chi2 / f);
  EXPECT_NEAR(density.log_likelihood, t, 1e-6 * std::abs(t));
  EXPECT_NEAR(density.log_prior, Prior(lines.parameters[0]).log_density(2.4) - std::log(8.0), 1e-9);
  EXPECT_NEAR(posterior.whitened_residual(at, 0).squaredNorm(), chi2, 1e-6 * chi2);
}

TEST(LogPosterior, GradientsAreThoseOfDifferences) {
  const Lines lines;
  for (const bool beyond : {false, true}) {
    auto with = lines.errors;
    if (beyond) with.beyond = 0.3, with.beyond_sd = 0.2;
    const LogPosterior posterior = lines.posterior(0.3, with);
    ASSERT_EQ(posterior.dimension(), beyond ? 3 : 2);
    const Eigen::VectorXd q = posterior.q(std::vector<double>{2.6, -0.4}, 0.4);
    Eigen::VectorXd full, mode;
    const double value = posterior.log_density(q, &full);
    (void)posterior.mode_density(q, &mode);
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const double h = 1e-5;
      Eigen::VectorXd up = q, down = q;
      up[k] += h, down[k] -= h;
      EXPECT_NEAR(full[k], (posterior.log_density(up) - posterior.log_density(down)) / (2 * h), 1e-5 * std::abs(value));
      EXPECT_NEAR(mode[k], (posterior.mode_density(up) - posterior.mode_density(down)) / (2 * h), 1e-5 * std::abs(value));
    }
  }
}

// The likelihood is raised to a power. Prior and Jacobian remain, and the gradient agrees with finite differences.
TEST(LogPosterior, ToAPowerHasThatMuchLessOfTheLikelihood) {
  const Lines lines;
  const LogPosterior posterior = lines.posterior(0.3, lines.errors), weaker = posterior.to_the_power(0.5);
  const Eigen::VectorXd q = posterior.q(std::vector<double>{2.6, -0.4}, 0);
  const double likelihood = posterior.density(posterior.point(q)).log_likelihood;
  EXPECT_NEAR(posterior.log_density(q) - weaker.log_density(q), 0.5 * likelihood, 1e-9 * std::abs(likelihood));
  EXPECT_NEAR(posterior.mode_density(q) - weaker.mode_density(q), 0.5 * likelihood, 1e-9 * std::abs(likelihood));
  EXPECT_DOUBLE_EQ(weaker.density(weaker.point(q)).log_likelihood, likelihood);
  Eigen::VectorXd gradient;
  (void)weaker.log_density(q, &gradient);
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const double h = 1e-5;
    Eigen::VectorXd up = q, down = q;
    up[k] += h, down[k] -= h;
    EXPECT_NEAR(gradient[k], (weaker.log_density(up) - weaker.log_density(down)) / (2 * h), 1e-5 * std::abs(likelihood));
  }
}

TEST(LogPosterior, DensityByTheUnconstrainedCoordinatesHasTheSameMassAsByTheParameters) {
  const Lines lines;
  const LogPosterior posterior = lines.posterior(0.3, lines.errors);
  const double top = posterior.density(posterior.point(posterior.q(std::vector<double>{2.2, 0.7}, 0))).log_posterior();
  double by_theta = 0, by_q = 0, without_jacobian = 0;
  constexpr int n = 240;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      // Integral over the same rectangle about the mode in both coordinates, each with its own even grid.
      const Eigen::Vector2d low(1.7, -0.3), high(2.7, 1.7), part((i + 0.5) / n, (j + 0.5) / n);
      const Eigen::Vector2d at = low + part.cwiseProduct(high - low);
      by_theta +=
          std::exp(posterior.density(posterior.point(posterior.q(std::vector<double>{at[0], at[1]}, 0))).log_posterior() - top) * (high - low).prod() / (n * n);
      const Eigen::VectorXd q_low = posterior.q(std::vector<double>{low[0], low[1]}, 0), q_high = posterior.q(std::vector<double>{high[0], high[1]}, 0);
      const Eigen::VectorXd q = q_low + part.cwiseProduct(q_high - q_low);
      by_q += std::exp(posterior.log_density(q) - top) * (q_high - q_low).prod() / (n * n);
      without_jacobian += std::exp(posterior.mode_density(q) - top) * (q_high - q_low).prod() / (n * n);
    }
  EXPECT_NEAR(by_q / by_theta, 1, 0.003);
  EXPECT_GT(std::abs(without_jacobian / by_theta - 1), 0.02);  // control: a missing Jacobian is detected
}

TEST(LocalMode, IsTheClosedFormOfALinearModelAndSoIsItsEvidence) {
  Lines lines;
  lines.errors.values = 120;
  lines.recordings = pulses_of(lines.fine, {2.2, 0.7}, {.pulses = 400, .noise = 2}, 5);  // so many replicates that the t is Gaussian
  lines.problem = make_problem(lines.fine.shape(), lines.recordings, lines.recording_options);
  const LogPosterior posterior = lines.posterior(0, lines.errors);
  const auto modes = find_modes(posterior, {posterior.q(std::vector<double>{1, -2}, 0), posterior.q(std::vector<double>{3, 2}, 0)});
  ASSERT_EQ(modes.size(), 1u);
  EXPECT_LT(modes[0].gradient, 1e-3);
  // Generalised least squares with the prior of a.
  const ErrorModel model(lines.problem, lines.recordings, lines.recording_options, lines.errors, {});
  const auto column = [&](double a, double b) {
    const auto y = lines.fine.evaluate(std::vector<double>{a, b}).mean;
    return Eigen::VectorXd(model.grid().apply(Eigen::Map<const Eigen::VectorXd>(y.data(), 120)));
  };
  Eigen::MatrixXd X(Eigen::Index(model.grid().size()), 2);
  X << column(1, 0), column(0, 1);
  const Eigen::MatrixXd inverse = inverse_symmetric(model.covariance());
  Eigen::Matrix2d information = X.transpose() * inverse * X;
  Eigen::Vector2d right = X.transpose() * inverse * model.data();
  information(0, 0) += 4, right[0] += 4 * 2;
  const Eigen::Vector2d best = information.inverse() * right;
  EXPECT_NEAR(modes[0].at.theta[0], best[0], 1e-4);
  EXPECT_NEAR(modes[0].at.theta[1], best[1], 1e-4);
  const Eigen::MatrixXd covariance = parameter_covariance(posterior, modes[0]);
  EXPECT_LT((covariance - information.inverse()).norm(), 0.01 * information.inverse().norm());
  // Evidence: y ~ N(X m, C + X P X') with a flat prior 1/8 for b, which is far wider than its likelihood.
  Eigen::Matrix2d P = Eigen::Vector2d(0.25, 1e4).asDiagonal();
  const Eigen::MatrixXd total = model.covariance() + X * P * X.transpose();
  const Cholesky factor(total);
  const Eigen::VectorXd r = model.data() - 2 * X.col(0);
  const double flat = std::log(std::sqrt(2 * M_PI * 1e4) / 8);
  const double log_z = -0.5 * r.dot(factor.solve(r)) - factor.half_log_determinant() - 0.5 * double(r.size()) * std::log(2 * M_PI) + flat;
  EXPECT_NEAR(log_evidence(posterior, modes[0]), log_z, 0.5);  // the t of 399 squares per value differs by a few hundredths
}

TEST(NumericalNoise, HasTheVarianceOfItsResidualsAndFullRank) {
  const Lines lines;
  const ErrorModel model(lines.problem, lines.recordings, lines.recording_options, lines.errors, {});
  RandomStream random(5, 0);
  const auto n = Eigen::Index(model.grid().size());
  Eigen::MatrixXd residuals(n, 12);
  for (auto& r : residuals.reshaped()) r = 0.2 * random.normal();
  const Eigen::MatrixXd c = numerical_noise(model.grid(), residuals, 12, 25e-6);
  EXPECT_NEAR(c.diagonal().mean(), 0.04, 0.01);
  const Cholesky factor(c);
  EXPECT_TRUE(factor.positive_definite());
}

/// The meshes of meshed.hpp: the records are those of vanishing element size; the fine mesh has 0.25, the coarse one 0.5.
struct Meshes {
  Meshed exact{0}, fine{0.25}, coarse{0.5};
  std::vector<double> truth{13600, 1440, 1.1e4};
  Recordings recordings = recorded(exact, truth, 12, 2e-6, 3);
  RecordingOptions recording_options;
  Problem problem = make_problem(exact.shape(), recordings, recording_options);
  int runs = 0;
  PosteriorInputs inputs() {
    PosteriorInputs in{.problem = problem, .recordings = recordings, .recording_options = recording_options};
    in.errors = {.values = 200, .band = 1e6, .energy_scale_sd = 0, .gain_sd = 0, .beyond = 1, .beyond_sd = 0.1, .beyond_rest = 0.1, .record_noise = 1};
    in.parameters = problem.shape.parameters, in.levels = 2;
    in.centre = {13500, 1450, 1e4}, in.half_width = {0.06, 0.03, 5e3};
    in.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> records;
      for (std::size_t i = 0; i < level.size(); ++i, ++runs)
        records.push_back(evaluate_run(level[i] == 0 ? fine : coarse, {thetas.col(Eigen::Index(i)).data(), std::size_t(thetas.rows())}, false));
      return records;
    };
    return in;
  }
};

TEST(FitPosterior, FindsTheTruthBeyondTheFinestMeshWithinItsDeviations) {
  Meshes meshes;
  const PosteriorFit fit = fit_posterior(meshes.inputs());
  EXPECT_TRUE(fit.settled) << fit.settling().moved;
  const auto& best = fit.modes[0];
  const Eigen::VectorXd sd = parameter_covariance(*fit.posterior, best).diagonal().cwiseSqrt();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(best.at.theta[k] - meshes.truth[k]), 3 * sd[Eigen::Index(k)]) << k;
  EXPECT_LT(sd[1] / 1440, 0.01);
  EXPECT_LT(fit.levels[0].left_out, 0.03);
  // The emulator's history at the truth, one mesh step beyond the finest, is that of vanishing element size.
  const auto exact = meshes.exact.evaluate(meshes.truth).mean;
  const Eigen::VectorXd emulated = fit.history(fit.posterior->box().u(meshes.truth), 1);
  const Eigen::Map<const Eigen::VectorXd> e(exact.data(), Eigen::Index(exact.size()));
  EXPECT_LT((emulated - e).norm() / e.norm(), 0.05);
}

TEST(FitPosterior, TheFinestMeshAloneIsBiased) {
  Meshes meshes;
  auto in = meshes.inputs();
  in.errors.beyond = 0, in.errors.beyond_sd = 0, in.errors.beyond_rest = 0;
  const PosteriorFit fit = fit_posterior(in);
  const auto& best = fit.modes[0];
  const Eigen::VectorXd sd = parameter_covariance(*fit.posterior, best).diagonal().cwiseSqrt();
  EXPECT_GT(std::abs(best.at.theta[1] - meshes.truth[1]), 3 * sd[1]);
}

TEST(FitPosterior, MovesItsBoxToAnAnswerOutsideTheFirst) {
  Meshes meshes;
  auto in = meshes.inputs();
  in.centre = {13500, 1580, 1e4};
  in.half_width = {0.06, 0.05, 5e3};
  in.emulator.rounds = 8;
  const PosteriorFit fit = fit_posterior(in);
  EXPECT_TRUE(std::any_of(fit.rounds.begin(), fit.rounds.end(), [](const auto& r) { return r.moved_box; }));
  EXPECT_NEAR(fit.modes[0].at.theta[1], 1440, 30);
}

/// A model of one parameter in [1, 2], or in bounds moved by `shift`, whose posterior lies at the upper bound; runs have no noise.
PosteriorFit fit_at_the_upper_bound(double shift, const std::function<void(const PosteriorInputs&, const PosteriorFit&)>& look = {}) {
  const AnalyticModel model({uniform_parameter("a", 1 + shift, 2 + shift, 1.5 + shift)},
                            {[shift](auto p, double t) { return 100 * std::sin((p[0] - shift) * t * 4e4); }}, 50, 1e-6, "strain");
  const auto recordings = pulses_of(model, {2 + shift}, {.pulses = 6, .noise = 1}, 3);
  const RecordingOptions options;
  const Problem problem = make_problem(model.shape(), recordings, options);
  PosteriorInputs in{.problem = problem, .recordings = recordings, .recording_options = options};
  in.errors = {
      .values = 50, .band = 1e6, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0, .coherent_noise = 0, .beyond = 0, .beyond_sd = 0, .beyond_rest = 0};
  in.parameters = problem.shape.parameters;
  in.box.kind = BoxStrategy::Kind::shrink;
  in.centre = {1.8 + shift};
  in.half_width = {0.2};
  in.run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
    std::vector<RunRecord> records;
    for (std::size_t i = 0; i < level.size(); ++i) records.push_back(evaluate_run(model, {thetas.col(Eigen::Index(i)).data(), 1}, false));
    return records;
  };
  PosteriorFit fit = fit_posterior(in);
  if (look) look(in, fit);
  return fit;
}

// The sign of a bound does not matter: a box that reaches a bound is not moved again and again.
TEST(FitPosterior, SettlesAtAnUpperBoundBelowZeroAsAtOneAbove) {
  const PosteriorFit above = fit_at_the_upper_bound(0), below = fit_at_the_upper_bound(-5);
  EXPECT_TRUE(above.settled) << above.settling().moved;
  EXPECT_TRUE(below.settled) << below.settling().moved;
  EXPECT_NEAR(below.modes[0].at.theta[0], above.modes[0].at.theta[0] - 5, 1e-3);
}

// If runs have no noise, the emulator's error is not an error of the records: prediction and evidence at the mode are those of the run there.
TEST(HeldToTheModel, AnExactModelIsItsRunAtTheMode) {
  fit_at_the_upper_bound(0, [](const PosteriorInputs& in, const PosteriorFit& fit) {
    const PosteriorFit held = held_to_the_model(in, fit);
    const LocalMode& m = held.modes[0];
    ASSERT_EQ(held.run_at_mode.size(), 50);
    const Eigen::VectorXd run = held.errors->grid().apply(held.run_at_mode);
    EXPECT_LT((held.prediction(m.at) - run).norm(), 1e-9 * run.norm());
    EXPECT_NEAR(held.posterior->density(m.at).log_likelihood, fit.posterior->log_likelihood_of(run, 0), 1e-6);
    EXPECT_NEAR(m.at.theta[0], fit.modes[0].at.theta[0], 1e-3);
    // An emulator that is far off at its mode is corrected by runs of the model. By itself it assigns high probability to the wrong place.
    PosteriorFit off = fit;
    off.coefficients.col(0).array() += 5;
    off.noise = 25 * Eigen::MatrixXd::Ones(50, 50) + Eigen::MatrixXd::Identity(50, 50);
    off.posterior.emplace(off.under(off.hypotheses));
    off.modes = find_modes(*off.posterior, {off.modes[0].q});
    const PosteriorFit back = held_to_the_model(in, off);
    EXPECT_NEAR(back.modes[0].at.theta[0], m.at.theta[0], 1e-3);
    EXPECT_NEAR(back.posterior->density(back.modes[0].at).log_likelihood, held.posterior->density(m.at).log_likelihood, 0.1);
  });
}

TEST(FitPosterior, ReportsThatTooFewRunsSucceeded) {
  Meshes meshes;
  auto in = meshes.inputs();
  in.run = [](const Eigen::MatrixXd&, const std::vector<int>& level) { return std::vector<RunRecord>(level.size(), {.message = "the step collapsed"}); };
  try {
    (void)fit_posterior(in);
    FAIL();
  } catch (const NumericsError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("the step collapsed"));
  }
}

TEST(FindBasin, AFewRunsOfTheFinestMeshTakeItFromTheCoarseMeshsAnswerToTheirs) {
  // The surrogate is of a mesh twice as coarse as the finest; its own basin has a sound speed that is 4 % too high.
  Meshes meshes;
  const Meshed surrogate{0.5}, fine{0.05};
  int runs = 0;
  const FineRun run = [&](const std::vector<double>& theta) {
    ++runs;
    return fine.evaluate(theta).mean;
  };
  const auto basin = [&](const FineRun& f) { return find_basin(meshes.problem, meshes.recordings, {}, {.values = 200, .band = 1e6}, surrogate, 0.1, f, 1, 1); };
  const auto coarse = basin({}), corrected = basin(run);
  const auto off = [&](const std::vector<double>& t, std::size_t k) { return std::abs(t[k] / meshes.truth[k] - 1); };
  EXPECT_GT(off(coarse, 0), 0.02);
  EXPECT_LT(off(corrected, 0), 0.5 * off(coarse, 0));
  EXPECT_LT(off(corrected, 1), 0.01);
  EXPECT_LE(runs, 6);
}

}  // namespace
}  // namespace calomel
