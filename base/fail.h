/// Messages: giving up with one, and numbers in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <rfsmooth/result.h>

namespace rfsmooth {

/// `message` is a literal in which {} stand for the arguments, as in fmt::format; no text of users or files
/// is ever taken for one. \throw Failure. Thread safe.
template <std::size_t kSize, class... Arguments>
[[noreturn]] void fail(ErrorCode code, const char (&message)[kSize], const Arguments&... arguments) {
  throw Failure({code, fmt::format(fmt::runtime(message), arguments...)});
}

/// "1 point", "2 points": a number of what it counts. \param many of words whose plural is not with an s
inline std::string counted(std::uint64_t n, std::string_view one, std::string_view many = {}) {
  if (n == 1) return fmt::format("1 {}", one);
  return many.empty() ? fmt::format("{} {}s", n, one) : fmt::format("{} {}", n, many);
}

}  // namespace rfsmooth
