// Sensitivity indices and designs compared with OpenTURNS 1.20 (Baudin, Dutfoy, Iooss and Popelin 2017), an independent library for uncertainty quantification.
// Results from the same points must agree to rounding; results from random numbers must agree within four standard errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <openturns/Arcsine.hxx>
#include <openturns/ComposedDistribution.hxx>
#include <openturns/FixedStrategy.hxx>
#include <openturns/FunctionalChaosAlgorithm.hxx>
#include <openturns/FunctionalChaosSobolIndices.hxx>
#include <openturns/JansenSensitivityAlgorithm.hxx>
#include <openturns/LHSExperiment.hxx>
#include <openturns/LeastSquaresStrategy.hxx>
#include <openturns/LegendreFactory.hxx>
#include <openturns/LinearEnumerateFunction.hxx>
#include <openturns/MonteCarloExperiment.hxx>
#include <openturns/OrthogonalProductPolynomialFactory.hxx>
#include <openturns/RandomGenerator.hxx>
#include <openturns/SaltelliSensitivityAlgorithm.hxx>
#include <openturns/SobolSequence.hxx>
#include <openturns/SpaceFillingC2.hxx>
#include <openturns/Uniform.hxx>
#include <ostream>
#include <string>
#include <vector>

#include "forward/campaign/design.hpp"
#include "uq/sensitivity/chaos_indices.hpp"
#include "uq/sensitivity/sobol_indices.hpp"

