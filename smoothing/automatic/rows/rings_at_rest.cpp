#include "smoothing/automatic/rows/rings_at_rest.h"

#include <utility>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

RingsAtRest::RingsAtRest(Adjacency rings, const Context& context)
    : items_(rings, context), start_(std::move(rings.start)) {}

Adjacency RingsAtRest::wake(const Context& context) {
  Adjacency rings;
  rings.start = std::move(start_);
  rings.items.resize(items_.size());
  for_each_index(context, rings.size(), [&](std::size_t i) {
    for (std::size_t k = rings.start[i]; k < rings.start[i + 1]; ++k) rings.items[k] = items_(i, k);
  });
  return rings;
}

}  // namespace rfsmooth::smoothing
