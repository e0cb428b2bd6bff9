#include "smoothing/automatic/patches/near_rows.h"

#include <algorithm>
#include <stdexcept>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

NearRows::NearRows(const rfs_mesh::NeighborTable& table, const Context& context)
    : size_(table.size()), width_(std::size_t(table.k)), step_(size_ * width_) {
  if (width_ > kMost) throw std::invalid_argument("NearRows: a row is too long");
  far_start_.assign((size_ + kBlock - 1) / kBlock + 1, 0);
  for_blocks(context, size_, kBlock, [&](std::size_t begin, std::size_t end) {
    std::size_t far = 0;
    for (std::size_t i = begin; i < end; ++i)
      for (const Index j : table[i]) far += std::size_t(!is_near(i, j));
    far_start_[begin / kBlock + 1] = far;
  });
  for (std::size_t b = 1; b < far_start_.size(); ++b) far_start_[b] += far_start_[b - 1];
  far_.resize(far_start_.back());
  for_blocks(context, size_, kBlock, [&](std::size_t begin, std::size_t end) {
    const std::size_t first = far_start_[begin / kBlock];
    std::size_t next = first;
    for (std::size_t i = begin; i < end; ++i) {
      std::int16_t* step = step_.data() + i * width_;
      for (const Index j : table[i])
        if (is_near(i, j)) {
          *step++ = std::int16_t(std::int64_t(j) - std::int64_t(i));
        } else {
          *step++ = std::int16_t(kLeastCode + int(next - first));
          far_[next++] = j;
        }
    }
  });
}

rfs_mesh::NeighborTable NearRows::first(std::size_t k, const Context& context) const {
  const std::size_t width = std::min(k, width_);
  rfs_mesh::NeighborTable table;
  table.k = int(width);
  table.items.resize(size_ * width);
  for_each_index(context, size_, [&](std::size_t i) {
    const Row row = (*this)[i];
    std::copy_n(row.begin(), width, table.items.data() + i * width);
  });
  return table;
}

}  // namespace rfsmooth::smoothing
