/// The lines of a file's header, read piece by piece so that a header may be of any length and the data
/// behind it is not read twice. One thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pipeline/io/stream/source.h"

namespace rfsmooth::pipeline::io {

/// Reads a file's header line by line, counting.
class HeaderLines {
 public:
  HeaderLines(const Source& source, const Context& context) : source_(source), context_(context) {}

  /// The next line without its line end (LF or CR LF), good until the next one is asked for. \throw Failure
  /// at the end of the file: "line N: expected `expected`, found the end of the file".
  std::string_view next(std::string_view expected);

  std::size_t line() const { return line_; }        ///< number of the line last returned, from 1
  std::uint64_t offset() const { return offset_; }  ///< first byte behind it
  bool crlf() const { return crlf_; }               ///< whether the first line ended in CR LF
  /// All lines so far, verbatim; good until the next one is asked for.
  std::string_view text() const { return {held_.data(), std::size_t(offset_)}; }
  bool at_end() const { return offset_ == source_.size(); }

  /// \throw Failure, "NAME: line N: message", put together as in base/fail.h.
  template <std::size_t kSize, class... Arguments>
  [[noreturn]] void fail(const char (&message)[kSize], const Arguments&... arguments) const {
    source_.fail("line {}: {}", line_, fmt::format(fmt::runtime(message), arguments...));
  }

 private:
  const Source& source_;
  const Context& context_;
  Bytes held_;
  std::uint64_t offset_ = 0;
  std::size_t line_ = 0;
  bool crlf_ = false;
};

/// A word for an error message: shortened, unprintable bytes as '?', in quotes.
std::string in_quotes(std::string_view word);

}  // namespace rfsmooth::pipeline::io
