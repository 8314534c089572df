#pragma once
/// Chains whose autocorrelation is known.
#include <cmath>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "uq/draws.hpp"

namespace calomel::testing {

/// chains x n draws of a first-order autoregression about at(chain, draw): (chain, draw).
template <class At>
std::vector<double> chains_of(std::size_t chains, std::size_t n, double coefficient, At&& at, std::uint64_t seed = 7) {
  std::vector<double> x;
  for (std::size_t c = 0; c < chains; ++c) {
    RandomStream random(seed, c);
    double v = random.normal();
    for (std::size_t i = 0; i < n; ++i) {
      v = coefficient * v + std::sqrt(1 - coefficient * coefficient) * random.normal();
      x.push_back(at(c, i) + v);
    }
  }
  return x;
}
inline std::vector<double> chains_of(std::size_t chains, std::size_t n, double coefficient = 0) {
  return chains_of(chains, n, coefficient, [](std::size_t, std::size_t) { return 0.0; });
}

/// Draws with one column for each name; columns: (name), each (chain, draw).
inline Draws draws_of(std::vector<std::string> names, std::size_t chains, const std::vector<std::vector<double>>& columns) {
  Draws d{.names = std::move(names), .chains = chains, .draws = columns[0].size() / chains};
  for (std::size_t i = 0; i < columns[0].size(); ++i)
    for (const auto& c : columns) d.values.push_back(c[i]);
  return d;
}

}  // namespace calomel::testing
