/// From the umbrellas' faces to the faces of the RFS-mesh: each face once, and at most two at an edge.
///
/// Vollmer et al. section 7: "If there are more than two faces at an edge we keep that pair that form the
/// maximum dihedral angle." Every edge decides on the same snapshot and only marks faces; a face is dropped
/// if any of its edges marked it. So the result does not depend on the order of the edges. A face may return
/// in a later round if its edges have room, because the faces it lost to were dropped themselves. Thread
/// safe: no state is kept.
#pragma once

#include <cstdint>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/connect/umbrella.h"

namespace rfsmooth::rfs_mesh {

/// The faces of all umbrellas, each once.
struct ProposedFaces {
  std::vector<Face> faces;          ///< wound counter-clockwise for the lowest of the corners that span it
  std::vector<std::uint8_t> votes;  ///< how many of its corners' umbrellas span it, 1 to 3
};

/// O(n), parallel, deterministic.
ProposedFaces proposed_faces(const std::vector<Umbrella>& umbrellas, const Context& context);

/// The faces that are kept.
struct FlattestPairs {
  std::vector<Face> faces;  ///< in the order in which they were proposed
  Adjacency one_ring;       ///< the vertices' neighbours by these faces
};

/// Keeps at most two faces at every edge. Dihedral angles in the same step of `same_fold` degrees (> 0) count
/// as equal. O(faces), parallel, deterministic.
FlattestPairs keep_flattest_pairs(const Positions& at, const ProposedFaces& proposed, double same_fold,
                                  const Context& context);

}  // namespace rfsmooth::rfs_mesh
