#include "pipeline/io/stream/source.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/fail.h"

namespace rfsmooth::pipeline::io {
namespace {

// Between polls for a cancel; large enough that the calls cost nothing.
constexpr std::size_t kReadChunk = std::size_t{16} << 20;

std::size_t read_some(int file, char* out, std::size_t n, const Context& context) {
  for (;;) {
    context.check_stop();  // a signal ends the wait for a pipe or a terminal
    const ssize_t got = ::read(file, out, n);
    if (got >= 0) return std::size_t(got);
    if (errno != EINTR) fail(ErrorCode::input_unreadable, "{}", std::strerror(errno));
  }
}

Bytes read_all(int file, const Context& context) {
  Bytes all;
  for (;;) {
    context.check_stop();
    const std::size_t had = all.size();
    all.resize(had + std::max<std::size_t>(std::size_t{1} << 16, had / 2));
    const std::size_t got = read_some(file, all.data() + had, all.size() - had, context);
    all.resize(had + got);
    if (got == 0) return all;
  }
}

}  // namespace

Source::Source(const std::filesystem::path& path, const Context& context) : name_(path.string()) {
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) fail("cannot open: {}", std::strerror(errno));
  struct stat info {};
  try {
    if (::fstat(file_, &info) != 0) fail("{}", std::strerror(errno));
    if (S_ISDIR(info.st_mode)) fail("is a directory, expected a file");
    size_ = std::uint64_t(info.st_size);
    if (!S_ISREG(info.st_mode)) {
      held_ = read_all(file_, context);
      bytes_ = {held_.data(), held_.size()};
      size_ = bytes_.size();
      ::close(file_);
      file_ = -1;
    }
  } catch (...) {
    if (file_ >= 0) ::close(file_);
    throw;
  }
}

Source::Source(std::string_view bytes, std::string name)
    : name_(std::move(name)), size_(bytes.size()), bytes_(bytes) {}

Source::~Source() {
  if (file_ >= 0) ::close(file_);
}

void Source::check_range(std::uint64_t offset, std::size_t n) const {
  const std::uint64_t left = size_ - std::min(size_, offset);
  if (n > left) fail("byte {}: expected {}, found {}", offset, counted(n, "byte"), left);
}

void Source::read(std::uint64_t offset, char* out, std::size_t n, const Context& context) const {
  check_range(offset, n);
  if (file_ < 0) {
    if (n > 0) std::memcpy(out, bytes_.data() + offset, n);
    return;
  }
  while (n > 0) {
    context.check_stop();
    const ssize_t got = ::pread(file_, out, std::min(n, kReadChunk), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("byte {}: {}", offset, std::strerror(errno));
    if (got == 0) fail("byte {}: the file became shorter while it was read", offset);
    offset += std::uint64_t(got);
    out += got;
    n -= std::size_t(got);
  }
}

Bytes Source::read(std::uint64_t offset, std::size_t n, const Context& context) const {
  check_range(offset, n);
  Bytes bytes(n);
  read(offset, bytes.data(), n, context);
  return bytes;
}

}  // namespace rfsmooth::pipeline::io
