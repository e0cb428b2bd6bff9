/// Gathers what many threads produce into one vector, in index order: fixed blocks fill lists of their own,
/// which are then joined in order. The result does not depend on the number of threads. Used where a stage
/// makes a variable number of things per vertex.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

/// Runs `produce(i, emit)` once for every i in [0, n) and returns everything passed to `emit(T)`, ordered by
/// i. O(n + output); holds the output twice while it joins the blocks.
template <class T, class Produce>
std::vector<T> collect(const Context& context, std::size_t n, Produce&& produce, std::size_t grain = 2048) {
  std::vector<std::vector<T>> blocks((n + grain - 1) / grain);
  for_blocks(context, n, grain, [&](std::size_t begin, std::size_t end) {
    std::vector<T>& block = blocks[begin / grain];
    for (std::size_t i = begin; i < end; ++i) produce(i, [&](const T& item) { block.push_back(item); });
  });
  std::vector<std::size_t> start(blocks.size() + 1, 0);
  for (std::size_t b = 0; b < blocks.size(); ++b) start[b + 1] = start[b] + blocks[b].size();
  std::vector<T> all(start.back());
  for_each_index(
      context, blocks.size(),
      [&](std::size_t b) {
        std::copy(blocks[b].begin(), blocks[b].end(), all.begin() + std::ptrdiff_t(start[b]));
        std::vector<T>().swap(blocks[b]);
      },
      16);
  return all;
}

}  // namespace rfsmooth::rfs_mesh
