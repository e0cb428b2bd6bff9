#include "smoothing/automatic/rows/near_rows.h"

#include <algorithm>
#include <stdexcept>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

NearRows::NearRows(const rfs_mesh::NeighborTable& table, const Context& context)
    : size_(table.size()), width_(std::size_t(table.k)) {
  if (width_ > kMost) throw std::invalid_argument("NearRows: a row is too long");
  items_ = NearSteps(table, context);
}

rfs_mesh::NeighborTable NearRows::first(std::size_t k, const Context& context) const {
  const std::size_t width = std::min(k, width_);
  rfs_mesh::NeighborTable table;
  table.k = int(width);
  table.items.resize(size_ * width);
  for_each_index(context, size_, [&](std::size_t i) {
    const Row row = first_of(i, width);
    std::copy_n(row.begin(), width, table.items.data() + i * width);
  });
  return table;
}

}  // namespace rfsmooth::smoothing
