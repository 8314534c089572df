#pragma once
/// Every run of the true model that any method asked for, by the numbers of the case that it was made at. One journal, runs.journal, for all methods: none
/// keeps runs of its own, and what one has paid for serves the others.
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "forward/campaign/journal.hpp"

namespace calomel {

/// Where a run is made: dotted keys of the case and their values, among them parameters, mechanism values, the viscosity
/// ("material.mercury.regularising_viscosity") and the element size ("geometry.element_size"). Numbers that are not named are the case's own.
using RunPoint = std::map<std::string, double>;

/// "key=value key=value ...", the values with all their digits: two points are the same run when their texts are.
std::string text_of(const RunPoint& point);
/// The point of such a text. Errors: contract failure for another text.
RunPoint point_of(const std::string& text);

struct StoredRun {
  RunPoint point;
  RunRecord record;
};

class RunStore {
 public:
  /// One run; what goes wrong at a point is its record.
  using Evaluate = std::function<RunRecord(const RunPoint&)>;
  /// Relative cost of a run at a point: the dear ones are begun first. Empty: all alike.
  using Cost = std::function<double(const RunPoint&)>;
  using Progress = std::function<void(std::size_t done, std::size_t total)>;

  /// Opens or begins runs.journal in `directory`. `provenance` names the case without the numbers that points may set.
  /// Errors: InputError when it was begun with other settings, is in use, or cannot be written.
  RunStore(const Provenance& provenance, const std::filesystem::path& directory);

  /// The runs at `points`, in their order; those that the journal does not hold are made on `threads` threads, each kept as it ends.
  /// Errors: those of `evaluate`; Interrupted when `stop` became true, after the runs in progress.
  std::vector<StoredRun> run(std::span<const RunPoint> points, const Evaluate& evaluate, int threads, const Cost& cost = {}, const Progress& progress = {},
                             const std::atomic<bool>* stop = nullptr);

  /// All runs held, in the order of their texts.
  [[nodiscard]] std::vector<StoredRun> all() const;
  [[nodiscard]] std::size_t size() const { return journal_.size(); }
  /// Runs of this object's life that were made, and that the journal held.
  [[nodiscard]] std::size_t made() const { return made_; }
  [[nodiscard]] std::size_t reused() const { return reused_; }

 private:
  Journal journal_;
  std::size_t made_ = 0, reused_ = 0;
};

}  // namespace calomel
