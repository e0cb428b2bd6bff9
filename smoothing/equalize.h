/// Evens a smoothed cloud out along its surface, where noise made the points clump.
///
/// Every point is pushed along its tangent plane by the neighbours that are too near,
///
///     f_i = sum_j max(0, 1 - d_ij / R) (x_i - x_j)_tangential / d_ij,
///
/// R a little less than twice the local distance between points, a few small steps long; and it stays on the
/// surface: its height over the tangent plane follows a quadric fitted to the smoothed neighbours. Points
/// whose neighbours do not surround them (rims) or do not share their normal (edges, corners, strays) stay.
/// Repulsion in the tangent plane with a height corrected for curvature: Huang et al. 2009 (WLOP) without its
/// attraction; ours.
#pragma once

#include <vector>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/points.h"

namespace rfsmooth::smoothing {

/// How far the points went along the surface, world units.
struct Equalized {
  double rms = 0, largest = 0;
};

/// Moves `points` (n x 3, near a surface). No point moves farther along the surface than half the local
/// distance between points, nor than `most` (world units). O(n log n), parallel, the same bits for any number
/// of threads.
Equalized equalize(Positions& points, double most, const Context& context);

}  // namespace rfsmooth::smoothing
