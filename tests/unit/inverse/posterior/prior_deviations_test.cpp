// Tests the estimates of marginalised nuisance parameters with an error and without one, and compares them with the formula.
#include "inverse/posterior/prior_deviations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "tests/unit/inverse/posterior/four_gauges.hpp"

namespace calomel {
namespace {

/// Number of the deviations that are reported.
std::ptrdiff_t far_ones(const std::vector<PriorDeviation>& all) {
  return std::count_if(all.begin(), all.end(), [](const PriorDeviation& p) { return std::abs(p.deviation) > far_deviation; });
}

TEST(PriorDeviations, AreSmallWhereThePriorsAreRight) {
  const auto all = prior_deviations(residual_of(FourGauges({}).fit));
  EXPECT_EQ(far_ones(all), 0);
  EXPECT_EQ(all.size(), 4u + 4u + 1u);  // gains, zeros, energy
}

TEST(PriorDeviations, NameTheGaugeWhoseGainIsWrong) {
  const auto all = prior_deviations(residual_of(FourGauges({.gauge = 2, .gain = 1.08}).fit));
  EXPECT_EQ(all[0].term, "gain");
  EXPECT_FALSE(all[0].gauge.empty());
  EXPECT_NEAR(all[0].deviation, 8 * (1 - all[0].sd * all[0].sd), 1);  // nuisance parameters that the records do not determine remain at their prior
  EXPECT_LT(all[0].sd, 0.6);
  EXPECT_EQ(far_ones(all), 1);
}

TEST(PriorDeviations, NameTheEnergyWhereAllGaugesAreWrong) {
  const auto all = prior_deviations(residual_of(FourGauges({.energy = 0.93}).fit));
  EXPECT_EQ(all[0].term, "energy scale");
  EXPECT_NEAR(all[0].deviation, -0.07 / 0.015, 1);
  EXPECT_LT(all[0].deviation, -far_deviation);
}

// d^T C^-1 r and 1 - d^T C^-1 d, with the dense covariance.
TEST(PriorDeviations, AreTheFormulaWrittenOut) {
  const FourGauges target({.gauge = 1, .gain = 1.03, .energy = 1.01});
  const PosteriorFit& fit = target.fit;
  const LocalMode& m = fit.modes[0];
  const ErrorModel& errors = fit.likeliest().errors;
  const Eigen::MatrixXd inverse = inverse_symmetric(errors.covariance() + fit.posterior->density(m.at).variance * fit.noise);
  const Eigen::VectorXd r = errors.data() - fit.prediction(m.at);
  const auto all = prior_deviations(residual_of(fit));
  for (const auto& d : errors.directions())
    for (const auto& p : all)
      if (p.term == d.term && p.gauge == d.gauge) {
        EXPECT_NEAR(p.deviation, d.change.dot(inverse * r), 1e-6 * std::max(1.0, std::abs(p.deviation)));
        EXPECT_NEAR(p.sd * p.sd, 1 - d.change.dot(inverse * d.change), 1e-6);
      }
}

}  // namespace
}  // namespace calomel
