#pragma once
/// The one place where what went wrong becomes words on stderr and an exit status.
#include <functional>
#include <ostream>

#include "base/errors.hpp"

namespace calomel {

/// Runs `body` and returns the program's exit status: its own, or by what it throws 2 (InputError, and a file system that
/// refuses), 3 (NumericsError, no memory), 130 (Interrupted), 1 (anything else: a defect of ours, and said so).
/// An InputError with a place shows the offending line of the file with a caret.
int guarded(const std::function<ExitStatus()>& body, std::ostream& err);

}  // namespace calomel
