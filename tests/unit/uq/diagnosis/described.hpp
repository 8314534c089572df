#pragma once
/// A verdict in a line, for the message of a failed test.
#include <string>

#include "uq/diagnosis/verdict.hpp"

namespace calomel {

inline std::string described(const Verdict& v) { return text(v.kind) + ", leading: " + v.reason.leading + ", gate " + std::to_string(int(v.reason.gate)); }

}  // namespace calomel
