/// Dihedral edge swaps: two faces that share an edge exchange it for the other diagonal where that makes the
/// mesh flatter.
///
/// Vollmer et al. section 7: "Edge swapping between two adjacent faces is used to increase the sum of
/// dihedral angles at all five edges of the two faces", alternated with one smoothing step; positions never
/// move, so the mesh cannot shrink by it. (pi minus the dihedral angle is the angle between normals: the same
/// sum is the L1 "ABN" cost of data-dependent triangulations.)
///
/// Differs from the paper: which of many possible swaps come first. Here a pass takes, in parallel, swaps
/// whose six faces (the pair and its four neighbours) belong to no better one, by (gain, edge), so every gain
/// counts in full and the sum over the mesh never falls.
/// Several meshes may be swapped at once; one mesh by one caller at a time.
#pragma once

#include <rfsmooth/connect.h>

namespace rfsmooth::rfs_mesh {

/// One pass; returns the swaps made. Faces keep their number and their order in `mesh.faces`; a swapped pair
/// keeps the winding of its first face. Keeps `check(mesh)` empty, edges without a face stay as they are.
/// Only edges with exactly two faces, and at most two faces at each edge around them, are swapped. The order
/// of a face's corners does not matter otherwise: the mesh need not be oriented. O(n + m) a round, parallel,
/// the same bytes for any number of threads. If it throws (cancel, memory) the mesh is as it was.
std::size_t swap_edges(Mesh& mesh, const SwapOptions& options, const Context& context);

}  // namespace rfsmooth::rfs_mesh
