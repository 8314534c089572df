#include <limits>

#include "forward/material/riemer.hpp"

namespace calomel {

const Registry<RiemerFactory>& liquid_laws() {
  static const Registry<RiemerFactory> laws = Registry<RiemerFactory>("law of the liquid")
                                                  .add("riemer", "p = max(p0 - K e_v - eta rate, -tensile_cutoff), reversible",
                                                       [](const MercuryOptions& o, double eta) {
                                                         return Riemer{o.density * o.sound_speed * o.sound_speed, o.tensile_cutoff, eta};
                                                       })
                                                  .add("linear", "p = p0 - K e_v - eta rate: no cavitation", [](const MercuryOptions& o, double eta) {
                                                    return Riemer{o.density * o.sound_speed * o.sound_speed, std::numeric_limits<double>::infinity(), eta};
                                                  });
  return laws;
}

}  // namespace calomel
