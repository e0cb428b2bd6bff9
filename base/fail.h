/// Gives up what is being done, with a message.
#pragma once

#include <cstddef>

#include <fmt/format.h>

#include <rfsmooth/result.h>

namespace rfsmooth {

/// `message` is a literal in which {} stand for the arguments, as in fmt::format; no text of users or files
/// is ever taken for one. \throw Failure. Thread safe.
template <std::size_t kSize, class... Arguments>
[[noreturn]] void fail(ErrorCode code, const char (&message)[kSize], const Arguments&... arguments) {
  throw Failure({code, fmt::format(fmt::runtime(message), arguments...)});
}

}  // namespace rfsmooth
