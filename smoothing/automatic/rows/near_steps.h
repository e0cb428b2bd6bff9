/// Rows of neighbours in half the memory: as steps from the index of the point that a row is of.
///
/// Along a Morton curve most neighbours in space are near in the array, so that 16 bits hold how far. The few
/// that are farther away have their index in a list beside; a step says where in the list.
/// Const functions are thread safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "base/raw_array.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::smoothing {

/// The items of all rows, one row behind the other. Where a row begins, its owner knows.
class NearSteps {
 public:
  NearSteps() = default;
  /// O(items), parallel.
  NearSteps(const rfs_mesh::NeighborTable& rows, const Context& context);
  NearSteps(const Adjacency& rows, const Context& context);

  std::size_t size() const { return step_.size(); }
  /// The k-th of all items; it is in row i.
  Index operator()(std::size_t i, std::size_t k) const {
    const int step = step_[k];
    return step >= kLeastStep ? Index(std::int64_t(i) + step) : far_[far_start_[k / kBlock] + place(step)];
  }

 private:
  // So many items have a list of far ones together; below kLeastStep there is a code for each of these.
  static constexpr std::size_t kBlock = 8192;
  static constexpr int kLeastCode = -32768, kLeastStep = kLeastCode + int(kBlock);

  static std::size_t place(int code) { return std::size_t(code - kLeastCode); }
  static bool is_near(std::size_t i, Index j) {
    const std::int64_t step = std::int64_t(j) - std::int64_t(i);
    return step >= kLeastStep && step <= 32767;
  }
  /// \param row_of of an item. \param end_of of a row: the item behind its last one.
  template <class Items, class RowOf, class EndOf>
  void pack(const Items& items, const RowOf& row_of, const EndOf& end_of, const Context& context);

  RawArray<std::int16_t> step_;         ///< below kLeastStep a place in the block's part of far_
  std::vector<Index> far_;              ///< block after block
  std::vector<std::size_t> far_start_;  ///< blocks + 1
};

}  // namespace rfsmooth::smoothing
