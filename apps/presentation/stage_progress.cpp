#include "apps/presentation/stage_progress.hpp"

#include <iostream>
#include <memory>
#include <optional>

#include "apps/interrupt.hpp"
#include "apps/presentation/progress.hpp"

namespace calomel {

namespace {

class StageDisplay {
 public:
  StageDisplay(std::string stage, bool quiet) : stage_(std::move(stage)), style_(progress_style(quiet)) {}
  void operator()(const std::string& what, std::size_t done, std::size_t total) {
    if (stop_requested()) throw Interrupted();
    if (what != what_) display_.reset(), display_.emplace(stage_, what, style_, std::cerr), what_ = what;
    display_->update(done, total);
  }

 private:
  std::string stage_, what_;
  ProgressDisplay::Style style_;
  std::optional<ProgressDisplay> display_;
};

}  // namespace

CalibrationProgress stage_progress(const std::string& stage, bool quiet) {
  const auto display = std::make_shared<StageDisplay>(stage, quiet);
  return [display](const std::string& what, std::size_t done, std::size_t total) { (*display)(what, done, total); };
}

}  // namespace calomel
