#include "forward/mechanism/previous_pulses.hpp"

#include <fmt/format.h>

#include "forward/mechanism/left_states.hpp"

namespace calomel {

namespace {

std::string key(std::size_t state) { return fmt::format("left_{}", state + 1); }

std::vector<double> shares(const MechanismValues& v) {
  std::vector<double> all;
  for (std::size_t k = 0; k < LeftStates::count; ++k) all.push_back(v[key(k)]);
  return all;
}

}  // namespace

MechanismEntry previous_pulses() {
  std::vector<MechanismKey> keys;
  for (std::size_t k = 0; k < LeftStates::count; ++k)
    keys.push_back({.name = key(k),
                    .unit = "",
                    .off = 0,
                    .low = -0.4,
                    .high = 0.4,
                    .doc = "share of what one pulse leaves at the time of this number, in the motion that the run starts from"});
  return {.law = fmt::format("u(0) = sum_k a_k u_k, v(0) = sum_k a_k v_k: what one pulse leaves moving at {} times after it", LeftStates::count),
          .plain = "what earlier pulses left ringing",
          .check = "see how long before each record the last pulse came, and take records of single pulses",
          .keys = std::move(keys),
          .cost = 3,
          .left = shares};
}

}  // namespace calomel
