#pragma once
/// Every run of the true model that a campaign or a method asked for, by the numbers of the case that it was made at. One journal for all: what one has paid
/// for serves the others.
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "base/frame_file.hpp"
#include "forward/parameter.hpp"
#include "forward/runs/run_record.hpp"

namespace calomel {

/// Where a run is made: dotted keys of the case and their values, among them parameters, mechanism values, the viscosity
/// ("material.mercury.regularising_viscosity") and the element size ("geometry.element_size"). Numbers that are not named are the case's own.
using RunPoint = std::map<std::string, double>;

/// The parameters' keys at `theta`, (n_parameters).
RunPoint point_at(std::span<const Parameter> parameters, std::span<const double> theta);
/// The values of the parameters at a point, (n_parameters). Errors: ContractFailure when it lacks one.
std::vector<double> theta_at(std::span<const Parameter> parameters, const RunPoint& point);

/// "key=value key=value ...", the values with all their digits: two points are the same run when their texts are.
std::string text_of(const RunPoint& point);
/// The point of such a text. Errors: contract failure for another text.
RunPoint point_of(const std::string& text);

class RunStore {
 public:
  /// One run; what goes wrong at a point is its record.
  using Evaluate = std::function<RunRecord(const RunPoint&)>;
  /// Relative cost of a run at a point: the dear ones are begun first. Empty: all alike.
  using Cost = std::function<double(const RunPoint&)>;
  /// Told before the first run that must be made and after each.
  using Progress = std::function<void(std::size_t done, std::size_t total)>;

  /// Opens or begins the journal at `path`. `provenance` names the case without the numbers that points may set.
  /// Errors: InputError when it was begun with other settings, is in use, or cannot be written.
  RunStore(const Provenance& provenance, const std::filesystem::path& path);

  /// Makes those of `points` that the journal does not hold, on `threads` threads, each kept as it ends: in the journal, or, where no answer came, as long as
  /// the object lives, so that another call asks again. Safe from several threads for points that differ. Errors: those of `evaluate`; Interrupted when `stop`
  /// became true, after the runs in progress.
  void make(std::span<const RunPoint> points, const Evaluate& evaluate, int threads, const Cost& cost = {}, const Progress& progress = {},
            const std::atomic<bool>* stop = nullptr);
  /// The same, and gives the runs at `points` in their order.
  std::vector<RunRecord> run(std::span<const RunPoint> points, const Evaluate& evaluate, int threads, const Cost& cost = {}, const Progress& progress = {},
                             const std::atomic<bool>* stop = nullptr);

  /// Whether the journal holds it.
  [[nodiscard]] bool contains(const RunPoint& point) const;
  /// The run at a point that is held.
  [[nodiscard]] RunRecord read(const RunPoint& point) const;
  /// The points of all runs held, in the order of their texts.
  [[nodiscard]] std::vector<RunPoint> points() const;
  [[nodiscard]] std::size_t size() const;
  /// Runs of this object's life to which no answer came, and whether that at a point is one.
  [[nodiscard]] std::size_t lost() const;
  [[nodiscard]] bool lost(const RunPoint& point) const;
  /// Runs of this object's life that were made, and that were asked for and held.
  [[nodiscard]] std::size_t made() const { return made_; }
  [[nodiscard]] std::size_t reused() const { return reused_; }

  /// Deletes the file, once what was made of the runs stands.
  void remove();
  /// Identity of the settings that the store at `path` was begun with; empty when it is absent or no store.
  static std::string identity(const std::filesystem::path& path);

 private:
  std::filesystem::path path_;
  mutable std::mutex lock_;
  std::map<std::string, FrameFile::Place> places_;
  std::map<std::string, RunRecord> lost_;
  FrameFile file_;  ///< after places_, which its constructor fills
  std::size_t made_ = 0, reused_ = 0;
};

}  // namespace calomel
