/// A file that appears complete or not at all: written beside its target under another name, synced, renamed.
#pragma once

#include <filesystem>
#include <string>

#include <rfsmooth/context.h>
#include <rfsmooth/result.h>

#include "pipeline/io/stream/sink.h"

namespace rfsmooth::pipeline::io {

/// Usage: construct, write, commit. Destroyed without commit, it leaves no trace. A symbolic link is
/// followed: the file it names is written, the link stays. A target that is a device or a pipe is written to
/// directly. An existing file's permissions are kept.
class AtomicFile : public Sink {
 public:
  /// \throw Failure (cannot_write): the folder is missing or not writable, the target is a folder, or exists
  /// and `replace` is false.
  AtomicFile(const std::filesystem::path& target, bool replace, const Context& context);
  ~AtomicFile() override;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// \throw Failure (cannot_write), for a full disk say, or (cancelled).
  void write(std::string_view bytes) override;

  /// Syncs (unless told not to) and takes the target's name. \throw Failure (cannot_write).
  void commit(bool sync);

 private:
  void reserve(std::size_t size);
  [[noreturn]] void fail(const std::string& what, int error) const;

  std::filesystem::path shown_, target_, temporary_;
  bool replace_;
  const Context& context_;
  int file_ = -1;
};

/// What the constructor would refuse, found out before the work is done; creates nothing.
void check_target(const std::filesystem::path& target, bool replace);

}  // namespace rfsmooth::pipeline::io
