#include "forward/campaign/journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>

#include "base/artefact.hpp"
#include "base/identity.hpp"
#include "base/provenance.hpp"

namespace calomel {

static_assert(std::endian::native == std::endian::little, "the journal is written in the machine's own order of bytes");

namespace {

constexpr std::string_view magic = "calomel campaign journal 1\n";
constexpr std::size_t head_bytes = 16;

std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t h = 14695981039346656037ull;
  for (const char c : bytes) h = (h ^ std::uint8_t(c)) * 1099511628211ull;
  return h;
}

template <class T>
void put(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T>
void put(std::string& out, const std::vector<T>& values) {
  put(out, std::uint64_t(values.size()));
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Takes values off the front of a payload whose checksum has held.
struct Taker {
  std::string_view rest;
  template <class T>
  T value() {
    expect(rest.size() >= sizeof(T), "a journal record holds what it says");
    T v;
    std::memcpy(&v, rest.data(), sizeof v);
    rest.remove_prefix(sizeof v);
    return v;
  }
  template <class T>
  std::vector<T> values() {
    const auto n = value<std::uint64_t>();
    expect(n <= rest.size() / sizeof(T), "a journal record holds what it says");
    std::vector<T> v(n);
    if (n > 0) std::memcpy(v.data(), rest.data(), n * sizeof(T));
    rest.remove_prefix(n * sizeof(T));
    return v;
  }
};

std::string frame(std::string_view payload) {
  std::string out;
  out.reserve(payload.size() + head_bytes);
  put(out, std::uint64_t(payload.size()));
  put(out, checksum(payload));
  out += payload;
  return out;
}

bool read_at(int file, std::uint64_t offset, char* into, std::uint64_t bytes) {
  while (bytes > 0) {
    const auto got = ::pread(file, into, bytes, off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    into += got, offset += std::uint64_t(got), bytes -= std::uint64_t(got);
  }
  return true;
}

InputError unwritable(const std::filesystem::path& path) {
  return InputError({.problem = std::string("cannot be written: ") + std::strerror(errno),
                     .suggestion = "check the free space and the rights; the runs that are finished are kept",
                     .file = path.string()});
}

/// The payload of the frame at `offset`; empty when no whole frame stands there below `limit`.
std::string read_frame(int file, std::uint64_t offset, std::uint64_t limit) {
  std::uint64_t head[2];
  if (limit < offset + head_bytes || !read_at(file, offset, reinterpret_cast<char*>(head), head_bytes)) return {};
  if (head[0] < sizeof(std::uint64_t) || head[0] > limit - offset - head_bytes) return {};
  std::string payload(head[0], '\0');
  if (!read_at(file, offset + head_bytes, payload.data(), payload.size()) || checksum(payload) != head[1]) return {};
  return payload;
}

/// The provenance at the head; empty when this is no journal.
std::string read_head(int file, std::uint64_t size) {
  std::string start(magic.size(), '\0');
  if (size < magic.size() || !read_at(file, 0, start.data(), start.size()) || start != magic) return {};
  return read_frame(file, magic.size(), size);
}

}  // namespace

std::string journal_identity(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  struct stat status {};
  const std::string head = ::fstat(file, &status) == 0 ? read_head(file, std::uint64_t(status.st_size)) : "";
  ::close(file);
  return head.empty() ? "" : identity_of(Json::parse(head));
}

Journal::Journal(std::filesystem::path path, const Provenance& provenance) : path_(std::move(path)), synced_(std::chrono::steady_clock::now()) {
  make_directory(path_.parent_path());
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw unwritable(path_);
  try {
    struct stat status {};
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0 || (::fstat(file_, &status) == 0 && status.st_nlink == 0))
      throw InputError({.problem = "another calomel is at work on this campaign", .suggestion = "wait for it, or use another --out", .file = path_.string()});
    scan(provenance);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() { ::close(file_); }

void Journal::scan(const Provenance& provenance) {
  struct stat status {};
  if (::fstat(file_, &status) != 0) throw unwritable(path_);
  auto size = std::uint64_t(status.st_size);
  const std::string own_head = std::string(magic) + frame(provenance.json().dump());
  std::string head(std::min<std::uint64_t>(size, own_head.size()), '\0');
  if (!read_at(file_, 0, head.data(), head.size())) throw unwritable(path_);
  if (size < own_head.size() && own_head.starts_with(head)) {  // new, or killed before the head was whole
    end_ = 0;
    write(own_head);
    size = own_head.size();
  }
  const std::string before = read_head(file_, size);
  if (before.empty())
    throw InputError({.problem = "is not a campaign's journal, or its head is damaged", .suggestion = "--fresh sets it aside", .file = path_.string()});
  expect_same_provenance(Json::parse(before), provenance, path_);
  end_ = magic.size() + head_bytes + before.size();
  for (std::string payload; !(payload = read_frame(file_, end_, size)).empty(); end_ += head_bytes + payload.size())
    places_[Taker{payload}.value<std::uint64_t>()] = {end_, payload.size()};
  if (end_ < size && ::ftruncate(file_, off_t(end_)) != 0) throw unwritable(path_);
}

/// Writes at the end; `end_` moves only when all is written, so that the next write goes over a torn one.
void Journal::write(std::string_view bytes) {
  for (std::uint64_t written = 0; written < bytes.size();) {
    const auto n = ::pwrite(file_, bytes.data() + written, bytes.size() - written, off_t(end_ + written));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw unwritable(path_);
    written += std::uint64_t(n);
  }
  end_ += bytes.size();
}

bool Journal::contains(std::size_t run) const {
  const std::lock_guard guard(lock_);
  return places_.contains(run);
}

std::vector<std::size_t> Journal::runs() const {
  const std::lock_guard guard(lock_);
  std::vector<std::size_t> numbers;
  for (const auto& [run, place] : places_) numbers.push_back(run);
  return numbers;
}

std::size_t Journal::size() const {
  const std::lock_guard guard(lock_);
  return places_.size();
}

void Journal::append(std::size_t run, const RunRecord& record) {
  std::string payload;
  put(payload, std::uint64_t(run));
  put(payload, std::uint8_t(record.done));
  put(payload, std::vector<char>(record.message.begin(), record.message.end()));
  put(payload, record.mean);
  put(payload, record.energy_slope);
  put(payload, record.scatter);
  put(payload, record.pulses);
  put(payload, record.energies);
  if (!record.point.empty()) put(payload, std::vector<char>(record.point.begin(), record.point.end()));
  const std::string bytes = frame(payload);

  const std::lock_guard guard(lock_);
  places_.erase(run);
  const Place place{end_, payload.size()};
  write(bytes);
  places_[run] = place;
  if (const auto now = std::chrono::steady_clock::now(); now - synced_ > std::chrono::milliseconds(500)) {
    if (::fdatasync(file_) != 0) throw unwritable(path_);
    synced_ = now;
  }
}

RunRecord Journal::read(std::size_t run) const {
  std::optional<Place> place;
  {
    const std::lock_guard guard(lock_);
    if (const auto at = places_.find(run); at != places_.end()) place = at->second;
  }
  expect(place.has_value(), "only a run that the journal holds is read");
  const std::string payload = read_frame(file_, place->offset, place->offset + head_bytes + place->bytes);
  if (payload.empty())
    throw InputError({.problem = "changed while it was in use", .suggestion = "run the same command again to resume", .file = path_.string()});
  Taker taker{payload};
  expect(taker.value<std::uint64_t>() == run, "a journal record is of the run it is filed under");
  RunRecord record;
  record.done = taker.value<std::uint8_t>() != 0;
  const auto message = taker.values<char>();
  record.message.assign(message.begin(), message.end());
  record.mean = taker.values<float>();
  record.energy_slope = taker.values<float>();
  record.scatter = taker.values<float>();
  record.pulses = taker.values<float>();
  record.energies = taker.values<double>();
  if (!taker.rest.empty()) {
    const auto point = taker.values<char>();
    record.point.assign(point.begin(), point.end());
  }
  return record;
}

void Journal::remove() {
  std::error_code error;
  std::filesystem::remove(path_, error);
  if (error) throw InputError({.problem = "cannot be removed: " + error.message(), .file = path_.string()});
}

}  // namespace calomel
