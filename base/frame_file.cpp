#include "base/frame_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>

#include "base/artefact.hpp"
#include "base/identity.hpp"
#include "base/provenance.hpp"

namespace calomel {

static_assert(std::endian::native == std::endian::little, "frames are written in the machine's own order of bytes");

namespace {

constexpr std::size_t head_bytes = 16;

std::string frame(std::string_view payload) {
  ByteWriter out;
  out.value(std::uint64_t(payload.size()));
  out.value(hash_of(payload));
  return out.bytes.append(payload);
}

InputError unwritable(const std::filesystem::path& path) {
  return InputError({.problem = std::string("cannot be written: ") + std::strerror(errno),
                     .suggestion = "check the free space and the permissions; finished work is kept",
                     .file = path.string()});
}

bool read_at(int file, std::uint64_t offset, char* into, std::uint64_t bytes) {
  while (bytes > 0) {
    const auto got = ::pread(file, into, bytes, off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    into += got;
    offset += std::uint64_t(got);
    bytes -= std::uint64_t(got);
  }
  return true;
}

std::uint64_t size_of(int file, const std::filesystem::path& path) {
  struct stat status {};
  if (::fstat(file, &status) != 0) throw unwritable(path);
  return std::uint64_t(status.st_size);
}

/// The payload of the frame at `offset`; empty if there is no complete frame there below `limit`.
std::string frame_at(int file, std::uint64_t offset, std::uint64_t limit) {
  std::uint64_t head[2];
  if (limit < offset + head_bytes || !read_at(file, offset, reinterpret_cast<char*>(head), head_bytes)) return {};
  if (head[0] == 0 || head[0] > limit - offset - head_bytes) return {};
  std::string payload(head[0], '\0');
  if (!read_at(file, offset + head_bytes, payload.data(), payload.size()) || hash_of(payload) != head[1]) return {};
  return payload;
}

/// The provenance at the head of a file whose first line is `magic`; empty when it is none.
std::string provenance_of(int file, std::uint64_t size, const std::string& magic) {
  std::string start(magic.size(), '\0');
  if (size < magic.size() || !read_at(file, 0, start.data(), start.size()) || start != magic) return {};
  return frame_at(file, magic.size(), size);
}

}  // namespace

std::string FrameFile::identity(const std::filesystem::path& path, const std::string& kind) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  struct stat status {};
  const std::string head = ::fstat(file, &status) == 0 ? provenance_of(file, std::uint64_t(status.st_size), kind + '\n') : "";
  ::close(file);
  return head.empty() ? "" : identity_of(Json::parse(head));
}

FrameFile::FrameFile(std::filesystem::path path, const std::string& kind, const Provenance& provenance, const Each& each)
    : path_(std::move(path)), synced_(std::chrono::steady_clock::now()) {
  make_directory(path_.parent_path());
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw unwritable(path_);
  try {
    struct stat status {};
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0 || (::fstat(file_, &status) == 0 && status.st_nlink == 0))
      throw InputError({.problem = "another calomel is at work on this", .suggestion = "wait for it, or use another --out", .file = path_.string()});
    const std::string magic = kind + '\n', own_head = magic + frame(provenance.json().dump());
    std::uint64_t size = size_of(file_, path_);
    std::string head(std::min<std::uint64_t>(size, own_head.size()), '\0');
    if (!read_at(file_, 0, head.data(), head.size())) throw unwritable(path_);
    if (size < own_head.size() && own_head.starts_with(head)) {  // new, or killed before the head was whole
      write(own_head);
      size = own_head.size();
    }
    const std::string before = provenance_of(file_, size, magic);
    if (before.empty())
      throw InputError({.problem = "is not a file of \"" + kind + "\", or its head is damaged", .suggestion = "--fresh sets it aside", .file = path_.string()});
    expect_same_provenance(Json::parse(before), provenance, path_);
    end_ = magic.size() + head_bytes + before.size();
    for (std::string payload; !(payload = frame_at(file_, end_, size)).empty(); end_ += head_bytes + payload.size()) each(payload, {end_, payload.size()});
    if (end_ < size && ::ftruncate(file_, off_t(end_)) != 0) throw unwritable(path_);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

FrameFile::~FrameFile() { ::close(file_); }

/// Writes at the end; `end_` moves only when all is written, so that the next write goes over a torn one.
void FrameFile::write(std::string_view bytes) {
  for (std::uint64_t written = 0; written < bytes.size();) {
    const auto n = ::pwrite(file_, bytes.data() + written, bytes.size() - written, off_t(end_ + written));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw unwritable(path_);
    written += std::uint64_t(n);
  }
  end_ += bytes.size();
}

FrameFile::Place FrameFile::append(std::string_view payload) {
  expect(!payload.empty(), "a frame holds something");
  const std::string bytes = frame(payload);
  const std::lock_guard guard(lock_);
  const Place place{end_, payload.size()};
  write(bytes);
  if (const auto now = std::chrono::steady_clock::now(); now - synced_ > std::chrono::milliseconds(500)) {
    if (::fdatasync(file_) != 0) throw unwritable(path_);
    synced_ = now;
  }
  return place;
}

std::string FrameFile::read(Place place) const {
  std::string payload = frame_at(file_, place.offset, place.offset + head_bytes + place.bytes);
  if (payload.empty())
    throw InputError({.problem = "changed while it was in use", .suggestion = "run the same command again to resume", .file = path_.string()});
  return payload;
}

}  // namespace calomel
