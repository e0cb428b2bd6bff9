/// Reorders vertices so that neighbours are near in memory, for meshes read from files in another order.
/// Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// Whether most edges of a large mesh join vertices far apart in memory, so that reordering pays. O(edges).
bool is_scattered(const Mesh& mesh, const Context& context);

/// The same mesh with its vertices along a Morton curve.
struct Reordered {
  Mesh mesh;
  std::vector<Index> place;  ///< n: where each vertex went
};

/// Reorders the mesh; positions must be finite. O(n log n), parallel, deterministic.
Reordered reorder(const Mesh& mesh, const Context& context);

/// The constraints for the reordered mesh.
Constraints reorder(const Constraints& constraints, const std::vector<Index>& place);

}  // namespace rfsmooth::smoothing
