/// Where a reader gets its bytes: an open file or a buffer. The size is known before anything is allocated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <rfsmooth/context.h>
#include <rfsmooth/result.h>

#include "base/fail.h"
#include "pipeline/io/table/bytes.h"

namespace rfsmooth::pipeline::io {

/// A file's bytes.
class Source {
 public:
  /// Opens a file; one without a size (a pipe, a terminal) is read into memory. \throw Failure
  /// (input_unreadable) if it is missing, a directory or not readable.
  Source(const std::filesystem::path& path, const Context& context);

  /// Reads from `bytes`, which must outlive the source.
  Source(std::string_view bytes, std::string name);

  ~Source();
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }

  /// Reads `n` bytes at `offset`. \throw Failure if the file does not have them or cannot be read; nothing is
  /// allocated for bytes beyond its size.
  void read(std::uint64_t offset, char* out, std::size_t n, const Context& context) const;
  Bytes read(std::uint64_t offset, std::size_t n, const Context& context) const;

  /// \throw Failure (input_unreadable), "NAME: message", put together as in base/fail.h.
  template <std::size_t kSize, class... Arguments>
  [[noreturn]] void fail(const char (&message)[kSize], const Arguments&... arguments) const {
    rfsmooth::fail(ErrorCode::input_unreadable, "{}: {}", name_,
                   fmt::format(fmt::runtime(message), arguments...));
  }

 private:
  void check_range(std::uint64_t offset, std::size_t n) const;

  std::string name_;
  std::uint64_t size_ = 0;
  int file_ = -1;
  Bytes held_;
  std::string_view bytes_;
};

}  // namespace rfsmooth::pipeline::io
