#pragma once
/// One point of a liquid law, driven by its strain.
#include <vector>

#include "forward/solver/liquid_law.hpp"

namespace calomel::testing {

class DrivenPoint {
 public:
  DrivenPoint(const LiquidLaw& law, double dt) : law_(law), dt_(dt), state_(law.state_size()) {
    const Vec3 centre{};
    law.initialise({&centre, 1}, state_.data(), 1);
  }
  /// Pressure [Pa] after a step to `strain` under the heating pressure `heating`.
  double step(double strain, double heating = 0) {
    law_.advance({1, dt_, &strain, &before_, &heating, &pressure_, state_.data(), 1});
    before_ = strain;
    return pressure_;
  }
  [[nodiscard]] double state(std::size_t k) const { return state_.at(k); }

 private:
  const LiquidLaw& law_;
  double dt_, before_ = 0, pressure_ = 0;
  std::vector<double> state_;
};

}  // namespace calomel::testing
