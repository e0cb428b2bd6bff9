/// Evens a smoothed cloud out along its surface, where noise made the points clump.
///
/// A fairing also moves points sideways, towards the middle of their neighbours: at rims that is inwards.
/// Where noise sigma is small against the spacing h, where a point was says more of where it belongs, so
/// first it goes back by a share of its tangential offset,
///
///     (1 - min(1, sigma / sigma_0)^2 / 4) / (1 + (sigma / 1.6 h)^4),
///
/// sigma_0 the noise of the cloud as a whole, for which the fairing was made: calmer points went with the
/// others, and go back all the way.
///
/// Then every point is pushed along its tangent plane by the neighbours that are too near,
///
///     f_i = sum_j max(0, 1 - d_ij / R)^2 (x_i - x_j)_tangential / d_ij,
///
/// in a few small steps of 0.4 (sigma / d)^2 R f_i, d the local distance between points and R a little less
/// than twice that; and it stays on the surface: its height over the tangent plane follows a quadric fitted
/// to the smoothed neighbours. Points beside an edge, whose neighbours face elsewhere, slide along it only;
/// those on it, and those that their neighbours do not surround (rims, strays), stay.
///
/// The step is sigma^2 because the mean of where a point was before noise sigma moved it is its place plus
/// sigma^2 times the gradient of the logarithm of the density of noisy places (Tweedie; Efron 2011), and f
/// stands for that gradient in a cloud whose points keep their distance. So little noise moves points little,
/// and what was even stays even. Repulsion in the tangent plane with a height corrected for curvature: Huang
/// et al. 2009 (WLOP) without its attraction; the rest is ours. Thread safe: no state is kept.
#pragma once

#include <rfsmooth/context.h>

#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::smoothing {

/// How far the points went along the surface, world units.
struct Equalized {
  double rms = 0, largest = 0;
};

/// Moves `points` (n x 3, near a surface), which `noise` (local: n) had moved; `before` (n x 3): where they
/// were then. By pushing no point moves farther along the surface than half the local distance between points
/// or half of `noise.spacing`. `near` as in NearestRows (tangent_frames.h). Clouds of 24 points or fewer stay
/// as they are. O(n), parallel, the same bits for any number of threads.
Equalized equalize(Positions& points, const Positions& before, const rfs_mesh::NoiseField& noise,
                   rfs_mesh::NeighborTable near, const Context& context);

}  // namespace rfsmooth::smoothing
