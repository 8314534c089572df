#pragma once
#include <pagmo/population.hpp>
#include <string>

namespace calomel {

/// Grey wolf optimiser: each wolf moves to the mean of x_k - A |C x_k - x| over the three best wolves k, A = 2 a r1 - a, C = 2 r2,
/// with a falling linearly from 2 to 0. Mirjalili, Mirjalili and Lewis 2014, Adv. Eng. Softw. 69, 46, eqs. 3.1-3.7; the three best
/// are the best seen so far, coordinates are clipped to the box.
/// The product C x_k ties the search to the origin of the coordinates: it is biased to the lower corner of the scaled box, as
/// published (and as pagmo::gwo is); the unit box keeps the bias off the centre and equal for all parameters.
struct GreyWolf {
  int generations = 100;
  unsigned seed = 1;
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;
  void set_seed(unsigned s) { seed = s; }
  [[nodiscard]] std::string get_name() const { return "GWO, by generations"; }
};

}  // namespace calomel
