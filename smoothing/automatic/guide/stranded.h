/// Points that a fairing left beside the surface, put onto it.
///
/// Where noise exceeds the spacing, some points have no face, or only faces among a few others that lie off
/// the surface like themselves; the fairing, which only knows neighbours, leaves such islands where they are.
/// They show themselves: the faired points lie densely on the surface and thinly beside it. A point whose
/// tenth or 32nd neighbour (islands of a dozen points are dense inside) is farther than 1.7 times what is
/// usual around it (the lower quartile), or whose ring is empty among others that have theirs, is projected
/// from its noisy place onto the plane of the others, taken around the one nearest to it: seen from half-way
/// between two sheets, the nearest of both would make one plane across. On lines that are far apart most
/// points have no ring, and an empty one is no sign. Thread safe: no state is kept.
#pragma once

#include <rfsmooth/mesh.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::smoothing {

/// What was done, and what others need of the guide afterwards.
struct Landed {
  std::size_t stranded = 0;      ///< points that were found at first
  rfs_mesh::NeighborTable near;  ///< the 32 nearest of every guide point; rows that had no moved point before
                                 ///< are as they were, even if one has come near
  rfs_mesh::KdTree tree;         ///< of the guide points, here or where they were before
};

/// Moves the stranded points of `guide` (n x 3, the `points` after the fairing over their `rings`), except
/// those farther from the surface than `most` (n, world units): they are strays. Then once more: the landed
/// ones make the surface denser, and smaller islands stand out. O(n log n), parallel, deterministic.
Landed land_stranded(const Positions& points, const Adjacency& rings, const std::vector<double>& most,
                     Positions& guide, const Context& context);

/// The same where nobody needs anything of the guide afterwards.
void land_stranded_only(const Positions& points, const Adjacency& rings, const std::vector<double>& most,
                        Positions& guide, const Context& context);

}  // namespace rfsmooth::smoothing
