/// A growable buffer that does not initialise new bytes, so that files are read straight into it.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "base/unfilled.h"

namespace rfsmooth::pipeline::io {

/// Bytes; resize() leaves new ones indeterminate.
using Bytes = std::vector<char, Unfilled<char>>;

/// Takes `size` bytes, from `first` on, out of a buffer that is wanted from `next` on only. Where they are
/// most of it they stay in its memory, so that there are never two copies of a large file; the buffer then
/// begins with what was at `next`, which becomes 0.
inline Bytes take_bytes(Bytes& buffer, std::size_t first, std::size_t size, std::size_t& next) {
  char* const from = buffer.data() + first;
  if (size <= buffer.size() / 2) return {from, from + size};
  Bytes rest(buffer.data() + next, buffer.data() + buffer.size());
  if (first > 0) std::move(from, from + size, buffer.data());
  buffer.resize(size);
  std::swap(buffer, rest);
  next = 0;
  return rest;
}

}  // namespace rfsmooth::pipeline::io
