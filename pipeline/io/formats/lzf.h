/// LZF, the byte-oriented compression of PCD's binary_compressed: runs of literals (up to 32 bytes) and
/// references of 3 to 264 bytes to the last 8 KiB. Marc Lehmann's LibLZF format, written anew.
#pragma once

#include <cstddef>
#include <string_view>

#include "pipeline/io/table/bytes.h"

namespace rfsmooth::pipeline::io {

/// No stream of n bytes unpacks to more than n * kLzfMostGain.
inline constexpr std::size_t kLzfMostGain = 88;

/// Compresses; the result may be longer than the input by one byte in 32. Deterministic. O(n).
Bytes lzf_compress(std::string_view in);

/// What unpacking said: `ok`, or where the stream is wrong.
struct LzfOutcome {
  bool ok = true;
  std::size_t at = 0;     ///< byte of the stream
  const char* what = "";  ///< what is wrong there
};

/// Unpacks into exactly `size` bytes at `out`; a stream that holds more, fewer, or refers to what is not
/// there fails.
LzfOutcome lzf_decompress(std::string_view in, char* out, std::size_t size);

}  // namespace rfsmooth::pipeline::io
