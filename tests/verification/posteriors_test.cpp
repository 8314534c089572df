// Samplers on posteriors with published reference draws: every registered sampler on every posterior, the densities and their gradients, and controls that
// must fail. Rule: at the 5, 25, 50, 75 and 95 % reference quantiles |z| < 4 (reference_scores.hpp). One seed, no second try.
#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "base/random.hpp"
#include "tests/shared_data.hpp"
#include "tests/verification/reference_scores.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/sampler/delayed_acceptance.hpp"

namespace calomel::testing {
namespace {

using ::testing::Combine;
using ::testing::ValuesIn;

std::vector<std::string> posterior_names() {
  std::vector<std::string> names;
  for (const auto& p : reference_posteriors()) names.push_back(p.name);
  return names;
}

/// A few data of the right form, so that the densities can be tested where the published data are absent.
Json made_up(const std::string& name) {
  if (name == "eight_schools") return Json::parse(R"({"y": [28, 8, -3, 7, -1, 1, 18, 12], "sigma": [15, 10, 16, 11, 9, 11, 10, 18]})");
  if (name == "kid_scores") return Json::parse(R"({"kid_score": [65, 98, 85, 83, 115], "mom_hs": [1, 1, 0, 1, 0], "mom_iq": [1.2, 0.9, 1.15, 1.0, 0.93]})");
  if (name == "autoregression") return Json::parse(R"({"y": [0.7, 0.8, 0.6, 1.0, 0.4, 0.2, -0.3, -0.1, 0.5, 0.9]})");
  if (name == "mixture") return Json::parse(R"({"y": [-3.6, 3.1, 0.2, 1.6, -2.6, -400]})");
  return Json::parse(R"({"ts": [1, 2, 3.5, 12, 20], "y_init": [30, 4], "y": [[47.2, 6.1], [70.2, 9.8], [36, 59], [60, 15], [25, 9]]})");
}

/// d/dx_k by central differences of three widths, combined to sixth order.
double difference(const LogDensity& density, std::vector<double> x, std::size_t k) {
  const double x0 = x[k], h = 1e-3 * std::max(1.0, std::abs(x0));
  const auto slope = [&](double step) {
    x[k] = x0 + step;
    const double above = density.log_density(x);
    x[k] = x0 - step;
    return (above - density.log_density(x)) / (2 * step);
  };
  return (64 * slope(h / 4) - 20 * slope(h / 2) + slope(h)) / 45;
}

/// The greatest difference between the gradient and finite differences at random places about the centre, relative to the greatest component there.
double gradient_error(const ReferencePosterior& p, const LogDensity& density, const LogDensity& differenced) {
  RandomStream random(1, 0);
  double worst = 0;
  for (int n = 0; n < 20; ++n) {
    std::vector<double> x = p.centre, g(x.size());
    for (double& v : x) v += 2 * p.deviation * random.normal();
    const double value = density.log_density_and_gradient(x, g);
    EXPECT_EQ(value, density.log_density(x));
    double scale = 1, error = 0;
    for (std::size_t k = 0; k < x.size(); ++k) error = std::max(error, std::abs(g[k] - difference(differenced, x, k))), scale = std::max(scale, std::abs(g[k]));
    worst = std::max(worst, error / scale);
  }
  return worst;
}

class ReferenceDensity : public ::testing::TestWithParam<std::string> {};

TEST_P(ReferenceDensity, HasTheGradientOfItsDifferences) {
  const auto& p = reference_posterior(GetParam());
  const Json file = reference_file(p);
  for (const Json& data : {made_up(p.name), file.is_null() ? made_up(p.name) : file["data"]}) {
    const auto density = p.make(data, Jacobian::kept), dropped = p.make(data, Jacobian::dropped), stand_in = p.stand_in(data);
    EXPECT_EQ(density->dimension(), p.centre.size());
    EXPECT_LT(gradient_error(p, *density, *density), 1e-7);
    EXPECT_LT(gradient_error(p, *dropped, *dropped), 1e-7);
    EXPECT_LT(gradient_error(p, *stand_in, *stand_in), 1e-7);
    EXPECT_GT(gradient_error(p, *density, *dropped), 1e-5);  // the test would detect a missing gradient of 1
  }
}

TEST_P(ReferenceDensity, KeepsOrDropsTheLogOfTheDerivativeOfItsTransformation) {
  const auto& p = reference_posterior(GetParam());
  const Json data = made_up(p.name);
  const auto density = p.make(data, Jacobian::kept), dropped = p.make(data, Jacobian::dropped);
  RandomStream random(2, 0);
  double first = NAN;
  for (int n = 0; n < 20; ++n) {
    std::vector<double> x = p.centre;
    for (double& v : x) v += p.deviation * random.normal();
    // ln of the product of dq/dx over transformed coordinates: ln q for q = e^x, ln q (1 - q) for a logit. The names of the coordinates contain the
    // transformation.
    double expected = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto& name = density->coordinates()[k];
      if (name.starts_with("ln ")) expected += x[k];
      if (name.starts_with("logit ")) expected -= std::log1p(std::exp(-x[k])) + std::log1p(std::exp(x[k]));
    }
    const double constant = density->log_density(x) - dropped->log_density(x) - expected;
    if (n == 0) first = constant;
    EXPECT_NEAR(constant, first, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Published, ReferenceDensity, ValuesIn(posterior_names()), [](const auto& info) { return info.param; });

TEST(LotkaVolterra, IsOfFourthOrderAndTenStepsAYearAreEnough) {
  const Json data = made_up("lotka_volterra");
  const auto& p = reference_posterior("lotka_volterra");
  const auto at = [&](int steps, const std::vector<double>& x) { return lotka_volterra(data, steps)->log_density(x); };
  RandomStream random(3, 0);
  for (int n = 0; n < 20; ++n) {
    std::vector<double> x = p.centre;
    for (double& v : x) v += p.deviation * random.normal();
    const double finest = at(320, x), error = at(10, x) - finest, halved = at(20, x) - finest;
    EXPECT_EQ(at(10, x), p.make(data, Jacobian::kept)->log_density(x));
    EXPECT_LT(std::abs(error), 1e-3);
    EXPECT_NEAR(std::log2(error / halved), 4, 1);
  }
}

TEST(LotkaVolterra, HasPopulationsAtRest) {
  // u = gamma/delta, v = alpha/beta is stationary: on a record of it ln p consists of ln sigma and the priors.
  const double alpha = 0.5, beta = 0.025, gamma = 0.8, delta = 0.02, u = gamma / delta, v = alpha / beta;
  Json data;
  data["ts"] = {1, 10, 20};
  data["y_init"] = {u, v};
  data["y"] = {{u, v}, {u, v}, {u, v}};
  std::vector<double> x{alpha, beta, gamma, delta, u, v, 0.3, 0.4};
  for (double& value : x) value = std::log(value);
  const auto normal = [](double value, double mean, double sd) { return -0.5 * std::pow((value - mean) / sd, 2); };
  const double priors = normal(alpha, 1, 0.5) + normal(gamma, 1, 0.5) + normal(beta, 0.05, 0.05) + normal(delta, 0.05, 0.05) + normal(x[4], std::log(10), 1) +
                        normal(x[5], std::log(10), 1) + normal(x[6], -1, 1) + normal(x[7], -1, 1) + x[0] + x[1] + x[2] + x[3];
  EXPECT_NEAR(lotka_volterra(data, 10)->log_density(x), priors - 4 * (x[6] + x[7]), 1e-9);
}

/// Lengths with which all posteriors together take a minute of one core. Ensembles are long enough for R-hat, which takes each walker for a chain. A sampler
/// without a line of its own has its defaults.
SamplerOptions options_of(const std::string& kind, const std::string& posterior) {
  SamplerOptions o = default_sampler_options(kind);
  const bool expensive = posterior == "mixture", wide = posterior == "eight_schools";
  if (kind == "dram") o.warmup = expensive ? 3000 : 10000, o.draws = 5000, o.thin = expensive ? 1 : wide ? 20 : 8;
  if (kind == "nuts") o.warmup = 1000, o.draws = 2500, o.thin = 1;
  if (kind == "ensemble")
    o.warmup = 1000, o.draws = posterior == "kid_scores" ? 400 : 1000, o.thin = 10, o.dispersion = reference_posterior(posterior).dispersion;
  if (kind == "smc") o.draws = expensive ? 500 : 1000;
  if (kind == "delayed_acceptance") o.warmup = 500, o.draws = expensive ? 1000 : 3000, o.table<DelayedAcceptanceOptions>().first_stage = expensive ? 10 : 20;
  return o;
}

class EverySampler : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(EverySampler, FollowsTheReference) {
  const auto& [kind, name] = GetParam();
  const auto& p = reference_posterior(name);
  const Json file = reference_file(p);
  if (file.is_null()) GTEST_SKIP() << absent_from_shared(reference_path(p));
  const auto options = options_of(kind, name);
  const auto density = p.make(file["data"], Jacobian::kept), stand_in = p.stand_in(file["data"]);
  const auto r = sample(*density, *stand_in, start_of(p), options, {.seed = 1, .threads = 4});
  const auto verdict = assess(r.quantities, sampling_facts(r, options.thin));
  EXPECT_TRUE(verdict.converged) << verdict.parameter;
  const Scores s = scores(r.quantities, file["reference"]);
  EXPECT_EQ(s.checked, 5 * file["reference"].size());
  EXPECT_LT(std::abs(s.worst), 4) << s.where;
  RecordProperty("worst_z", std::to_string(s.worst));
  std::printf("  %zu quantiles, worst z %.2f (%s); %zu evaluations in %.1f s; %s\n", s.checked, s.worst, s.where.c_str(), r.summary.evaluations,
              r.summary.wall_s, verdict.parameter.c_str());
}

INSTANTIATE_TEST_SUITE_P(OfTheRegistry, EverySampler, Combine(ValuesIn(samplers().names()), ValuesIn(posterior_names())),
                         [](const auto& info) { return std::get<0>(info.param) + "_" + std::get<1>(info.param); });

/// The greatest |z| of the same draws by nuts, from a wrong density.
double worst_of_wrong(const ReferencePosterior& p, const LogDensity& wrong, const Json& file) {
  const auto r = sample(wrong, wrong, start_of(p), options_of("nuts", p.name), {.seed = 1, .threads = 4});
  return std::abs(scores(r.quantities, file["reference"]).worst);
}

class Control : public ::testing::TestWithParam<std::string> {};

TEST_P(Control, AFlatterDensityIsDetected) {
  const auto& p = reference_posterior(GetParam());
  const Json file = reference_file(p);
  if (file.is_null()) GTEST_SKIP() << absent_from_shared(reference_path(p));
  EXPECT_GT(worst_of_wrong(p, *p.stand_in(file["data"]), file), 4);
}
INSTANTIATE_TEST_SUITE_P(Published, Control, ValuesIn(posterior_names()), [](const auto& info) { return info.param; });

/// Posteriors of few data. On the hundreds of data of the others the Jacobian moves a quantile by less than a twentieth of a deviation, which 10 000 reference
/// draws cannot resolve.
class FewData : public ::testing::TestWithParam<std::string> {};

TEST_P(FewData, DetectADroppedJacobian) {
  const auto& p = reference_posterior(GetParam());
  const Json file = reference_file(p);
  if (file.is_null()) GTEST_SKIP() << absent_from_shared(reference_path(p));
  EXPECT_GT(worst_of_wrong(p, *p.make(file["data"], Jacobian::dropped), file), 4);
}
INSTANTIATE_TEST_SUITE_P(Published, FewData, ValuesIn(std::vector<std::string>{"eight_schools", "lotka_volterra"}),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace calomel::testing
