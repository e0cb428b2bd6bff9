/// Dihedral edge swaps: two faces that share an edge exchange it for the other diagonal where that makes the
/// mesh flatter.
///
/// Vollmer et al. section 7: "Edge swapping between two adjacent faces is used to increase the sum of
/// dihedral angles at all five edges of the two faces", alternated with one smoothing step. Swaps never move
/// a vertex, so they cannot shrink the mesh. (The angle between normals is pi minus the dihedral angle: the
/// same sum is the L1 "ABN" cost of data-dependent triangulations.)
///
/// Differs from the paper: it does not say which swaps come first: a pass ranks swaps by (gain, edge) and
/// makes, in parallel, each one whose six faces (the pair and its four neighbours) belong to no better one.
/// So every gain counts in full, and the sum over the mesh never falls. Thread safe for different meshes.
#pragma once

#include <rfsmooth/connect.h>

namespace rfsmooth::rfs_mesh {

/// Makes one pass; returns the number of swaps. Swaps an edge only if it has exactly two faces and the four
/// edges around it at most two each. The mesh need not be oriented. Faces keep their number and their order
/// in `mesh.faces`; a swapped pair takes the winding of its first face. `check(mesh)` stays empty, and edges
/// without a face stay. If it throws (cancel, memory) the mesh is unchanged. O(n + m) per round, parallel,
/// the same bytes for any number of threads.
std::size_t swap_edges(Mesh& mesh, const SwapOptions& options, const Context& context);

}  // namespace rfsmooth::rfs_mesh
