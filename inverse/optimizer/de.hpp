#pragma once
#include <pagmo/population.hpp>
#include <string>

namespace calomel {

/// Differential evolution, rand/1/bin: v = a + F (b - c) with a, b, c three other individuals, each coordinate taken from v
/// with probability CR and one always; the trial replaces its parent when it is not worse. Coordinates that leave the box
/// are drawn again in it. Storn and Price 1997, J. Global Optim. 11, 341, with their first suggestions F = 0.5 and CR = 0.9.
/// All trials of a generation are made from the generation before and evaluated together.
struct DifferentialEvolution {
  int generations = 100;
  unsigned seed = 1;
  double F = 0.5;
  double CR = 0.9;
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;
  void set_seed(unsigned s) { seed = s; }
  [[nodiscard]] std::string get_name() const { return "DE rand/1/bin, by generations"; }
};

}  // namespace calomel
