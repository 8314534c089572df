#pragma once
/// How far long work has come: a bar on a terminal, plain lines elsewhere, nothing when quiet.
#include <chrono>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

namespace calomel {

/// 59 s, 12 min, 3 h 20 min.
std::string duration_text(double seconds);

class ProgressDisplay {
 public:
  enum class Style { silent, lines, bar };
  using Clock = std::function<double()>;  ///< [s], monotonic

  /// `what` is done, e.g. "campaign"; `unit` names what is counted, e.g. "runs".
  ProgressDisplay(std::string what, std::string unit, Style style, std::ostream& out, Clock clock = {});
  /// Ends an open bar with a new line.
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// Reports `done` of `total`; `note` is added, e.g. "2 failed". Rate and time left count from the first call, so that
  /// reused work does not flatter them. A bar is drawn at most ten times a second, a line written every ten seconds.
  void update(std::size_t done, std::size_t total, const std::string& note = "");

 private:
  std::string what_, unit_;
  Style style_;
  std::ostream& out_;
  Clock clock_;
  std::optional<double> began_, shown_;
  std::size_t first_ = 0;
  std::size_t width_ = 0;  ///< of the present line of the bar
};

/// silent when quiet, a bar when stderr is a terminal, else lines.
ProgressDisplay::Style progress_style(bool quiet);

}  // namespace calomel
