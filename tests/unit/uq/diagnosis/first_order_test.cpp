// The evidence of numbers to first order, before they are fitted.
#include "uq/diagnosis/first_order.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "tests/unit/uq/experiment.hpp"

namespace calomel {
namespace {

/// log density of a Gaussian of this covariance, up to the constant of its dimension.
double log_gaussian(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance) {
  const Cholesky factor(covariance);
  return -0.5 * factor.solve_lower(x).squaredNorm() - factor.half_log_determinant();
}

// The evidence of a linear Gaussian model under two hypotheses about the errors, by dense covariances of the records.
TEST(FirstOrderModel, IsTheEvidenceOfTheLinearModel) {
  const PosteriorFit fit = Experiment(0, 0, 0, 1, 4).diagnosed().base.fit;
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Eigen::MatrixXd> covariances{fit.hypotheses[0].errors.covariance(), fit.hypotheses[4].errors.covariance()};
  const std::vector<double> weights{0.7, 0.3};
  std::vector<RecordErrors> errors;
  for (const std::size_t i : {0, 1}) errors.push_back({covariances[i], fit.errors->data(), infinity, std::log(weights[i])});
  const LogPosterior posterior(fit.posterior->box(), fit.posterior->emulator(), fit.coefficients, errors, fit.noise, fit.posterior->priors(),
                               fit.posterior->beyond_prior());
  const LocalMode mode = find_modes(posterior, {fit.modes[0].q}).at(0);

  const auto n = Eigen::Index(fit.errors->data().size());
  AddedDirections d{.by_number = Eigen::MatrixXd(n, 2), .prior_sd = Eigen::Vector2d(0.2, 1.5)};
  for (Eigen::Index i = 0; i < n; ++i) {
    d.by_number(i, 0) = 2e-5 * std::sin(0.07 * double(i));
    d.by_number(i, 1) = 1e-5 * std::cos(0.021 * double(i));
  }
  const Eigen::MatrixXd scaled = d.by_number * d.prior_sd.asDiagonal();

  const auto density = posterior.density(mode.at);
  const std::size_t likeliest = posterior.likeliest(mode.at);
  const Eigen::MatrixXd j = posterior.jacobian(mode.at), whitened = posterior.whiten(j, mode.at, likeliest);
  const SymmetricEigen left = symmetric_eigen(inverse_symmetric(mode.covariance) - whitened.transpose() * whitened);
  const Eigen::MatrixXd prior = left.vectors * left.values.cwiseMax(3.0).cwiseInverse().asDiagonal() * left.vectors.transpose();
  const FirstOrderModel model(posterior, mode);
  const Eigen::VectorXd change = d.by_number * Eigen::Vector2d(0.1, -0.2);
  const auto expected = model.expected(model.block({.by_number = change, .prior_sd = Eigen::VectorXd::Ones(1)}), 0, model.block(d));
  for (const double strength : {0.0, 1.0, 10.0}) {
    const Eigen::VectorXd c = strength * change;
    std::array<double, 2> with{}, without{};
    for (const std::size_t i : {0, 1}) {
      const Eigen::MatrixXd s = covariances[i] + density.variance * fit.noise, first = covariances[0] + density.variance * fit.noise;
      const double common = std::log(weights[i]) - 0.5 * inverse_symmetric(s).cwiseProduct(first).sum();
      const Eigen::MatrixXd base = s + j * prior * j.transpose();
      without[i] = common + log_gaussian(c, base);
      with[i] = common + log_gaussian(c, base + scaled * scaled.transpose());
    }
    const auto log_sum = [](const std::array<double, 2>& x) { return std::max(x[0], x[1]) + std::log1p(std::exp(-std::abs(x[0] - x[1]))); };
    const double exact = log_sum(with) - log_sum(without);
    EXPECT_NEAR(expected.log_bayes_factor(strength), exact, 1e-6 * std::max(1.0, std::abs(exact))) << strength;
    if (strength == 10.0) {
      EXPECT_GT(exact, 10);
    }
  }
  // The records themselves lie on the model: the numbers are 0 within their standard deviations.
  const FirstOrderEstimate estimate = model.estimate(d);
  EXPECT_LT(estimate.log_bayes_factor, 0);
  for (const Eigen::Index k : {0, 1}) EXPECT_LT(std::abs(estimate.value[k]), 4 * estimate.sd[k]);
}

}  // namespace
}  // namespace calomel
