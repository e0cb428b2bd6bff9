/// Rings that nobody reads for a while, in half the memory (near_steps.h).
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "smoothing/automatic/rows/near_steps.h"

namespace rfsmooth::smoothing {

/// The rows of an adjacency, to be given back.
class RingsAtRest {
 public:
  /// O(items), parallel.
  RingsAtRest(Adjacency rings, const Context& context);

  /// The same rows. Once; O(items), parallel.
  Adjacency wake(const Context& context);

 private:
  NearSteps items_;
  std::vector<Index> start_;  ///< of the adjacency
};

}  // namespace rfsmooth::smoothing
