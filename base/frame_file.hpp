#pragma once
/// An append-only file of checksummed records ("frames") behind a head that identifies their owner: what long work keeps, so that a
/// kill at any instant loses at most the record being written.
///
/// Layout: the kind's line of text, then frames. A frame is {u64 bytes, u64 checksum, payload}, little-endian; the checksum is FNV-1a
/// over the payload. The first frame is the provenance as JSON text.
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/artefact.hpp"

namespace calomel {

struct Provenance;

/// Puts numbers and lists of numbers one after another into bytes.
class ByteWriter {
 public:
  std::string bytes;
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  template <class T>
  void values(std::span<const T> v) {
    value(std::uint64_t(v.size()));
    bytes.append(reinterpret_cast<const char*>(v.data()), v.size_bytes());
  }
  void values(const std::vector<double>& v) { values(std::span<const double>(v)); }
  void text(std::string_view s) { values(std::span<const char>(s.data(), s.size())); }
};

/// Takes them off again in the same order. Errors: ContractFailure when there are fewer bytes than requested.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}
  template <class T>
  void into(T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    expect(rest_.size() >= sizeof(T), "a record holds what it says");
    std::memcpy(&v, rest_.data(), sizeof v);
    rest_.remove_prefix(sizeof v);
  }
  template <class T>
  T value() {
    T v;
    into(v);
    return v;
  }
  template <class T>
  std::vector<T> values() {
    const auto n = value<std::uint64_t>();
    expect(n <= rest_.size() / sizeof(T), "a record holds what it says");
    std::vector<T> v(n);
    if (n > 0) std::memcpy(v.data(), rest_.data(), n * sizeof(T));
    rest_.remove_prefix(n * sizeof(T));
    return v;
  }
  std::string text() {
    const auto v = values<char>();
    return {v.begin(), v.end()};
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

class FrameFile {
 public:
  /// A whole frame in the file.
  struct Place {
    std::uint64_t offset = 0, bytes = 0;
  };
  using Each = std::function<void(std::string_view payload, Place place)>;

  /// Opens the file at `path`, or begins one, and hands every whole frame to `each` in order, one at a time in memory; what follows the last whole one (the
  /// write that a kill tore) is cut off. `kind` is its first line, without the line end, e.g. "calomel chains 1". The file remains locked while the object
  /// lives. Errors: InputError when the file is of another kind, was begun with other settings (naming the changed keys; the file is left as it is), is in use
  /// by another process, or cannot be written.
  FrameFile(std::filesystem::path path, const std::string& kind, const Provenance& provenance, const Each& each);
  ~FrameFile();
  FrameFile(const FrameFile&) = delete;
  FrameFile& operator=(const FrameFile&) = delete;

  /// Adds a frame; safe from several threads. The system is asked to reach the disk at least every half second, so a kill loses nothing and a power cut half
  /// a second. Errors: InputError when the disk is full.
  Place append(std::string_view payload);
  /// The frame at a place that this file gave. Errors: InputError when the file was changed meanwhile.
  [[nodiscard]] std::string read(Place place) const;

  /// Identity of the settings that the file at `path` was begun with; empty when it is absent or of another kind.
  static std::string identity(const std::filesystem::path& path, const std::string& kind);

 private:
  void write(std::string_view bytes);
  std::filesystem::path path_;
  int file_ = -1;
  std::mutex lock_;
  std::uint64_t end_ = 0;  ///< where the next frame goes
  std::chrono::steady_clock::time_point synced_;
};

}  // namespace calomel
