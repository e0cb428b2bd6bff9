/// The nearest of every point in half the memory of a table (near_steps.h).
/// Const functions are thread safe.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/rows/near_steps.h"

namespace rfsmooth::smoothing {

/// n rows of the same length, up to kMost.
class NearRows {
 public:
  static constexpr std::size_t kMost = 32;

  /// One row, unpacked.
  struct Row {
    std::array<Index, kMost> items;
    std::size_t count;
    const Index* begin() const { return items.data(); }
    const Index* end() const { return items.data() + count; }
    std::size_t size() const { return count; }
    Index operator[](std::size_t k) const { return items[k]; }
  };

  NearRows() = default;
  /// \throw std::invalid_argument for rows of more than kMost. O(n), parallel.
  NearRows(const rfs_mesh::NeighborTable& table, const Context& context);

  std::size_t size() const { return size_; }
  std::size_t width() const { return width_; }
  Row operator[](std::size_t i) const { return first_of(i, width_); }

  /// The first k of row i, all if there are fewer.
  Row first_of(std::size_t i, std::size_t k) const {
    Row row;
    row.count = std::min(k, width_);
    for (std::size_t j = 0; j < row.count; ++j) row.items[j] = items_(i, i * width_ + j);
    return row;
  }

  /// Writes row i to `row`.
  void copy(std::size_t i, Index* row) const {
    const Row from = (*this)[i];
    std::copy(from.begin(), from.end(), row);
  }

  /// The first k of every row (all if there are fewer), as a table. O(n), parallel.
  rfs_mesh::NeighborTable first(std::size_t k, const Context& context) const;

 private:
  std::size_t size_ = 0, width_ = 0;
  NearSteps items_;  ///< n x width
};

}  // namespace rfsmooth::smoothing
