#pragma once
/// What a command prints on the way, line by line.
#include <ostream>
#include <span>
#include <string>

namespace calomel {

class Notes {
 public:
  /// `out` outlives the object. Nothing is printed when quiet.
  Notes(std::ostream& out, bool quiet) : out_(out), quiet_(quiet) {}

  [[nodiscard]] bool quiet() const { return quiet_; }
  /// One line.
  void say(const std::string& line) const {
    if (!quiet_) out_ << line << '\n';
  }
  void say(std::span<const std::string> lines) const {
    for (const auto& line : lines) say(line);
  }
  /// "warning: WHAT", a line each.
  void warn(const std::string& what) const { say("warning: " + what); }
  void warn(std::span<const std::string> all) const {
    for (const auto& what : all) warn(what);
  }

 private:
  std::ostream& out_;
  bool quiet_;
};

}  // namespace calomel
