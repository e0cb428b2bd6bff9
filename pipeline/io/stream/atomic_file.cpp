#include "pipeline/io/stream/atomic_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/fail.h"

namespace rfsmooth::pipeline::io {
namespace {

// Between polls for a cancel.
constexpr std::size_t kChunk = std::size_t{16} << 20;

// From here on the room is asked for before it is filled: a full disk says so before anything is written, and
// ext4 need not hurry the bytes to the disk when the file takes another's name (it does for blocks not yet
// placed).
constexpr std::size_t kReserve = std::size_t{1} << 20;

constexpr const char* kExists = "exists already; `force` replaces it";

[[noreturn]] void refuse(const std::filesystem::path& target, const std::string& why) {
  fail(ErrorCode::cannot_write, "{}: {}", target.string(), why);
}

// The open file that a path stands for by its number: /dev/stdout, /dev/fd/N and the like, which a shell
// gives as the name of a pipe. What is behind it may have no name, or one of a file that the shell has
// opened.
std::optional<int> descriptor_of(const std::filesystem::path& path) {
  if (path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  if (path.parent_path() != "/dev/fd" && path.parent_path() != "/proc/self/fd") return std::nullopt;
  const std::string number = path.filename().string();
  int descriptor = 0;
  const char* const end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, descriptor);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return descriptor;
}

// Refuses an open file that cannot be written.
void check_descriptor(const std::filesystem::path& shown, int descriptor) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0) refuse(shown, fmt::format("cannot write: {}", std::strerror(errno)));
  if ((flags & O_ACCMODE) == O_RDONLY) refuse(shown, "cannot write: is open for reading only");
}

// The file that a chain of symbolic links ends at, which need not exist, or the name of an open one.
std::filesystem::path follow_links(const std::filesystem::path& target) {
  constexpr int kMostLinks = 40;  // as Linux
  std::filesystem::path path = target;
  std::error_code error;
  for (int k = 0; k < kMostLinks; ++k) {
    if (descriptor_of(path) || !std::filesystem::is_symlink(std::filesystem::symlink_status(path, error)))
      return path;
    const std::filesystem::path next = std::filesystem::read_symlink(path, error);
    if (error) refuse(target, error.message());
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  refuse(target, "too many symbolic links");
}

std::filesystem::path folder_of(const std::filesystem::path& target) {
  const std::filesystem::path folder = target.parent_path();
  return folder.empty() ? std::filesystem::path(".") : folder;
}

std::optional<struct stat> status_of(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) return info;
  return std::nullopt;
}

// Refuses what cannot be a target; returns what stands there now.
std::optional<struct stat> check(const std::filesystem::path& shown, const std::filesystem::path& target,
                                 bool replace) {
  const auto folder = status_of(folder_of(target));
  if (!folder)
    refuse(shown, fmt::format("cannot write: the folder '{}': {}", folder_of(target).string(),
                              std::strerror(errno)));
  if (!S_ISDIR(folder->st_mode))
    refuse(shown, fmt::format("cannot write: '{}' is not a folder", folder_of(target).string()));
  if (!target.has_filename()) refuse(shown, "cannot write: expected a file name, found a folder");
  const auto present = status_of(target);
  if (!present && errno != ENOENT) refuse(shown, fmt::format("cannot write: {}", std::strerror(errno)));
  if (present && S_ISDIR(present->st_mode)) refuse(shown, "cannot write: is a folder, expected a file name");
  if (present && S_ISREG(present->st_mode) && !replace) refuse(shown, kExists);
  if ((!present || S_ISREG(present->st_mode)) && ::access(folder_of(target).c_str(), W_OK) != 0)
    refuse(shown, fmt::format("cannot write: the folder '{}': {}", folder_of(target).string(),
                              std::strerror(errno)));
  return present;
}

}  // namespace

std::optional<std::filesystem::path> file_behind(const std::filesystem::path& target) {
  std::filesystem::path file = follow_links(target);
  if (descriptor_of(file)) return std::nullopt;
  const auto present = status_of(file);
  if (present && !S_ISREG(present->st_mode)) return std::nullopt;
  return file;
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (error) refuse(folder, fmt::format("cannot make the folder: {}", error.message()));
}

void check_target(const std::filesystem::path& target, bool replace) {
  const std::filesystem::path file = follow_links(target);
  if (const auto open = descriptor_of(file)) return check_descriptor(target, *open);
  check(target, file, replace);
}

AtomicFile::AtomicFile(const std::filesystem::path& target, bool replace, const Context& context)
    : shown_(target), target_(follow_links(target)), replace_(replace), context_(context) {
  if (const auto open = descriptor_of(target_)) {
    check_descriptor(shown_, *open);
    file_ = ::fcntl(*open, F_DUPFD_CLOEXEC, 0);
    if (file_ < 0) fail(errno);
    return;
  }
  const auto present = check(shown_, target_, replace_);
  if (present && !S_ISREG(present->st_mode)) {
    file_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (file_ < 0) fail(errno);
    return;
  }
  // The name is hidden and tells what it is if a crash leaves it behind.
  const std::string stem =
      "." + target_.filename().string().substr(0, 200) + ".part-" + std::to_string(::getpid());
  for (int k = 0; file_ < 0; ++k) {
    temporary_ = folder_of(target_) / fmt::format("{}-{}", stem, k);
    file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ < 0 && errno != EEXIST) {
      const int error = errno;
      temporary_.clear();
      fail(error);
    }
  }
  // A file system without permissions keeps its own.
  if (present) static_cast<void>(::fchmod(file_, present->st_mode & 07777));
}

AtomicFile::~AtomicFile() {
  if (file_ >= 0) ::close(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  if (!temporary_.empty() && bytes.size() >= kReserve) reserve(bytes.size());
  while (!bytes.empty()) {
    context_.check_stop();
    const ssize_t put = ::write(file_, bytes.data(), std::min(bytes.size(), kChunk));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) fail(errno);
    bytes.remove_prefix(std::size_t(put));
  }
}

void AtomicFile::reserve(std::size_t size) {
  const off_t end = ::lseek(file_, 0, SEEK_CUR);
  if (end < 0 || ::fallocate(file_, FALLOC_FL_KEEP_SIZE, end, off_t(size)) == 0) return;
  if (errno == ENOSPC || errno == EDQUOT || errno == EFBIG) fail(errno);
}

void AtomicFile::take_name() {
  const char *const from = temporary_.c_str(), *const to = target_.c_str();
  if (!replace_) {
    if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return;
    // File systems without that call: a hard link refuses an existing name as well; some have neither.
    if (errno != EEXIST && ::link(from, to) == 0) {
      ::unlink(from);
      return;
    }
    if (errno == EEXIST || status_of(target_)) refuse(shown_, kExists);
  }
  if (::rename(from, to) != 0) fail(errno);
}

void AtomicFile::commit(bool sync) {
  context_.check_stop();
  if (sync && !temporary_.empty() && ::fsync(file_) != 0 && errno != EINVAL && errno != ENOTSUP) fail(errno);
  const int closed = ::close(file_);
  file_ = -1;
  if (closed != 0) fail(errno);
  if (temporary_.empty()) return;
  take_name();
  temporary_.clear();
  if (!sync) return;
  // The folder's entry is synced too; where that is not possible the file itself is safe already.
  const int folder = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  static_cast<void>(::fsync(folder));
  ::close(folder);
}

void AtomicFile::fail(int error) const {
  refuse(shown_, fmt::format("cannot write: {}", std::strerror(error)));
}

}  // namespace rfsmooth::pipeline::io
