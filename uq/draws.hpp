#pragma once
/// Draws of several chains. Samplers make them and convergence/ assesses them.
#include <string>
#include <vector>

namespace calomel {

/// Draws of several quantities.
struct Draws {
  std::vector<std::string> names;  ///< (name)
  std::size_t chains = 0;
  std::size_t draws = 0;       ///< draws of each chain
  std::vector<double> values;  ///< (chain, draw, name), row-major
  std::size_t walkers = 1;     ///< number of consecutive chains that move together; divides `chains`

  [[nodiscard]] double at(std::size_t chain, std::size_t draw, std::size_t name) const { return values[(chain * draws + draw) * names.size() + name]; }
  /// The draws of one name: (chain, draw).
  [[nodiscard]] std::vector<double> of(std::size_t name) const {
    std::vector<double> x(chains * draws);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = values[i * names.size() + name];
    return x;
  }
};

}  // namespace calomel