namespace calomel {
namespace {

/// A function of `dimensions` parameters on [low, high] each, whose Sobol' indices are known in closed form.
struct KnownFunction {
  std::string name;
  std::size_t dimensions = 0;
  double low = 0, high = 1;
  std::function<double(const Eigen::VectorXd&)> value;
  std::vector<double> first_order, total_order;
};

void PrintTo(const KnownFunction& f, std::ostream* out) { *out << f.name; }

/// sin x1 + a sin^2 x2 + b x3^4 sin x1 on [-pi, pi]^3 (Ishigami and Homma 1990), b = 0.1.
KnownFunction ishigami(double a = 7) {
  constexpr double b = 0.1, pi = std::numbers::pi;
  const double alone = 0.5 * std::pow(1 + b * std::pow(pi, 4) / 5, 2), second = a * a / 8, pair = 8 * b * b * std::pow(pi, 8) / 225;
  const double all = alone + second + pair;
  return {.name = "Ishigami",
          .dimensions = 3,
          .low = -pi,
          .high = pi,
          .value = [a](const Eigen::VectorXd& x) { return std::sin(x[0]) * (1 + b * std::pow(x[2], 4)) + a * std::pow(std::sin(x[1]), 2); },
          .first_order = {alone / all, second / all, 0},
          .total_order = {(alone + pair) / all, second / all, pair / all}};
}

/// prod_k (|4 x_k - 2| + a_k) / (1 + a_k) on [0, 1]^4 (Saltelli and Sobol' 1995): V_k = 1 / (3 (1 + a_k)^2), V = prod (1 + V_k) - 1.
KnownFunction g_function() {
  const std::vector<double> a{0, 1, 4.5, 9};
  KnownFunction g{.name = "g-function", .dimensions = a.size(), .value = [a](const Eigen::VectorXd& x) {
                    double y = 1;
                    for (std::size_t k = 0; k < a.size(); ++k) y *= (std::abs(4 * x[Eigen::Index(k)] - 2) + a[k]) / (1 + a[k]);
                    return y;
                  }};
  double product = 1;
  for (const double k : a) product *= 1 + 1 / (3 * (1 + k) * (1 + k));
  for (const double k : a) {
    const double v = 1 / (3 * (1 + k) * (1 + k));
    g.first_order.push_back(v / (product - 1));
    g.total_order.push_back(v * product / (1 + v) / (product - 1));
  }
  return g;
}

/// Points (d, n) in OpenTURNS' form, one row a point.
OT::Sample sample_of(const Eigen::MatrixXd& points) {
  OT::Sample out(OT::UnsignedInteger(points.cols()), OT::UnsignedInteger(points.rows()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (Eigen::Index k = 0; k < points.rows(); ++k) out(OT::UnsignedInteger(i), OT::UnsignedInteger(k)) = points(k, i);
  return out;
}

/// Points (d, n) of a sample.
Eigen::MatrixXd points_of(const OT::Sample& sample) {
  Eigen::MatrixXd out(Eigen::Index(sample.getDimension()), Eigen::Index(sample.getSize()));
  for (Eigen::Index i = 0; i < out.cols(); ++i)
    for (Eigen::Index k = 0; k < out.rows(); ++k) out(k, i) = sample(OT::UnsignedInteger(i), OT::UnsignedInteger(k));
  return out;
}

/// `d` independent parameters, uniform on [low, high].
OT::ComposedDistribution uniform(std::size_t d, double low, double high) {
  return OT::ComposedDistribution(OT::ComposedDistribution::DistributionCollection(OT::UnsignedInteger(d), OT::Uniform(low, high)));
}

/// The function at points (d, n) of the unit cube.
Eigen::VectorXd values_at(const KnownFunction& f, const Eigen::MatrixXd& unit) {
  Eigen::VectorXd y(unit.cols());
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = f.value(f.low + (f.high - f.low) * unit.col(i).array());
  return y;
}

/// Jansen's halves of squared differences from values at sobol_rows_design.
SobolRows rows_of(const Eigen::VectorXd& y, Eigen::Index d) {
  const Eigen::Index n = y.size() / (d + 2);
  SobolRows rows{Eigen::VectorXd(n), Eigen::MatrixXd(n, d), Eigen::MatrixXd(n, d)};
  const auto half_square = [](double a, double b) { return 0.5 * (a - b) * (a - b); };
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd row = y.segment(i * (d + 2), d + 2);
    rows.variance[i] = half_square(row[0], row[1]);
    for (Eigen::Index k = 0; k < d; ++k) {
      rows.alone(i, k) = half_square(row[1], row[2 + k]);
      rows.total(i, k) = half_square(row[0], row[2 + k]);
    }
  }
  return rows;
}

/// The indices of `f` by our estimator with `n` rows: first order, then total order, (2 d).
Eigen::VectorXd our_indices(const KnownFunction& f, std::size_t n, std::uint64_t seed) {
  const auto d = Eigen::Index(f.dimensions);
  const SobolIndices s = sobol_indices(rows_of(values_at(f, sobol_rows_design(f.dimensions, n, seed)), d), seed, 1);
  Eigen::VectorXd out(2 * d);
  for (Eigen::Index k = 0; k < d; ++k) {
    out[k] = s.first_order[std::size_t(k)].value;
    out[d + k] = s.total_order[std::size_t(k)].value;
  }
  return out;
}

/// A design in OpenTURNS' order, with its values: n points A, n points B, then for each parameter A with that column of B.
template <class Algorithm>
Eigen::VectorXd indices_by(const KnownFunction& f, const Eigen::MatrixXd& unit, std::size_t n) {
  const Algorithm algorithm(sample_of(unit), sample_of(values_at(f, unit).transpose()), OT::UnsignedInteger(n));
  const OT::Point first = algorithm.getFirstOrderIndices(), total = algorithm.getTotalOrderIndices();
  const auto d = Eigen::Index(f.dimensions);
  Eigen::VectorXd out(2 * d);
  for (Eigen::Index k = 0; k < d; ++k) {
    out[k] = first[OT::UnsignedInteger(k)];
    out[d + k] = total[OT::UnsignedInteger(k)];
  }
  return out;
}

/// Points A, B and A with a column of B, (d, n (d + 2)), from independent random numbers of OpenTURNS.
Eigen::MatrixXd random_design(std::size_t dimensions, std::size_t n, std::uint64_t seed) {
  OT::RandomGenerator::SetSeed(seed);
  const auto d = Eigen::Index(dimensions), rows = Eigen::Index(n);
  const Eigen::MatrixXd both = points_of(uniform(2 * dimensions, 0, 1).getSample(n));
  Eigen::MatrixXd out(d, rows * (d + 2));
  out.leftCols(rows) = both.topRows(d);
  out.middleCols(rows, rows) = both.bottomRows(d);
  for (Eigen::Index k = 0; k < d; ++k) {
    out.middleCols((2 + k) * rows, rows) = both.topRows(d);
    out.row(k).segment((2 + k) * rows, rows) = both.row(d + k);
  }
  return out;
}

/// The points of sobol_rows_design in OpenTURNS' order.
Eigen::MatrixXd in_their_order(const Eigen::MatrixXd& design) {
  const Eigen::Index d = design.rows(), n = design.cols() / (d + 2);
  Eigen::MatrixXd out(d, design.cols());
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < d + 2; ++j) out.col(j * n + i) = design.col(i * (d + 2) + j);
  return out;
}

/// Mean and standard error of independent repetitions, (quantities, repetitions).
struct Repeated {
  Eigen::VectorXd mean, error;
};
Repeated repeated(int times, const std::function<Eigen::VectorXd(std::uint64_t seed)>& once) {
  std::vector<Eigen::VectorXd> all;
  for (int r = 0; r < times; ++r) all.push_back(once(std::uint64_t(r + 1)));
  Repeated out{Eigen::VectorXd::Zero(all[0].size()), Eigen::VectorXd::Zero(all[0].size())};
  for (const auto& x : all) out.mean += x / double(times);
  for (const auto& x : all) out.error += (x - out.mean).cwiseAbs2() / (double(times) * (times - 1));
  out.error = out.error.cwiseSqrt();
  return out;
}

/// The greatest difference of two results in standard errors of the difference.
double worst_z(const Repeated& a, const Repeated& b) {
  return ((a.mean - b.mean).cwiseAbs().array() / (a.error.cwiseAbs2() + b.error.cwiseAbs2()).array().sqrt()).maxCoeff();
}

class SobolIndicesOf : public ::testing::TestWithParam<KnownFunction> {};

// Jansen's estimator on the same n points. We divide means of n halves of squares by the mean of |f(A) - f(B)|^2 / 2. OpenTURNS divides their sums by n - 1/2,
// and the result by the sample variance of the values at A.
TEST_P(SobolIndicesOf, AreJansensOnTheSamePoints) {
  const KnownFunction& f = GetParam();
  const auto d = Eigen::Index(f.dimensions);
  constexpr std::size_t n = 256;
  const Eigen::MatrixXd design = sobol_rows_design(f.dimensions, n, 5);
  const Eigen::VectorXd y = values_at(f, design), theirs = indices_by<OT::JansenSensitivityAlgorithm>(f, in_their_order(design), n);
  const SobolRows rows = rows_of(y, d);
  Eigen::VectorXd at_a(n);
  for (Eigen::Index i = 0; i < at_a.size(); ++i) at_a[i] = y[i * (d + 2)];
  const double variance = (at_a.array() - at_a.mean()).square().sum() / double(n - 1), scale = double(n) / (double(n) - 0.5) * rows.variance.mean() / variance;
  const Eigen::VectorXd ours = our_indices(f, n, 5);
  for (Eigen::Index k = 0; k < d; ++k) {
    EXPECT_NEAR((1 - ours[k]) * scale, 1 - theirs[k], 1e-10) << "first order " << k;
    EXPECT_NEAR(ours[d + k] * scale, theirs[d + k], 1e-10) << "total order " << k;
  }
  // Negative control: another shift of the same sequence.
  EXPECT_GT((our_indices(f, n, 6) - ours).cwiseAbs().maxCoeff(), 1e-6);
}

// Means of 24 repetitions, with standard errors from their scatter. Student's t of 23 degrees of freedom exceeds 4 in 6 of 10 000 cases.
TEST_P(SobolIndicesOf, AreThoseOfSaltellisEstimator) {
  const KnownFunction& f = GetParam();
  const auto d = Eigen::Index(f.dimensions);
  const Repeated ours = repeated(24, [&](std::uint64_t seed) { return our_indices(f, 4096, seed); });
  const Repeated theirs =
      repeated(24, [&](std::uint64_t seed) { return indices_by<OT::SaltelliSensitivityAlgorithm>(f, random_design(f.dimensions, 4096, seed), 4096); });
  EXPECT_LT(worst_z(ours, theirs), 4);
  Repeated exact{Eigen::VectorXd(2 * d), Eigen::VectorXd::Zero(2 * d)};
  for (Eigen::Index k = 0; k < d; ++k) {
    exact.mean[k] = f.first_order[std::size_t(k)];
    exact.mean[d + k] = f.total_order[std::size_t(k)];
  }
  EXPECT_LT(worst_z(theirs, exact), 4);
  EXPECT_LT(worst_z(ours, exact), 4);
  std::printf("  standard errors: ours below %.2g, theirs below %.2g; z: ours and theirs %.2f, ours and exact %.2f, theirs and exact %.2f\n",
              ours.error.maxCoeff(), theirs.error.maxCoeff(), worst_z(ours, theirs), worst_z(ours, exact), worst_z(theirs, exact));
  // Negative control: first and total order are exchanged.
  Repeated confused = ours;
  confused.mean << ours.mean.tail(d), ours.mean.head(d);
  EXPECT_GT(worst_z(confused, theirs), 8);
}

INSTANTIATE_TEST_SUITE_P(OpenTurns, SobolIndicesOf, ::testing::Values(ishigami(), g_function()),
                         [](const auto& info) { return info.param.name == "Ishigami" ? "Ishigami" : "GFunction"; });

/// Indices of OpenTURNS' Legendre chaos of total degree `order` by least squares on the same values, first order, then total order, (2 d).
Eigen::VectorXd their_chaos_indices(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, int order) {
  const auto d = OT::UnsignedInteger(x.rows());
  const OT::LinearEnumerateFunction enumerate(d);
  const OT::OrthogonalProductPolynomialFactory basis(OT::OrthogonalProductPolynomialFactory::PolynomialFamilyCollection(d, OT::LegendreFactory()), enumerate);
  const OT::UnsignedInteger terms = enumerate.getStrataCumulatedCardinal(OT::UnsignedInteger(order));
  const OT::Sample in = sample_of(x), out = sample_of(y.transpose());
  OT::FunctionalChaosAlgorithm algorithm(in, out, uniform(d, -1, 1), OT::FixedStrategy(basis, terms), OT::LeastSquaresStrategy(in, out));
  algorithm.run();
  const OT::FunctionalChaosSobolIndices indices(algorithm.getResult());
  Eigen::VectorXd all(2 * x.rows());
  for (OT::UnsignedInteger k = 0; k < d; ++k) {
    all[Eigen::Index(k)] = indices.getSobolIndex(k);
    all[x.rows() + Eigen::Index(k)] = indices.getSobolTotalIndex(k);
  }
  return all;
}

class ChaosIndicesOf : public ::testing::TestWithParam<KnownFunction> {};

// Least squares on the same values has one solution, so that both libraries differ by rounding only.
TEST_P(ChaosIndicesOf, AreThoseOfTheSamePolynomial) {
  const KnownFunction& f = GetParam();
  const auto d = Eigen::Index(f.dimensions);
  const Eigen::MatrixXd unit = sobol_points(f.dimensions, 1000, 3);
  const Eigen::MatrixXd x = 2 * unit.array() - 1;
  const Eigen::VectorXd y = values_at(f, unit);
  const LegendreChaos chaos = fit_chaos(x, y);
  const ChaosIndices indices = indices_of(chaos);
  Eigen::VectorXd ours(2 * d);
  ours << indices.first_order, indices.total_order;
  EXPECT_LT((ours - their_chaos_indices(x, y, chaos.order)).cwiseAbs().maxCoeff(), 1e-9);
  // Negative control: a polynomial of one order less.
  EXPECT_GT((ours - their_chaos_indices(x, y, chaos.order - 1)).cwiseAbs().maxCoeff(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(OpenTurns, ChaosIndicesOf, ::testing::Values(ishigami(), g_function()),
                         [](const auto& info) { return info.param.name == "Ishigami" ? "Ishigami" : "GFunction"; });

/// Centred L2 discrepancy of points (d, n) of the unit cube (Hickernell 1998), by OpenTURNS.
double discrepancy(const Eigen::MatrixXd& points) { return OT::SpaceFillingC2().evaluate(sample_of(points)); }

Eigen::MatrixXd independent_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed) {
  OT::RandomGenerator::SetSeed(seed);
  return points_of(OT::MonteCarloExperiment(uniform(dimensions, 0, 1), runs).generate());
}

// Both sequences follow Sobol' (1967); their direction numbers differ, and ours has a random shift. The discrepancy must lie between 0.8 and 1.25 of theirs.
TEST(DesignBesideOpenTurns, SobolPointsAreAsEvenAsTheirSequence) {
  constexpr std::size_t d = 6, n = 256;
  const double theirs = discrepancy(points_of(OT::SobolSequence(d).generate(n)));
  const Repeated ours = repeated(16, [&](std::uint64_t seed) { return Eigen::VectorXd::Constant(1, discrepancy(sobol_points(d, n, seed))); });
  EXPECT_LT(ours.mean[0] + 4 * ours.error[0], 1.25 * theirs);
  EXPECT_GT(ours.mean[0] - 4 * ours.error[0], 0.8 * theirs);
  const Repeated independent = repeated(16, [&](std::uint64_t seed) { return Eigen::VectorXd::Constant(1, discrepancy(independent_points(d, n, seed))); });
  EXPECT_GT(independent.mean[0] - 4 * independent.error[0], 1.25 * theirs);  // negative control
}

/// Whether every coordinate has one point in each of n equal intervals: OpenTURNS' rank of a point is then the number of its interval.
bool one_in_each_interval(const Eigen::MatrixXd& points) {
  const OT::Sample sample = sample_of(points), rank = sample.rank();
  for (OT::UnsignedInteger i = 0; i < sample.getSize(); ++i)
    for (OT::UnsignedInteger k = 0; k < sample.getDimension(); ++k)
      if (rank(i, k) != std::floor(sample(i, k) * double(sample.getSize()))) return false;
  return true;
}

TEST(DesignBesideOpenTurns, LatinHypercubesAreStratifiedAndAsEvenAsTheirs) {
  constexpr std::size_t d = 6, n = 60;
  const auto theirs = [&](std::uint64_t seed) {
    OT::RandomGenerator::SetSeed(seed);
    return points_of(OT::LHSExperiment(uniform(d, 0, 1), n).generate());
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_TRUE(one_in_each_interval(latin_hypercube_points(d, n, seed)));
    EXPECT_TRUE(one_in_each_interval(theirs(seed)));
    EXPECT_FALSE(one_in_each_interval(independent_points(d, n, seed)));  // negative control
  }
  const auto evenness = [&](const auto& points) {
    return repeated(200, [&](std::uint64_t seed) { return Eigen::VectorXd::Constant(1, discrepancy(points(seed))); });
  };
  const Repeated ours = evenness([&](std::uint64_t seed) { return latin_hypercube_points(d, n, seed); }), beside = evenness(theirs),
                 independent = evenness([&](std::uint64_t seed) { return independent_points(d, n, seed); });
  EXPECT_LT(worst_z(ours, beside), 4);
  EXPECT_GT(worst_z(independent, beside), 8);  // negative control
}

TEST(DesignBesideOpenTurns, ChebyshevPointsAreArcsineQuantilesOfSobols) {
  const Eigen::MatrixXd u = sobol_points(4, 500, 2), x = chebyshev_points(4, 500, 2);
  const OT::Arcsine arcsine(0, 1);
  double worst = 0, worst_uniform = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    worst = std::max(worst, std::abs(arcsine.computeQuantile(u.data()[i])[0] - x.data()[i]));
    worst_uniform = std::max(worst_uniform, std::abs(u.data()[i] - x.data()[i]));
  }
  EXPECT_LT(worst, 1e-14);
  EXPECT_GT(worst_uniform, 0.1);  // negative control: points of the uniform measure
}

}  // namespace
}  // namespace calomel
