/// The surface as one point sees it: a robust local quadric. It gives the normal, the residual (how far the
/// points scatter about it), and the point's shadow on it.
///
/// In the frame (t1, t2, n) at point p the neighbours d_j = x_j - p are fitted by
///
///     z = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2,
///
/// weighted by (1 - (|d|/R)^2)^2, R a little beyond the farthest neighbour. A second and a third round also
/// weight by Tukey's biweight of the residuals, so that a second sheet, a mixed pixel or a stray does not
/// tilt the fit. Paper: none. Vollmer et al. (section 7) test angles and face quality on the points
/// themselves, which fails once noise exceeds about half the spacing; our connectivity tests look at the
/// shadows. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <rfsmooth/connect.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// n local surfaces, each fitted to a point and its row of `near`. With fewer than 8 neighbours a plane is
/// fitted. With fewer than 3, or collinear ones, the normal is some unit vector perpendicular to them and the
/// shadow is the point. O(n k), parallel, deterministic.
std::vector<LocalSurface> local_surfaces(const Positions& points, const NeighborTable& near,
                                         const Context& context);

/// n local surfaces of a noisy cloud, from quadrics that neighbours share. This takes a fraction of the time
/// of one quadric per point, and the shadows scatter a little less, since several quadrics agree on each.
///
/// The points are divided into compact groups of about m / 12, but 7 or more (groups.h), m =
/// `scale.neighbours`. A quadric is fitted to the m nearest of the point in the middle of each group, or to
/// as many as `wider` says there. If its residual is far above the noise there, it has met an edge, a second
/// sheet or strong curvature, and m is halved, down to `least`. A point at offset d from a quadric's centre
/// and e above it takes the mean over the quadrics of its own group and of its neighbours' groups (rows of
/// `near`), with weights
///
///     (1 - |d|^2 / R^2)^3 s^-4 exp(-e^2 / (2 s^2)),    s = max(residual, sigma),
///
/// sigma the noise of the point, so that it follows the sheet nearest to it; for normals the first factor is
/// not cubed. A point that no quadric explains gets one of its own. `near` has k >= 1 unless n < 2.
/// O(n m / 7 + n k), parallel, deterministic.
///
/// \param noise n: sigma around each point, world units. \param wider n: m around each point; empty:
/// `scale.neighbours` everywhere
std::vector<LocalSurface> shared_local_surfaces(const SpatialIndex& index, const NeighborTable& near,
                                                const NoiseScale& scale, const std::vector<double>& noise,
                                                const std::vector<Index>& wider, std::size_t least,
                                                const Context& context);

/// Mean distance to the nearest neighbour, world units; 0 for fewer than two points.
double mean_spacing(const Positions& points, const NeighborTable& near, const Context& context);

/// The distances to the nearest other point of up to 50,000 points spread over the indices, world units; none
/// for fewer than two points. O(log n).
std::vector<double> nearest_distances(const SpatialIndex& index, const Context& context);

/// Their mean; 0 of none.
double mean_spacing(const std::vector<double>& nearest, const Context& context);

/// How wide the first quadrics are: those that connecting stands on, its only caller. It is no second measure
/// of the noise. What is noise, where and how much, says the one model of the cloud (noise.h); this only says
/// at which width quadrics show that much of it that their normals are good, on the cloud as they will see
/// it.
///
/// Quadrics are fitted to m = 24, 48, ... 3,072 neighbours at up to 1,000 points spread over the cloud; sigma
/// is the lower quartile of their residuals (the flat places), corrected for being a quartile, times
/// `louder`. A neighbourhood narrower than a few sigma is a ball inside a thick slab: it shows too little
/// noise and no normal. One that is too wide takes shape for noise: sigma then grows faster than the cube
/// root of m, which noise never does, and the search stops. m is the first at which sigma is at most 0.18 of
/// the radius, else the one at which that share is least. More than 384 points are only tried while they show
/// so much less than the model that not even twice as many could show all of it. O(1) in n after the index.
///
/// \param measured world units, noise of the model; 0: not known. \param louder the model's noise of the
/// cloud over its calm quarter, 1 or more. \param understated whether narrow neighbourhoods cannot show it:
/// of noise that neighbours share they show less, of depths in steps nothing. Then sigma is at least
/// `measured`
NoiseScale noise_scale(const SpatialIndex& index, const Context& context, double measured, double louder,
                       bool understated);

/// The shadow of each point. O(n), parallel.
Positions shadows(const std::vector<LocalSurface>& surfaces, const Context& context);

}  // namespace rfsmooth::rfs_mesh
