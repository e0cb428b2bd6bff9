/// The nearest of every point in half the memory of a table: as steps from the point's own index.
///
/// Along a Morton curve most neighbours in space are near in the array, so that 16 bits hold how far. The few
/// that are farther away have their index in a list beside; a step says where in the list.
/// Const functions are thread safe.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/raw_array.h"
#include "rfs_mesh/search/neighbors.h"

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
  Row operator[](std::size_t i) const {
    Row row;
    row.count = width_;
    const std::int16_t* const step = step_.data() + i * width_;
    for (std::size_t k = 0; k < width_; ++k)
      row.items[k] = step[k] >= kLeastStep ? Index(std::int64_t(i) + step[k]) : far(i, step[k]);
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
  // So many rows have a list of far ones together; below kLeastStep there is a code for each of these.
  static constexpr std::size_t kBlock = 256;
  static constexpr int kLeastCode = -32768, kLeastStep = kLeastCode + int(kBlock * kMost);

  static bool is_near(std::size_t i, Index j) {
    const std::int64_t step = std::int64_t(j) - std::int64_t(i);
    return step >= kLeastStep && step <= 32767;
  }
  Index far(std::size_t i, int code) const {
    return far_[far_start_[i / kBlock] + std::size_t(code - kLeastCode)];
  }

  std::size_t size_ = 0, width_ = 0;
  RawArray<std::int16_t> step_;         ///< n x width; below kLeastStep a place in the block's part of far_
  std::vector<Index> far_;              ///< block after block
  std::vector<std::size_t> far_start_;  ///< blocks + 1
};

}  // namespace rfsmooth::smoothing
