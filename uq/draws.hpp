#pragma once
/// Draws of several chains, as samplers make them and convergence/ judges them.
#include <string>
#include <vector>

namespace calomel {

struct Draws {
  std::vector<std::string> names;  ///< (name)
  std::size_t chains = 0, draws = 0;
  std::vector<double> values;  ///< (chain, draw, name), row-major
  std::size_t walkers = 1;     ///< chains that move together, one after another: those of an ensemble. Divides `chains`

  [[nodiscard]] double at(std::size_t chain, std::size_t draw, std::size_t name) const { return values[(chain * draws + draw) * names.size() + name]; }
  /// One name's draws: (chain, draw).
  [[nodiscard]] std::vector<double> of(std::size_t name) const {
    std::vector<double> x(chains * draws);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = values[i * names.size() + name];
    return x;
  }
};

}  // namespace calomel
