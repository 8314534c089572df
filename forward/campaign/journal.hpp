#pragma once
/// The journal of a campaign under way: one append-only file to which every finished run is added as it ends. An HDF5
/// file that is killed while being written cannot be read again; a journal loses at most its torn last record.
///
/// Layout: "calomel campaign journal 1\n", then frames. A frame is {u64 bytes, u64 checksum, payload}, little-endian; the
/// checksum is FNV-1a over the payload. The first frame is the provenance as JSON text, each later one a run.
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "base/options.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// What one run left: the values in single precision, as campaign.nc keeps them.
struct RunRecord {
  bool done = false;
  std::string message;              ///< why the run failed
  std::vector<float> mean;          ///< (condition, sensor, time) [-]
  std::vector<float> energy_slope;  ///< the same shape, or empty
  std::vector<float> scatter;       ///< the same shape, or empty
  std::vector<float> pulses;        ///< (pulse, condition, sensor, time), or empty
  std::vector<double> energies;     ///< (pulse)
  std::string point;                ///< what was run, in a journal of runs that no design numbers; empty otherwise
  bool operator==(const RunRecord&) const = default;
};

/// Identity of the settings that the journal at `path` was begun with; empty when it is absent or no journal.
std::string journal_identity(const std::filesystem::path& path);

class Journal {
 public:
  /// Opens the journal at `path`, or begins one. Whole records are kept, and what follows the last whole record (the
  /// write that a kill tore) is cut off. The file stays locked while the object lives.
  /// Errors: InputError when the file is no journal, was begun with other settings (naming the changed keys; the file is
  /// left as it is), is in use by another process, or cannot be written.
  Journal(std::filesystem::path path, const Provenance& provenance);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] bool contains(std::size_t run) const;
  /// Numbers of the runs held, ascending.
  [[nodiscard]] std::vector<std::size_t> runs() const;
  /// Number of runs held.
  [[nodiscard]] std::size_t size() const;
  /// Adds a run; safe from several threads. The system is asked to reach the disk at least every half second, so a kill
  /// loses nothing and a power cut half a second. Errors: InputError when the disk is full.
  void append(std::size_t run, const RunRecord& record);
  /// The record of `run`, which must be held.
  [[nodiscard]] RunRecord read(std::size_t run) const;
  /// Deletes the file, once the archive stands.
  void remove();

 private:
  struct Place {
    std::uint64_t offset, bytes;
  };
  void scan(const Provenance& provenance);
  void write(std::string_view bytes);

  std::filesystem::path path_;
  int file_ = -1;
  mutable std::mutex lock_;
  std::map<std::size_t, Place> places_;
  std::uint64_t end_ = 0;  ///< where the next frame goes
  std::chrono::steady_clock::time_point synced_;
};

}  // namespace calomel
