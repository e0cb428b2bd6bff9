/// Gathers a variable number of items per index into one vector, in index order, in parallel. Fixed blocks
/// are counted first, then written to their places, so the result does not depend on the number of threads.
/// Thread safe if `produce` is.
#pragma once

#include <cstddef>
#include <vector>

#include "base/parallel.h"

namespace rfsmooth {

/// Returns everything that `produce(i, emit)` passes to `emit(T)`, ordered by i in [0, n). `produce` runs
/// twice for every i: to count and to fill. (One list per block instead would leave memory in the heaps of
/// the threads.) O(n + output).
template <class T, class Produce>
std::vector<T> collect(const Context& context, std::size_t n, Produce&& produce, std::size_t grain = 2048) {
  std::vector<std::size_t> start((n + grain - 1) / grain + 1, 0);
  for_blocks(context, n, grain, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) produce(i, [&](const T&) { ++count; });
    start[begin / grain + 1] = count;
  });
  for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
  std::vector<T> all(start.back());
  for_blocks(context, n, grain, [&](std::size_t begin, std::size_t end) {
    T* out = all.data() + start[begin / grain];
    for (std::size_t i = begin; i < end; ++i) produce(i, [&](const T& item) { *out++ = item; });
  });
  return all;
}

}  // namespace rfsmooth
