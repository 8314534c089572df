#pragma once
/// The records of all runs of the true model that were ever requested for a case, in one journal. A run that one method has paid for serves the others.
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/frame_file.hpp"
#include "forward/simulation/run_record.hpp"
#include "forward/simulation/run_request.hpp"

namespace calomel {

/// A journal of runs, or the same in memory. Safe from several threads.
///
/// Version 2 of the journal: a frame is the text of the run without the wanted outputs (run_text), one byte of outputs, and the record. Version 1, of program
/// 0.1.0, had flags for wanted outputs among the numbers; such a journal is rewritten as version 2 when it is opened.
class RunStore {
 public:
  /// A store in memory alone.
  RunStore();
  /// Opens or begins the journal at `path`. `provenance` is that of the case without the numbers that requests may set.
  /// Errors: InputError when the journal was begun with other settings, is in use, or cannot be written.
  RunStore(const Provenance& provenance, const std::filesystem::path& path);

  /// Whether the outputs that the request wants are there, of a run that was done or failed.
  [[nodiscard]] bool holds(const RunRequest& request) const;
  /// The record with at least the outputs that the request wants. Errors: ContractFailure when they are not held.
  [[nodiscard]] RunRecord read(const RunRequest& request) const;
  /// Keeps a record that has the outputs which the request wants. A lost record is kept in memory only, as long as the object lives.
  void keep(const RunRequest& request, RunRecord record);

  /// All runs held, in the order of their texts; `wanted` are the outputs that are there.
  [[nodiscard]] std::vector<RunRequest> requests() const;
  [[nodiscard]] std::size_t size() const;
  /// The number of runs to which no answer came in this object's life, and whether a given run is one of them.
  [[nodiscard]] std::size_t lost() const;
  [[nodiscard]] bool lost(const RunRequest& request) const;

  /// The identity of the settings that the journal at `path` was begun with; empty when it is absent or no journal of runs.
  static std::string identity(const std::filesystem::path& path);

 private:
  /// A frame of a run: where it is, and which outputs it has.
  struct Held {
    Outputs outputs;
    FrameFile::Place place;           ///< of a journal
    std::optional<RunRecord> record;  ///< of a store in memory
  };
  [[nodiscard]] RunRecord read(const std::string& text, const Held& held) const;
  mutable std::mutex lock_;
  std::map<std::string, std::vector<Held>> held_;  ///< by run_text, oldest first
  std::map<std::string, RunRecord> lost_;
  std::optional<FrameFile> file_;  ///< after held_, which its constructor fills
};

}  // namespace calomel
