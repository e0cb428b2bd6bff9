/// The surface as one point sees it: a robust local quadric, and from it the normal, the curvature, how far
/// the points scatter about it, and the point's shadow on it.
///
/// In the frame (t1, t2, n) at point p the neighbours d_j = x_j - p are fitted by
///     z = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2,
/// weighted by (1 - (|d|/R)^2)^2 (R a little beyond the farthest neighbour) and, in a second and third round,
/// by Tukey's biweight of the residuals, so that a second sheet, a mixed pixel or a stray does not tilt it.
/// Paper: none; Vollmer et al. (section 7) test angles and face quality on the points themselves, which fails
/// once noise exceeds about half the spacing. The shadow is what the connectivity tests then look at.
/// Thread safe: no state is kept.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <rfsmooth/connect.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// How wide a neighbourhood must be for the noise in it to be seen as noise, and how large it then is.
struct NoiseScale {
  double sigma = 0;            ///< of the whole cloud, along the normal, world units
  std::size_t neighbours = 0;  ///< m: what a quadric needs
};

/// n local surfaces, each fitted to a point and its row of `near`. With fewer than 8 neighbours the quadric
/// becomes a plane; with fewer than 3, or collinear ones, the normal is some unit vector perpendicular to
/// what there is and the shadow is the point. O(n k), parallel, deterministic.
std::vector<LocalSurface> local_surfaces(const Positions& points, const NeighborTable& near,
                                         const Context& context);

/// n local surfaces of a noisy cloud from quadrics that neighbours share, which takes a fraction of the time
/// of one for each and, as several agree on every point, scatters a little less. The points are taken in
/// compact groups of a sixth of `scale.neighbours` (m), and a quadric is fitted to the m nearest of the point
/// in the middle of each. Where its residual is far above `scale.sigma`, it has met an edge, a second sheet
/// or strong curvature, and m is halved, down to `least`. A point at offset d from the quadrics' centres, e
/// above them, takes the mean of those of its own group and of its neighbours' (rows of `near`), with weights
///     (1 - |d|^2 / R^2)^3 s^-4 exp(-e^2 / (2 s^2)),    s = max(residual, sigma),
/// so that it follows the sheet it lies nearest to; normals with (1 - |d|^2 / R^2) instead of its cube. One
/// that none of them explains has a quadric of its own. `near` has k >= 1 unless n < 2. O(n m / 6 + n k),
/// parallel, deterministic.
std::vector<LocalSurface> shared_local_surfaces(const SpatialIndex& index, const NeighborTable& near,
                                                const NoiseScale& scale, std::size_t least,
                                                const Context& context);

/// Mean distance to the nearest neighbour; 0 for fewer than two points.
double mean_spacing(const Positions& points, const NeighborTable& near, const Context& context);

/// The same of up to 50,000 points spread over the indices. O(log n).
double mean_spacing(const SpatialIndex& index, const Context& context);

/// Fits quadrics to m = 24, 48, ... 384 neighbours at up to 1,000 points spread over the cloud and takes the
/// lower quartile of their residuals (the flat places), corrected for being one. A neighbourhood narrower
/// than a few sigma is a ball inside a thick slab: it tells too little noise and no normal. One too wide
/// takes shape for noise: its residual grows faster than the cube root of m, which noise never does, and the
/// search stops. So m is the first at which sigma is at most 0.18 of the radius, else the one at which that
/// share is least. O(1) in n after the index. On Gaussian noise of 0.1 to 3 spacings within 15 %
/// on a sphere of 10,000 points.
NoiseScale noise_scale(const SpatialIndex& index, const Context& context);

}  // namespace rfsmooth::rfs_mesh
