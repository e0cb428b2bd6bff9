#include "smoothing/automatic/tails/rings_at_rest.h"

#include <utility>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kBlockOfRings = 4096;
constexpr std::int16_t kFar = -32768;

bool is_far(std::size_t i, Index j) {
  const std::int64_t step = std::int64_t(j) - std::int64_t(i);
  return step <= kFar || step > 32767;
}

}  // namespace

RingsAtRest::RingsAtRest(Adjacency rings, const Context& context) : step_(rings.items.size()) {
  const std::size_t n = rings.size();
  far_start_.assign((n + kBlockOfRings - 1) / kBlockOfRings + 1, 0);
  for_blocks(context, n, kBlockOfRings, [&](std::size_t begin, std::size_t end) {
    std::size_t far = 0;
    for (std::size_t i = begin; i < end; ++i)
      for (const Index j : rings[i]) far += std::size_t(is_far(i, j));
    far_start_[begin / kBlockOfRings + 1] = far;
  });
  for (std::size_t b = 1; b < far_start_.size(); ++b) far_start_[b] += far_start_[b - 1];
  far_.resize(far_start_.back());
  for_blocks(context, n, kBlockOfRings, [&](std::size_t begin, std::size_t end) {
    std::size_t next = far_start_[begin / kBlockOfRings];
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = rings.start[i]; k < rings.start[i + 1]; ++k) {
        const Index j = rings.items[k];
        const bool far = is_far(i, j);
        step_[k] = far ? kFar : std::int16_t(std::int64_t(j) - std::int64_t(i));
        if (far) far_[next++] = j;
      }
  });
  start_ = std::move(rings.start);
}

Adjacency RingsAtRest::wake(const Context& context) {
  Adjacency rings;
  rings.start = std::move(start_);
  rings.items.resize(step_.size());
  for_blocks(context, rings.size(), kBlockOfRings, [&](std::size_t begin, std::size_t end) {
    std::size_t next = far_start_[begin / kBlockOfRings];
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = rings.start[i]; k < rings.start[i + 1]; ++k)
        rings.items[k] = step_[k] == kFar ? far_[next++] : Index(std::int64_t(i) + step_[k]);
  });
  return rings;
}

}  // namespace rfsmooth::smoothing
