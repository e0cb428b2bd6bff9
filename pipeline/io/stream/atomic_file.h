/// A file that appears complete or not at all: written beside its target under another name, then renamed.
#pragma once

#include <filesystem>
#include <optional>

#include <rfsmooth/context.h>
#include <rfsmooth/result.h>

#include "pipeline/io/stream/sink.h"

namespace rfsmooth::pipeline::io {

/// Usage: construct, write, commit. Without commit, the destructor removes the temporary file. A symbolic
/// link is followed: the file it names is replaced, the link stays. A device or a pipe is written to
/// directly. An existing file's permissions are kept.
class AtomicFile : public Sink {
 public:
  /// \throw Failure (cannot_write) if the folder is missing or not writable, the target is a folder, or it
  /// exists and `replace` is false.
  AtomicFile(const std::filesystem::path& target, bool replace, const Context& context);
  ~AtomicFile() override;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// \throw Failure (cannot_write), for example on a full disk, or (cancelled).
  void write(std::string_view bytes) override;

  /// Syncs if `sync` is set, then renames the file to the target. \throw Failure (cannot_write).
  void commit(bool sync);

 private:
  void reserve(std::size_t size);
  void take_name();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path shown_, target_, temporary_;
  bool replace_;
  const Context& context_;
  int file_ = -1;
};

/// The file that a target is, behind its symbolic links, whether it is there or not. None: the bytes would go
/// into a pipe, a device, or an open file (/dev/stdout). \throw Failure (cannot_write) for links in a circle.
std::optional<std::filesystem::path> file_behind(const std::filesystem::path& target);

/// Makes a folder, if there is none; its parent must be there. \throw Failure (cannot_write).
void make_folder(const std::filesystem::path& folder);

/// Refuses in advance what the constructor would refuse; creates nothing. \throw Failure (cannot_write).
void check_target(const std::filesystem::path& target, bool replace);

}  // namespace rfsmooth::pipeline::io
