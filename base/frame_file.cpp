#include "base/frame_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>

#include "base/provenance.hpp"

namespace calomel {

static_assert(std::endian::native == std::endian::little, "frames are written in the machine's own order of bytes");

namespace {

constexpr std::size_t head_bytes = 16;

std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t h = 14695981039346656037ull;
  for (const char c : bytes) h = (h ^ std::uint8_t(c)) * 1099511628211ull;
  return h;
}

std::string frame(std::string_view payload) {
  ByteWriter out;
  out.value(std::uint64_t(payload.size()));
  out.value(checksum(payload));
  return out.bytes.append(payload);
}

InputError unwritable(const std::filesystem::path& path) {
  return InputError({.problem = std::string("cannot be written: ") + std::strerror(errno),
                     .suggestion = "check the free space and the rights; what is finished is kept",
                     .file = path.string()});
}

std::string read_all(int file, const std::filesystem::path& path) {
  struct stat status {};
  if (::fstat(file, &status) != 0) throw unwritable(path);
  std::string bytes(std::size_t(status.st_size), '\0');
  for (std::size_t at = 0; at < bytes.size();) {
    const auto got = ::pread(file, bytes.data() + at, bytes.size() - at, off_t(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw unwritable(path);
    at += std::size_t(got);
  }
  return bytes;
}

/// The payload of the frame at the front of `bytes`; none when no whole frame stands there.
std::string_view first_frame(std::string_view bytes) {
  if (bytes.size() < head_bytes) return {};
  ByteReader head(bytes);
  const auto size = head.value<std::uint64_t>(), sum = head.value<std::uint64_t>();
  if (size == 0 || size > bytes.size() - head_bytes) return {};
  const auto payload = bytes.substr(head_bytes, size);
  return checksum(payload) == sum ? payload : std::string_view();
}

}  // namespace

FrameFile::FrameFile(std::filesystem::path path, const std::string& kind, const Provenance& provenance, const Each& each) : path_(std::move(path)) {
  make_directory(path_.parent_path());
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw unwritable(path_);
  try {
    struct stat status {};
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0 || (::fstat(file_, &status) == 0 && status.st_nlink == 0))
      throw InputError({.problem = "another calomel is at work on this", .suggestion = "wait for it, or use another --out", .file = path_.string()});
    std::string bytes = read_all(file_, path_);
    const std::string magic = kind + '\n', own_head = magic + frame(provenance.json().dump());
    if (bytes.size() < own_head.size() && own_head.starts_with(bytes)) {  // new, or killed before the head was whole
      write(own_head);
      bytes = own_head;
    }
    const auto before = bytes.starts_with(magic) ? first_frame(std::string_view(bytes).substr(magic.size())) : std::string_view();
    if (before.empty())
      throw InputError({.problem = "is not a file of \"" + kind + "\", or its head is damaged", .suggestion = "--fresh sets it aside", .file = path_.string()});
    expect_same_provenance(Json::parse(before), provenance, path_);
    end_ = magic.size() + head_bytes + before.size();
    for (std::string_view payload; !(payload = first_frame(std::string_view(bytes).substr(end_))).empty(); end_ += head_bytes + payload.size()) each(payload);
    if (end_ < bytes.size() && ::ftruncate(file_, off_t(end_)) != 0) throw unwritable(path_);
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
  if (::fdatasync(file_) != 0) throw unwritable(path_);
  end_ += bytes.size();
}

void FrameFile::append(std::string_view payload) {
  expect(!payload.empty(), "a frame holds something");
  const std::string bytes = frame(payload);
  const std::lock_guard guard(lock_);
  write(bytes);
}

}  // namespace calomel
