#include "apps/presentation/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace calomel {

std::string duration_text(double seconds) {
  if (seconds > 0 && seconds < 0.95) return fmt::format("{:.1f} s", std::max(0.1, seconds));
  if (seconds < 60) return fmt::format("{:.0f} s", std::max(0.0, std::ceil(seconds)));
  const auto minutes = std::llround(seconds / 60);
  return minutes < 60 ? fmt::format("{} min", minutes) : fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

ProgressDisplay::ProgressDisplay(std::string what, std::string unit, Style style, std::ostream& out, Clock clock)
    : what_(std::move(what)), unit_(std::move(unit)), style_(style), out_(out), clock_(std::move(clock)) {
  if (!clock_) clock_ = [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
}

ProgressDisplay::~ProgressDisplay() {
  if (width_ > 0) out_ << '\n' << std::flush;
}

void ProgressDisplay::update(std::size_t done, std::size_t total, const std::string& note) {
  if (style_ == Style::silent) return;
  const double now = clock_();
  if (!began_) {
    began_ = now;
    first_ = done;
  }
  const bool last = done >= total;
  if (shown_ && !last && now - *shown_ < (style_ == Style::bar ? 0.1 : 10.0)) return;
  shown_ = now;

  const double elapsed = now - *began_;
  std::string text = fmt::format("{} of {} {}", done, total, unit_);
  if (done > first_ && elapsed > 0) {
    const double rate = double(done - first_) / elapsed;
    text += fmt::format(", {:.3g}/s", rate);
    text += last ? ", took " + duration_text(elapsed) : ", " + duration_text(double(total - done) / rate) + " left";
  }
  if (!note.empty()) text += ", " + note;

  if (style_ == Style::lines) {
    out_ << what_ << ": " << text << '\n' << std::flush;
    return;
  }
  constexpr std::size_t cells = 24;
  const std::size_t filled = total ? cells * std::min(done, total) / total : cells;
  std::string line = fmt::format("{} [{}{}] {}", what_, std::string(filled, '#'), std::string(cells - filled, '.'), text);
  const std::size_t width = line.size();
  if (width < width_) line.append(width_ - width, ' ');  // overwrites the previous text
  out_ << '\r' << line << std::flush;
  width_ = width;
}

ProgressDisplay::Style progress_style(bool quiet) {
  return quiet ? ProgressDisplay::Style::silent : ::isatty(STDERR_FILENO) ? ProgressDisplay::Style::bar : ProgressDisplay::Style::lines;
}

}  // namespace calomel
