#include "pipeline/cli/own_files.h"

#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "base/fail.h"
#include "pipeline/io/detect.h"
#include "pipeline/io/io.h"
#include "pipeline/io/stream/atomic_file.h"

namespace rfsmooth::cli {

namespace {

constexpr const char* kMark = "user.rfsmooth";

/// Size and time of the last change of the file's bytes; "" if there is no regular file.
std::string state_of(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return "";
  return fmt::format("{} {}.{:09}", info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec);
}

/// Whether a regular file is there that this user may not read, so that nobody can tell what it holds.
bool is_unreadable(const std::string& path) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(path, unknown) && access(path.c_str(), R_OK) != 0;
}

/// Why a file that holds a cloud is not replaced.
const char* why_kept(const std::string& path) {
  return is_unreadable(path) ? "cannot be read and may be a cloud" : "is a cloud that rfsmooth did not write";
}

/// Whether a file carries a valid mark.
bool is_own(const std::string& path) {
  std::array<char, 100> mark{};
  const ssize_t size = getxattr(path.c_str(), kMark, mark.data(), mark.size());
  return size > 0 && std::string(mark.data(), std::size_t(size)) == state_of(path);
}

/// Whether a regular file is there that begins as a PLY, PCD, OFF or LAS file does, or that reads as points;
/// or that cannot be opened, and so may.
bool holds_cloud(const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;
  if (is_unreadable(path)) return true;
  const auto holds = guarded([&] {
    const auto format =
        pipeline::io::detect_format(pipeline::io::Source(std::filesystem::path(path), Context()), {});
    // Any text may be XYZ: that is known when it has been read.
    return format != pipeline::io::Format::xyz ||
           value_or_throw(pipeline::io::read_cloud(path, {}, {})).size() > 0;
  });
  return holds.ok() ? holds.value() : holds.error().code == ErrorCode::out_of_memory;
}

}  // namespace

void mark_as_own(const std::string& path) {
  const std::string state = state_of(path);
  if (!state.empty()) static_cast<void>(setxattr(path.c_str(), kMark, state.data(), state.size(), 0));
}

void need_own_target(const Job& job, const std::optional<std::string>& named) {
  if (job.output == "-" || named == job.output) return;
  std::error_code unknown;
  const bool meant =
      named ? !std::filesystem::equivalent(job.input, job.output, unknown) : job.output == job.input;
  if (meant || is_own(job.output) || !holds_cloud(job.output)) return;
  if (named)
    fail(ErrorCode::cannot_write,
         "{0}: is the scan itself; it stays as it is. Name another folder, or to replace it: --force {0} -o "
         "{0}",
         job.input);
  fail(ErrorCode::cannot_write,
       "{1}: {2}; it stays as it is. To replace it: --force {0} -o {1}; to work on both: {0} {1} -o FOLDER",
       job.input, job.output, why_kept(job.output));
}

void need_own_target(const std::vector<std::string>& inputs, const std::string& output) {
  std::error_code unknown;
  for (const std::string& input : inputs)
    if (std::filesystem::equivalent(input, output, unknown))
      fail(ErrorCode::cannot_write,
           "{}: is a scan of the job; it stays as it is. Name another file or folder", output);
  if (is_own(output) || !holds_cloud(output)) return;
  fail(ErrorCode::cannot_write,
       "{}: {}; it stays as it is. Name another file or folder, or remove this one first", output,
       why_kept(output));
}

void check_no_cloud_target(const std::string& path, bool force, const char* what) {
  if (path == "-")
    fail(ErrorCode::usage, "standard output (-) does not take the {}; it needs the name of a file", what);
  pipeline::io::check_target(path, force);
  if (holds_cloud(path))
    fail(ErrorCode::cannot_write, "{}: {}, which no {} replaces; remove it yourself", path,
         is_unreadable(path) ? "cannot be read and may be a cloud" : "is a cloud", what);
}

}  // namespace rfsmooth::cli
