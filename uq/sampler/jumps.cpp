#include "uq/sampler/jumps.hpp"

#include <cmath>

namespace calomel {

int ModeJumps::move(MarkovChain& chain, const LogDensity& density, RandomStream& random) const {
  for (std::size_t w = 0; w < chain.walkers(); ++w) {
    const StudentT& part = mixture_.choose(random);
    const Eigen::VectorXd y = part.draw(random);
    const double u = random.uniform();
    const auto place = chain.position(w);
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(place.data(), Eigen::Index(place.size()));
    const double value = checked_log_density(density, y);
    if (std::log(u) < value - chain.log_density(w) + mixture_.log_density(x) - mixture_.log_density(y))
      chain.jump(w, {y.data(), std::size_t(y.size())}, value, part.mean());
  }
  return int(chain.walkers());
}

}  // namespace calomel
