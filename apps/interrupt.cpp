#include "apps/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <string_view>

#include "base/errors.hpp"

namespace calomel {

namespace {

std::atomic<bool> stop{false};  // a signal handler reaches nothing but a global
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_signal(int) {
  if (stop.exchange(true)) ::_exit(int(ExitStatus::interrupted));
  constexpr std::string_view text = "\ncalomel: stopping after the work in progress; once more to stop at once\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

}  // namespace

const std::atomic<bool>& stop_requested() { return stop; }

void listen_for_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

}  // namespace calomel
