#pragma once
#include <pagmo/population.hpp>
#include <string>

namespace calomel {

/// Moth-flame optimiser: moths fly on logarithmic spirals about flames, M = |F_j - M_i| exp(b t) cos(2 pi t) + F_j with t
/// uniform on [r, 1] and r falling from -1 to -2; the flames are the best points so far, and their number falls from n to 1,
/// later moths sharing the last flame. Mirjalili 2015, Knowl.-Based Syst. 89, 228, eqs. 3.11-3.14. Coordinates are clipped to the box.
struct MothFlame {
  int generations = 100;
  unsigned seed = 1;
  double b = 1;  ///< shape of the spiral
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;
  void set_seed(unsigned s) { seed = s; }
  [[nodiscard]] std::string get_name() const { return "MFO"; }
};

}  // namespace calomel
