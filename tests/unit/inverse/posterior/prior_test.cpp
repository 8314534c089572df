#include "inverse/posterior/prior.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>

#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

std::vector<Parameter> every_kind() {
  std::vector<Parameter> all;
  for (const char* kind : {"uniform", "normal", "truncated_normal", "lognormal", "half_cauchy", "beta"}) {
    Parameter p = uniform_parameter(kind, 0.5, 4, 2);
    p.prior = kind;
    p.mean = 1.0;
    p.sd = 0.8;
    p.mu = 0.3;
    p.sigma = 0.6;
    p.scale = 1.5;
    p.alpha = 2.5;
    p.beta = 1.7;
    all.push_back(p);
  }
  return all;
}

TEST(Prior, IntegratesToOneAndItsQuantileIsTheInverse) {
  boost::math::quadrature::tanh_sinh<double> integrate;
  for (const auto& p : every_kind()) {
    const Prior prior(p);
    const auto density = [&](double x) { return std::exp(prior.log_density(x)); };
    EXPECT_NEAR(integrate.integrate(density, prior.low(), prior.high()), 1, 1e-7) << p.prior;
    for (const double u : {0.02, 0.4, 0.93}) EXPECT_NEAR(integrate.integrate(density, prior.low(), prior.quantile(u)), u, 1e-6) << p.prior;
  }
}

TEST(Prior, ProbabilityBelowAQuantileIsTheQuantiles) {
  for (const auto& prior : priors_of(every_kind())) {
    for (const double u : {0.003, 0.3, 0.5, 0.98}) EXPECT_NEAR(prior.probability_below(prior.quantile(u)), u, 1e-12) << prior.kind();
    // There is no probability beyond the support.
    if (std::isfinite(prior.low())) {
      EXPECT_EQ(prior.probability_below(prior.low() - 1), 0) << prior.kind();
    }
    if (std::isfinite(prior.high())) {
      EXPECT_NEAR(prior.probability_below(prior.high() + 1), 1, 1e-15) << prior.kind();
    }
  }
}

TEST(Prior, GradientIsTheDerivative) {
  for (const auto& p : every_kind()) {
    const Prior prior(p);
    for (const double x : {0.7, 1.9, 3.3}) {
      const double h = 1e-5;
      EXPECT_NEAR(prior.log_density_slope(x), (prior.log_density(x + h) - prior.log_density(x - h)) / (2 * h), 1e-7) << p.prior;
    }
  }
}

TEST(Prior, IsNothingOutsideItsSupport) {
  for (const auto& p : every_kind()) {
    const Prior prior(p);
    if (std::isfinite(prior.low())) {
      EXPECT_EQ(prior.log_density(prior.low() - 0.1), -std::numeric_limits<double>::infinity()) << p.prior;
    }
  }
  EXPECT_TRUE(std::isfinite(Prior(every_kind()[1]).log_density(-9)));  // a normal prior has no ends
}

TEST(HandbookPriors, ReplaceTheCasesOwnAndRefuseAUniformStranger) {
  std::vector<Parameter> parameters{uniform_parameter("rho", 1000, 14000, 13500), uniform_parameter("c", 500, 4000, 1450),
                                    uniform_parameter("cutoff", 0, 1.5e6, 1.5e5), normal_parameter("young", 193e9, 4e9)};
  parameters[0].key = "material.mercury.density";
  parameters[1].key = "material.mercury.sound_speed";
  parameters[2].key = "material.mercury.tensile_cutoff";
  parameters[3].key = "material.steel.young";
  const std::vector<HandbookPrior> known{
      {"material.mercury.density", "normal", 0.015}, {"material.mercury.sound_speed", "normal", 0.03}, {"material.mercury.tensile_cutoff", "lognormal", 0.7}};
  const auto handbook = with_handbook_priors(parameters, known);
  EXPECT_DOUBLE_EQ(*handbook[0].sd, 0.015 * 13500);
  EXPECT_DOUBLE_EQ(*handbook[1].sd, 0.03 * 1450);
  EXPECT_EQ(handbook[2].prior, "lognormal");
  EXPECT_DOUBLE_EQ(*handbook[2].sigma, 0.7);
  EXPECT_EQ(handbook[3].prior, "normal");
  parameters[3].prior = "uniform";
  try {
    (void)with_handbook_priors(parameters, known);
    FAIL() << "a uniform prior with a free discrepancy is refused";
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().key, "parameter.young.prior");
    EXPECT_THAT(e.what(), ::testing::HasSubstr("does not identify"));
  }
}

}  // namespace
}  // namespace calomel
