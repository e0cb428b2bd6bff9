/// Rings that nobody reads for a while, in half the memory. Along a Morton curve most neighbours in space are
/// near in the array: 16 bits hold the step from the point's own index, and few are farther away.
#pragma once

#include <cstdint>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "base/raw_array.h"

namespace rfsmooth::smoothing {

/// The rows of an adjacency, to be given back.
class RingsAtRest {
 public:
  /// O(items), parallel.
  RingsAtRest(Adjacency rings, const Context& context);

  /// The same rows. Once; O(items), parallel.
  Adjacency wake(const Context& context);

 private:
  std::vector<Index> start_;            ///< of the adjacency
  RawArray<std::int16_t> step_;         ///< of its items; kFar: the next in far_
  std::vector<Index> far_;              ///< block after block of rows
  std::vector<std::size_t> far_start_;  ///< blocks + 1
};

}  // namespace rfsmooth::smoothing
