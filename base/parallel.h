/// Parallel loops and reductions whose results do not depend on the number of threads.
///
/// The rules that make this so: write by index; gather over neighbours, never scatter; reduce in blocks of
/// fixed size, combined in index order; sort by a total order. TBB stays in parallel.cpp. Thread safe:
/// several threads may run loops at once, and loops may be nested.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

#include <rfsmooth/context.h>

namespace rfsmooth {

/// Runs `body`; its parallel loops use at most `context.threads` threads. Call it once, at a front door.
/// Rethrows what `body` throws.
void in_arena(const Context& context, const std::function<void()>& body);

/// Calls `body(begin, end)` for blocks of `grain` that cover [0, n), in parallel. The blocks are the same for
/// any number of threads. \throw Failure if `context.stop` is set; rethrows what `body` throws.
void for_blocks(const Context& context, std::size_t n, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls `body(i)` for every i in [0, n), in parallel.
template <class Body>
void for_each_index(const Context& context, std::size_t n, Body&& body, std::size_t grain = 1024) {
  for_blocks(context, n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Combines `map(begin, end)` of fixed blocks in index order: the same bits for any number of threads.
template <class T, class Map, class Combine>
T reduce_blocks(const Context& context, std::size_t n, T identity, Map&& map, Combine&& combine,
                std::size_t grain = 4096) {
  std::vector<T> partial((n + grain - 1) / grain, identity);
  for_blocks(context, n, grain,
             [&](std::size_t begin, std::size_t end) { partial[begin / grain] = map(begin, end); });
  T total = std::move(identity);
  for (T& p : partial) total = combine(std::move(total), std::move(p));
  return total;
}

/// The sum of `term(i)` over [0, n), starting from `zero` in every block. T needs +=.
template <class T, class Term>
T sum_over(const Context& context, std::size_t n, T zero, Term&& term, std::size_t grain = 4096) {
  return reduce_blocks(
      context, n, zero,
      [&](std::size_t begin, std::size_t end) {
        T s = zero;
        for (std::size_t i = begin; i < end; ++i) s += term(i);
        return s;
      },
      [](T a, const T& b) { return T(a += b); }, grain);
}

/// Replaces `kept` by `value` if that comes before it: the first of all values remains, in whatever order the
/// threads call. `before(a, b)` must be a total order.
template <class T, class Before>
void keep_first(std::atomic<T>& kept, T value, Before&& before) {
  T seen = kept.load(std::memory_order_relaxed);
  while (before(value, seen) && !kept.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

/// Sorts in parallel: blocks first, then merges. `less` must be a total order: two elements are equivalent
/// only if they are equal. T has a default constructor and is copied; more than 32,768 elements take a second
/// array of as many while they are sorted.
template <class T, class Less>
void parallel_sort(const Context& context, std::vector<T>& v, Less less) {
  constexpr std::size_t kBlock = std::size_t{1} << 15;
  for_blocks(context, v.size(), kBlock, [&](std::size_t b, std::size_t e) {
    std::sort(v.begin() + std::ptrdiff_t(b), v.begin() + std::ptrdiff_t(e), less);
  });
  std::vector<T> other(v.size() > kBlock ? v.size() : 0);
  for (std::size_t width = kBlock; width < v.size(); width *= 2) {
    for_blocks(context, v.size(), 2 * width, [&](std::size_t b, std::size_t e) {
      const auto first = v.begin() + std::ptrdiff_t(b), last = v.begin() + std::ptrdiff_t(e);
      const auto middle = v.begin() + std::ptrdiff_t(std::min(b + width, e));
      std::merge(first, middle, middle, last, other.begin() + std::ptrdiff_t(b), less);
    });
    v.swap(other);
  }
}

}  // namespace rfsmooth
