#pragma once
/// Ctrl-C and SIGTERM end long work after the runs in progress.
#include <atomic>

namespace calomel {

/// True once the user requested a stop. Long work looks at it between its steps and throws Interrupted.
const std::atomic<bool>& stop_requested();

/// From here on SIGINT and SIGTERM set stop_requested(); a second one ends the program at once with status 130 (what was
/// finished is on disk all the same).
void listen_for_interrupts();

}  // namespace calomel
