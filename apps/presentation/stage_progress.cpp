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
    const bool another = what != what_ || done < done_ || total != total_;  // the next batch of runs is timed by itself
    if (another) display_.reset(), display_.emplace(stage_, what, style_, std::cerr);
    what_ = what;
    done_ = done;
    total_ = total;
    display_->update(done, total);
  }

 private:
  std::string stage_, what_;
  std::size_t done_ = 0, total_ = 0;
  ProgressDisplay::Style style_;
  std::optional<ProgressDisplay> display_;
};

}  // namespace

CalibrationProgress stage_progress(const std::string& stage, bool quiet) {
  const auto display = std::make_shared<StageDisplay>(stage, quiet);
  return [display](const std::string& what, std::size_t done, std::size_t total) { (*display)(what, done, total); };
}

}  // namespace calomel
