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
#pragma once

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/mesh.h"
#include "rfsmooth/rfs_mesh/options.h"

namespace rfsmooth::rfs_mesh {

/// When a swap is worth it.
struct SwapOptions {
  /// Gain below which a swap is not worth it (and rounding could undo it next time).
  double least_gain = 1e-3;
  /// New faces have at least this Bank & Smith quality, or the old pair's lower one if that is less.
  double quality = 0.25;
  int rounds = 1;  ///< sets of independent swaps in one pass; what one leaves, the next pass finds

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"swap-least-gain", "smallest gain in the sum of dihedral angles", "radians", 0, 100},
          self.least_gain);
    visit(OptionInfo{"swap-quality", "smallest Bank & Smith quality a swap may leave", "", 0, 1},
          self.quality);
    visit(OptionInfo{"swap-rounds", "sets of independent swaps in one pass", "", 1, 1000}, self.rounds);
  }
};

/// One pass; returns the swaps made. Faces keep their number and their order in `mesh.faces`; a swapped pair
/// keeps the winding of its first face. Keeps `check(mesh)` empty, edges without a face stay as they are.
/// Only edges with exactly two faces, and at most two faces at each edge around them, are swapped. The order
/// of a face's corners does not matter otherwise: the mesh need not be oriented. O(n + m) a round, parallel,
/// the same bytes for any number of threads. If it throws (cancel, memory) the mesh is as it was.
std::size_t swap_edges(Mesh& mesh, const SwapOptions& options, const Context& context);

}  // namespace rfsmooth::rfs_mesh
