/// Puts smoothed points back to where they were along the surface, so that what is left of the smoothing is a
/// move along the normal.
///
/// A fairing moves points sideways, too, towards the middle of their neighbours. Noise of each point's own is
/// evened out so (equalize.h). Noise that neighbours share moves them together: before a depth camera, whose
/// depths come in steps, they crowd in the middle of the terraces and leave gaps as wide as a dozen points.
/// Nothing says that such points were off sideways by as much.
///
/// A point's foot is the mean of what the quadrics of the smoothed points nearest to it say of where it is,
/// of those that face the same way, weighing (1 - d^2/R^2)^2; first, of what its own quadric says. A foot
/// that is farther from the smoothed points than the quadric's own reach, beyond a corner that the smoothing
/// rounded, is none: the point stays. Thread safe: no state is kept.
#pragma once

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::smoothing {

/// Moves `points` (n x 3, smoothed) along their surface to the feet of `before` (n x 3, where they were).
/// Those that were not moved stay, as do all of a cloud of 24 points or fewer. `near` as in NearestRows
/// (tangent_frames.h). O(n log n), parallel, the same bits for any number of threads.
void slide_back(Positions& points, const Positions& before, rfs_mesh::NeighborTable near,
                const Context& context);

}  // namespace rfsmooth::smoothing
