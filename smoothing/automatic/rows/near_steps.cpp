#include "smoothing/automatic/rows/near_steps.h"

#include <algorithm>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

template <class Items, class RowOf, class EndOf>
void NearSteps::pack(const Items& items, const RowOf& row_of, const EndOf& end_of, const Context& context) {
  step_.resize(items.size());
  far_start_.assign((items.size() + kBlock - 1) / kBlock + 1, 0);
  // Calls do_item(i, k) for the items of a block, in order.
  const auto walk = [&](std::size_t begin, std::size_t end, const auto& do_item) {
    std::size_t i = row_of(begin);
    for (std::size_t k = begin; k < end; ++k) {
      while (end_of(i) <= k) ++i;
      do_item(i, k);
    }
  };
  for_blocks(context, items.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::size_t far = 0;
    walk(begin, end, [&](std::size_t i, std::size_t k) { far += std::size_t(!is_near(i, items[k])); });
    far_start_[begin / kBlock + 1] = far;
  });
  for (std::size_t b = 1; b < far_start_.size(); ++b) far_start_[b] += far_start_[b - 1];
  far_.resize(far_start_.back());
  for_blocks(context, items.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    const std::size_t first = far_start_[begin / kBlock];
    std::size_t next = first;
    walk(begin, end, [&](std::size_t i, std::size_t k) {
      if (is_near(i, items[k])) {
        step_[k] = std::int16_t(std::int64_t(items[k]) - std::int64_t(i));
      } else {
        step_[k] = std::int16_t(kLeastCode + int(next - first));
        far_[next++] = items[k];
      }
    });
  });
}

NearSteps::NearSteps(const rfs_mesh::NeighborTable& rows, const Context& context) {
  const auto width = std::size_t(rows.k);
  pack(
      rows.items, [&](std::size_t k) { return k / width; }, [&](std::size_t i) { return (i + 1) * width; },
      context);
}

NearSteps::NearSteps(const Adjacency& rows, const Context& context) {
  const std::vector<Index>& start = rows.start;
  const auto row_of = [&](std::size_t k) {
    return std::size_t(std::upper_bound(start.begin(), start.end(), k) - start.begin()) - 1;
  };
  pack(
      rows.items, row_of, [&](std::size_t i) { return std::size_t(start[i + 1]); }, context);
}

}  // namespace rfsmooth::smoothing
