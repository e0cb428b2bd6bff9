#include "pipeline/io/formats/header_lines.h"

#include <algorithm>
#include <cstring>

namespace rfsmooth::pipeline::io {

std::string_view HeaderLines::next(std::string_view expected) {
  std::size_t searched = std::size_t(offset_);
  for (;;) {
    const char* found =
        searched < held_.size()
            ? static_cast<const char*>(std::memchr(held_.data() + searched, '\n', held_.size() - searched))
            : nullptr;
    if (found == nullptr && held_.size() < source_.size()) {
      searched = held_.size();
      const std::size_t more = std::max<std::size_t>(4096, held_.size());
      const std::size_t n = std::size_t(std::min<std::uint64_t>(more, source_.size() - held_.size()));
      held_.resize(searched + n);
      source_.read(searched, held_.data() + searched, n, context_);
      continue;
    }
    ++line_;
    if (found == nullptr && offset_ == source_.size())
      fail("expected {}, found the end of the file", expected);
    // The last line of a file may lack its line end.
    const std::size_t end = found == nullptr ? held_.size() : std::size_t(found - held_.data());
    std::string_view line(held_.data() + offset_, end - std::size_t(offset_));
    offset_ = found == nullptr ? end : end + 1;
    if (found != nullptr && !line.empty() && line.back() == '\r') {
      line.remove_suffix(1);
      if (line_ == 1) crlf_ = true;
    }
    return line;
  }
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kMost = 40;
  std::string out = "'";
  for (const char c : word.substr(0, kMost)) out += c >= ' ' && c <= '~' ? c : '?';
  if (word.size() > kMost) out += "...";
  return out + "'";
}

}  // namespace rfsmooth::pipeline::io
