#include "forward/campaign/design.hpp"

#include <gsl/gsl_qrng.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "base/random.hpp"

namespace calomel {

namespace {

constexpr int sobol_bits = 30;  // of GSL's generator: its points are whole multiples of 2^-30

}  // namespace

Eigen::MatrixXd sobol_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed) {
  if (dimensions > sobol_dimensions)
    throw InputError({.problem = "Sobol' points reach " + std::to_string(sobol_dimensions) + " parameters, the case has " + std::to_string(dimensions),
                      .key = "campaign.design",
                      .suggestion = "take \"latin_hypercube\""});
  Eigen::MatrixXd points(dimensions, runs);
  if (dimensions == 0 || runs == 0) return points;
  const std::unique_ptr<gsl_qrng, decltype(&gsl_qrng_free)> sequence(gsl_qrng_alloc(gsl_qrng_sobol, unsigned(dimensions)), gsl_qrng_free);
  expect(sequence != nullptr, "GSL gives a Sobol' sequence of up to 40 dimensions");
  std::vector<std::uint64_t> shift;
  for (std::size_t d = 0; d < dimensions; ++d) shift.push_back(RandomStream(seed, d)() >> (64 - sobol_bits));
  std::vector<double> x(dimensions, 0.0);  // the origin, which GSL leaves out
  for (std::size_t i = 0; i < runs; ++i) {
    for (std::size_t d = 0; d < dimensions; ++d) {
      const auto digits = std::uint64_t(std::ldexp(x[d], sobol_bits)) ^ shift[d];
      points(Eigen::Index(d), Eigen::Index(i)) = std::ldexp(double(digits) + 0.5, -sobol_bits);
    }
    gsl_qrng_get(sequence.get(), x.data());
  }
  return points;
}

Eigen::MatrixXd latin_hypercube_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed) {
  Eigen::MatrixXd points(dimensions, runs);
  for (std::size_t d = 0; d < dimensions; ++d) {
    RandomStream stream(seed, d);
    const auto cell = stream.permutation(runs);
    for (std::size_t i = 0; i < runs; ++i) points(Eigen::Index(d), Eigen::Index(i)) = (double(cell[i]) + stream.uniform()) / double(runs);
  }
  return points;
}

Eigen::MatrixXd chebyshev_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed) {
  return sobol_points(dimensions, runs, seed).unaryExpr([](double u) { return 0.5 * (1 - std::cos(std::numbers::pi * u)); });
}

Eigen::MatrixXd space_filling_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed) {
  return dimensions <= sobol_dimensions ? sobol_points(dimensions, runs, seed) : latin_hypercube_points(dimensions, runs, seed);
}

}  // namespace calomel
